// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/core/vector_code.h"

/// What a source file that has functions of each VectorCode needs: the intrinsics, where the
/// platform has them (LIMN_HAS_AVX2), and the attributes of functions compiled for them. Such
/// functions do the same operations in the same order as the portable ones, and their libraries are
/// compiled without contraction, so results agree to the last bit.
#if defined(__x86_64__)
#define LIMN_HAS_AVX2 1
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
#define LIMN_HAS_AVX2 0
#endif
