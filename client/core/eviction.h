// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/pose_reporter.h"

#include "protocol/messages.h"

#include "shared/core/ids.h"
#include "shared/mesh/triangle_mesh.h"
#include "shared/progressive/active_mesh.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace limn {

/// How many splits of a model fit into `bytes` of a client's memory: the mesh that is decoded into,
/// the snapshot that is drawn, and the next one while it is made. 0: not even a useful beginning.
/// model: levelBegin, vertices, attributes and placement count.
[[nodiscard]] std::uint32_t splitsThatFit(std::uint64_t bytes, const protocol::ModelInfo& model);

/// Which splits a client needs least. A client knows no error bounds; it judges by what it draws: a
/// vertex is *used* by a view when it is in the frame and a silhouette passes its faces, or nearly
/// does. Least needed is what no view of late used, of that what is out of the present frame, then
/// what faces away, then what faces the eye; of equals the finest.
class Eviction {
 public:
  /// The newest view. Of earlier ones those are remembered that lie some degrees apart.
  void look(const ClientView& view);

  /// At most `count` splits to drop, ascending: the least needed, none that the present view uses,
  /// and none next to a finer one that stays. What of them may go without breaking closure is the
  /// server's to say. Cost: O(vertices · views).
  [[nodiscard]] std::vector<VertexId>
  choose(const ActiveMesh& mesh, const Grid& grid, std::size_t count) const;

 private:
  static constexpr std::size_t kViews = 6;
  std::optional<ClientView> present_;
  std::deque<ClientView> past_;  // newest first
};

}  // namespace limn
