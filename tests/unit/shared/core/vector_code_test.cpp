// SPDX-License-Identifier: Apache-2.0
#include "shared/core/vector_code.h"

#include <gtest/gtest.h>

namespace limn {
namespace {

TEST(VectorCode, IsNeverMoreThanAskedForNorMoreThanTheMachineHas) {
  EXPECT_EQ(chooseVectorCode(VectorCode::kPortable), VectorCode::kPortable);
  const VectorCode best = chooseVectorCode(VectorCode::kAvx512);
  for (const VectorCode most : {VectorCode::kPortable, VectorCode::kAvx2, VectorCode::kAvx512})
    EXPECT_EQ(chooseVectorCode(most), most < best ? most : best);
}

}  // namespace
}  // namespace limn
