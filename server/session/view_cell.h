// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/session/view.h"

#include "protocol/messages.h"

#include <cstdint>
#include <optional>

namespace limn {

/// A cell of view space [Hoppe97's view-orthogonal cells, on the view sphere of Mohr13]: poses of a
/// model that need about the same splits, as a number. Equal numbers, equal cells.
using ViewCell = std::uint64_t;

/// No cell's number.
inline constexpr ViewCell kNoCell = ~ViewCell{0};

/// The cell of a pose on a model. Direction from the model's centre in steps of about 6 degrees,
/// distance in quarters of an octave, error bound as an angle in half octaves (rounded down, to the
/// finer), silhouette kind; and, unless the whole model is in view, the direction of view.
[[nodiscard]] ViewCell viewCellOf(const protocol::Pose& pose, const protocol::ModelInfo& model);

/// A smaller cell (3 degrees, a sixteenth of an octave) whose view needs at least what any pose
/// in it does: a resting pose may be settled by it. nullopt unless the model is seen in
/// perspective, from outside, and all of it.
[[nodiscard]] std::optional<ViewCell> restCellOf(
    const protocol::Pose& pose,
    const protocol::ModelInfo& model);

/// Whether a piece of a way, of about two cells, ends here: the same for everyone, so that those
/// who go the same way lack the same pieces.
[[nodiscard]] bool endsPiece(ViewCell cell);

/// What stands for all poses of a cell of either kind: seen from its middle.
[[nodiscard]] View viewOfCell(ViewCell cell, const protocol::ModelInfo& model);

}  // namespace limn
