// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/silhouette/detector.h"

/// Vector code is chosen at run time: functions compiled for AVX2 and AVX-512 beside a portable one
/// that does the same operations in the same order (this library is compiled without contraction,
/// so results agree to the last bit). For shared/silhouette and the chaining of client/stroke.
#if defined(__x86_64__)
#define LIMN_SILHOUETTE_AVX2 1
#include <immintrin.h>
#if !defined(__clang__)
// GCC bug 105593: its own AVX-512 headers are found to use what they never set.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wuninitialized"
#endif
#define LIMN_TARGET_AVX2 __attribute__((target("avx2,bmi,popcnt")))
#define LIMN_TARGET_AVX512 \
  __attribute__((          \
      target("avx2,bmi,popcnt,avx512f,avx512bw,avx512dq,avx512vl,avx512vbmi,avx512vbmi2")))
#else
#define LIMN_SILHOUETTE_AVX2 0
#endif

namespace limn::silhouette {

/// The best of what this machine runs and `most` allows.
[[nodiscard]] inline VectorCode chooseVectorCode(VectorCode most) {
#if LIMN_SILHOUETTE_AVX2
  static const bool hasAvx2 =
      __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0;
  static const bool hasAvx512 =
      hasAvx2 && __builtin_cpu_supports("avx512f") != 0 &&
      __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
      __builtin_cpu_supports("avx512vl") != 0 && __builtin_cpu_supports("avx512vbmi") != 0 &&
      __builtin_cpu_supports("avx512vbmi2") != 0;
  if (hasAvx512 && most >= VectorCode::kAvx512) return VectorCode::kAvx512;
  if (hasAvx2 && most >= VectorCode::kAvx2) return VectorCode::kAvx2;
#endif
  static_cast<void>(most);
  return VectorCode::kPortable;
}

}  // namespace limn::silhouette
