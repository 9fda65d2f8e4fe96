// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace limn {

/// Instruction sets that functions with more than one version (simd.h) are compiled for. All give
/// the same results; ordered, each includes those before it.
enum class VectorCode : std::uint8_t { kPortable, kAvx2, kAvx512 };

/// The best of what this machine runs and `most` allows. Threads: any. Cost: none after the first
/// call.
[[nodiscard]] VectorCode chooseVectorCode(VectorCode most);

}  // namespace limn
