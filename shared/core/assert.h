// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cassert>

/// States an invariant. A failure is a bug of Limn, never a consequence of bad data: bad data is a
/// Result. Compiled out of release builds.
#define LIMN_ASSERT(condition) assert(condition)
