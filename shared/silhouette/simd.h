// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Vector code is chosen at run time: a function compiled for AVX2 beside a portable one that does
/// the same operations in the same order (this library is compiled without contraction, so results
/// agree to the last bit). Internal to shared/silhouette.
#if defined(__x86_64__)
#define LIMN_SILHOUETTE_AVX2 1
#include <immintrin.h>
#define LIMN_TARGET_AVX2 __attribute__((target("avx2,bmi,popcnt")))
#else
#define LIMN_SILHOUETTE_AVX2 0
#endif

namespace limn::silhouette {

/// Whether this machine runs the AVX2 versions.
[[nodiscard]] inline bool hasAvx2() {
#if LIMN_SILHOUETTE_AVX2
  static const bool answer =
      __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0;
  return answer;
#else
  return false;
#endif
}

}  // namespace limn::silhouette
