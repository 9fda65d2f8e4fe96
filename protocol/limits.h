// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

/// Every limit of subprotocol `limn.1`, checked before anything is allocated. SPEC.md lists them.
namespace limn::limits {

inline constexpr std::uint16_t kProtocolVersion = 1;
inline constexpr char kSubprotocol[] = "limn.1";

inline constexpr std::size_t kMaxClientMessageBytes = 64 * 1024;        // client → server
inline constexpr std::size_t kMaxServerMessageBytes = 4 * 1024 * 1024;  // server → client
inline constexpr std::size_t kMaxHaveSetPieceBytes = 32 * 1024;
inline constexpr std::uint32_t kMaxVertices = 1u << 27;
inline constexpr std::uint32_t kMaxBaseVertices = 1u << 20;
inline constexpr std::uint32_t kMaxLevels = 64;
inline constexpr std::uint32_t kMaxRing = 64;       // neighbours in a canonical ring
inline constexpr std::size_t kMaxNameBytes = 200;   // model, client and server names
inline constexpr std::size_t kMaxTextBytes = 1000;  // error messages, failure reasons
inline constexpr std::size_t kMaxSplitModelBytes = 64 * 1024;
inline constexpr std::uint32_t kMaxSeedBytes = 4 * 1024 * 1024;
inline constexpr std::size_t kMaxCatalogueModels = 10'000;
inline constexpr std::uint16_t kMaxViewportPixels = 16384;
inline constexpr float kMinErrorPx = 0.1F;
inline constexpr float kMaxErrorPx = 64.0F;
inline constexpr std::uint32_t kMaxHullFaces = 1u << 20;
inline constexpr std::uint32_t kMaxHullPieces = 1u << 12;
inline constexpr int kMaxHullExtraBits = 8;
inline constexpr std::uint32_t kMaxContourPoints = 1u << 20;
inline constexpr int kMaxContourExtraBits = 4;
inline constexpr std::uint32_t kMaxMapFaces = 1u << 14;
inline constexpr std::uint32_t kMaxMapLeg = 127;  // texels
inline constexpr std::uint32_t kMaxMapBytes = 16 * 1024 * 1024;
inline constexpr std::uint32_t kMaxMapPieces = 1u << 12;
inline constexpr int kMinGridBits = 11;
inline constexpr int kMaxGridBits = 18;
inline constexpr std::uint8_t kMaxAttributeKinds = 7;  // ModelInfo.attributes: every bit
inline constexpr std::uint8_t kMaxPlacement = 1;       // ModelInfo.placement
inline constexpr std::uint32_t kMaxPacketSplits = 1u << 20;

}  // namespace limn::limits
