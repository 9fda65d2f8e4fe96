// SPDX-License-Identifier: Apache-2.0
#include "shared/core/vector_code.h"

#include <algorithm>

namespace limn {
namespace {

VectorCode bestOfThisMachine() {
#if defined(__x86_64__)
  // What the attributes of simd.h name.
  const bool hasAvx2 = __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi") != 0;
  if (!hasAvx2) return VectorCode::kPortable;
  const bool hasAvx512 =
      __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
      __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
      __builtin_cpu_supports("avx512vbmi") != 0 && __builtin_cpu_supports("avx512vbmi2") != 0;
  return hasAvx512 ? VectorCode::kAvx512 : VectorCode::kAvx2;
#else
  return VectorCode::kPortable;
#endif
}

}  // namespace

VectorCode chooseVectorCode(VectorCode most) {
  static const VectorCode kBest = bestOfThisMachine();
  return std::min(kBest, most);
}

}  // namespace limn
