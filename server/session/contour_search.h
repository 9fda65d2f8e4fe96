// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/full_mesh.h"
#include "server/session/target_set.h"

#include "protocol/messages.h"

#include "shared/progressive/active_mesh.h"
#include "shared/silhouette/contour_distance.h"
#include "shared/silhouette/picture.h"
#include "shared/silhouette/visible_contour.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace limn {

/// The picture in which a pose's contours are compared: the pose's own, or one of the same aspect
/// that is small enough for the work to be bounded.
struct ContourView {
  PictureView picture;
  SilhouetteKind kind = SilhouetteKind::kEdges;
  double errorPx = 1.0;  // of `picture`
};

[[nodiscard]] ContourView contourViewOf(const protocol::Pose& pose, const Grid& grid);

/// Shares of the lengths of two contours that are farther from the other than the bound.
struct ContourOff {
  double full = 1.0;    // of the full mesh's visible contour
  double client = 1.0;  // of the client's

  [[nodiscard]] double worst() const { return full > client ? full : client; }
};

struct ContourSearchOptions {
  /// Share of either contour's length that may be off by more than the bound: the 95th percentile
  /// with some margin. More margin for smooth silhouettes, since clients divide normals at creases
  /// (client/stroke/chain/crease_contours) and the search does not.
  double edgesShare = 0.047;
  double smoothShare = 0.035;
  /// A round adds at most this many splits for each that is held, times the share that is off.
  double greed = 0.15;
  double leastGreed = 0.004;
  int maxRounds = 120;
  int pruneRounds = 16;
};

/// Finds few splits that bring a client's visible contours to the full mesh's, by trying: it keeps
/// the mesh that the client would have, compares the pictures' contours both ways, adds splits
/// where they are off, and in the end takes away what is not missed. Threads: one caller at a time.
class ContourSearch {
 public:
  /// full and its forest must outlive it. have: what the client holds (words as in HaveSet, closed,
  /// base included). Cost: O(full mesh + pixels).
  ContourSearch(
      const FullMesh& full,
      const ContourView& view,
      std::span<const std::uint64_t> have,
      const ContourSearchOptions& options = {});

  /// Searches to the end, or until nobody wants it any longer, which is asked before each round.
  /// True when both contours are within the bound. Cost: up to maxRounds + pruneRounds times
  /// O(client's mesh + pixels).
  bool run(const std::function<bool()>& isUnwanted = [] { return false; });

  /// What was found, besides what the client held: closed, of one class.
  [[nodiscard]] TargetSet target() const;

  [[nodiscard]] ContourOff off() const { return off_; }

  [[nodiscard]] int rounds() const { return rounds_; }

 private:
  struct Candidate {
    VertexId vertex = kNone;
    float votes = 0.0F;  // length put right, by guess
    float worth = 0.0F;  // that a split
  };

  void compare();
  void noteDetail();
  void collectVotes();
  [[nodiscard]] std::vector<Candidate>
  rankedFrom(double worth, std::span<const std::uint64_t> held, std::vector<Candidate>& open);
  bool addRound();
  bool pruneRound(double part);
  void vote(VertexId v, float weight);
  bool findClosure(VertexId v, std::span<const std::uint64_t> held, std::size_t most);
  void add(VertexId v);
  [[nodiscard]] VertexId nextChildOf(VertexId parent) const;
  [[nodiscard]] VertexId nextTowards(VertexId v) const;
  [[nodiscard]] VertexId finestMissingAt(std::uint32_t segment) const;

  [[nodiscard]] double share() const {
    return view_.kind == SilhouetteKind::kEdges ? options_.edgesShare : options_.smoothShare;
  }

  [[nodiscard]] bool satisfied() const { return off_.worst() <= share(); }

  const FullMesh& full_;
  const SplitForest& forest_;
  const ContourView view_;
  const ContourSearchOptions options_;
  std::vector<std::uint64_t> start_;  // what the client held
  std::vector<std::uint64_t> held_;   // with what was added
  std::uint32_t heldCount_ = 0;
  ActiveMesh client_;
  VisibleContourFinder finder_;
  std::vector<ContourPoint> truth_;
  std::optional<PixelPoints> truthPixels_;
  std::vector<ContourPoint> mine_;
  std::vector<float> truthOff_;  // distance of each point to the other contour
  std::vector<float> mineOff_;
  ContourOff off_;
  int rounds_ = 0;
  bool onlyDetailIsLeft_ = false;

  std::vector<float> votes_;  // by vertex; 0: not in voted_
  std::vector<VertexId> voted_;
  std::vector<std::uint32_t> stamps_;  // by vertex: closures it was seen in last
  std::uint32_t stamp_ = 0;
  std::vector<VertexId> open_;
  std::vector<VertexId> closure_;
  /// By vertex: splits held and splits missing for it when its closure was last looked at; at least
  /// so many, less those held by now, are missing still. 0: never looked at.
  std::vector<std::uint32_t> reach_;
  std::uint32_t heldThen_ = 0;  // splits held when the round began
  double worthLast_ = 1e3;      // of the least worthy candidate of the last round
};

/// The mesh of a closed set of splits (words as in HaveSet, base included).
[[nodiscard]] ActiveMesh meshOf(const SplitForest& forest, std::span<const std::uint64_t> held);

}  // namespace limn
