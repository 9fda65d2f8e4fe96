// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "client/core/snapshot.h"

#include "shared/silhouette/cone_forest.h"
#include "shared/silhouette/field.h"

#include <cstdint>
#include <future>
#include <memory>

namespace limn {

struct ConeKeeperOptions {
  double rebuildAbove = 1.3;  // looseness from which cones are built anew
};

/// The cones of a mesh that is being refined: refits those of the last snapshot to the next, and
/// when they have become loose has them built anew on a thread of its own, which takes their place,
/// refitted to the snapshot of the day, as soon as it is done. Threads: one caller at a time.
class ConeKeeper {
 public:
  using Options = ConeKeeperOptions;

  explicit ConeKeeper(SilhouetteKind kind, const Options& options = {})
      : kind_(kind),
        options_(options) {}

  /// Waits for what is being built.
  ~ConeKeeper() = default;
  ConeKeeper(const ConeKeeper&) = delete;
  ConeKeeper& operator=(const ConeKeeper&) = delete;

  /// Cones of a snapshot. field: of its mesh, and of this kind. What was returned before stays as
  /// it is while somebody holds it. Cost: a few ns a face and 0.4 µs for every edge or face near a
  /// change; the first time, and for another model, 0.4 µs for every one.
  [[nodiscard]] std::shared_ptr<const ConeForest> conesOf(
      const std::shared_ptr<const MeshSnapshot>& snapshot,
      const SilhouetteField& field);

  /// Waits until nothing is being built; the next conesOf() then takes it.
  void wait() const;

  /// How often cones built in the background have taken their place.
  [[nodiscard]] std::uint64_t replacements() const { return replacements_; }

  [[nodiscard]] SilhouetteKind kind() const { return kind_; }

 private:
  /// Cones, and the snapshot whose mesh they fit.
  struct Fitted {
    std::shared_ptr<ConeForest> cones;
    std::shared_ptr<const MeshSnapshot> snapshot;

    void refit(const std::shared_ptr<const MeshSnapshot>& to, const SilhouetteField& field);
  };

  void takeRebuilt(
      const std::shared_ptr<const MeshSnapshot>& snapshot,
      const SilhouetteField& field);

  SilhouetteKind kind_;
  Options options_;
  Fitted current_;
  std::uint64_t replacements_ = 0;
  std::future<Fitted> rebuilt_;  // valid: being built, or waiting to be taken
};

}  // namespace limn
