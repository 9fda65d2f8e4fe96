// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <limits>

namespace limn {

/// Permanent id of a vertex of a prepared model: 0 … vertices − 1, base mesh first, then level by
/// level, coarse to fine. A vertex split is named by the vertex it brings in.
using VertexId = std::uint32_t;
/// Index of a vertex in one mesh's arrays. In a client's mesh slots are in order of arrival.
using Slot = std::uint32_t;
/// Half-edge 3f + k is edge k of face f, from corner k to corner (k + 1) mod 3.
using HalfEdgeId = std::uint32_t;
using FaceId = std::uint32_t;

/// "None", for every kind of id.
inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

}  // namespace limn
