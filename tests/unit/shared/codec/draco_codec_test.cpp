// SPDX-License-Identifier: Apache-2.0
#include "shared/codec/draco_codec.h"

#include "shared/codec/allocation_budget.h"
#include "shared/mesh/primitives.h"

#include <gtest/gtest.h>

#include <new>
#include <vector>

namespace limn {
namespace {

constexpr std::uint32_t kMany = 1U << 20;

std::vector<std::uint8_t> coded() {
  return encodeDraco(primitives::icosphere(1))->bytes;
}

// Offsets in what is coded: the header's parts before the counts, then the counts of 42 vertices
// and 80 faces, a byte each, then the number of attributes with seams of their own.
constexpr std::size_t kVertices = 12;
constexpr std::size_t kAttributes = 14;

TEST(DracoCodec, GivesBackWhatWasCoded) {
  const auto bytes = coded();
  ASSERT_EQ(bytes[kVertices], 42);
  ASSERT_EQ(bytes[kVertices + 1], 80);
  const auto mesh = decodeDraco(bytes, 42, 80);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), 80U);
  EXPECT_EQ(decodeDraco(bytes, 41, 80).error().code, ErrorCode::kLimitExceeded);
  EXPECT_EQ(decodeDraco(bytes, 42, 79).error().code, ErrorCode::kLimitExceeded);
}

TEST(DracoCodec, ALargeMeshFitsIntoItsBudget) {
  const TriangleMesh sphere = primitives::icosphere(6);
  const auto bytes = encodeDraco(sphere, 10);
  ASSERT_TRUE(bytes);
  const auto mesh = decodeDraco(bytes->bytes, kMany, kMany);
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->triangles.size(), sphere.triangles.size());
}

TEST(DracoCodec, RefusesAttributesThatItNeverWrites) {
  auto bytes = coded();
  bytes[kAttributes] = 200;  // a connectivity each
  EXPECT_FALSE(decodeDraco(bytes, kMany, kMany));
}

// 4 MiB in which everywhere in turn a number claims as much as it can: tables of symbols of several
// GiB among them.
TEST(DracoCodec, AFileThatClaimsTheWorldIsRefusedBeforeItGetsIt) {
  const auto fine = coded();
  for (std::size_t at = kVertices; at < fine.size(); at += 3) {
    std::vector<std::uint8_t> bytes(fine.begin(), fine.begin() + static_cast<std::ptrdiff_t>(at));
    bytes.insert(bytes.end(), {0xFF, 0xFF, 0xFF, 0x7F});
    bytes.resize(std::size_t{4} << 20, 0xFF);
    if (const auto mesh = decodeDraco(bytes, kMany, kMany)) {
      EXPECT_LE(mesh->triangles.size(), kMany);
    }
  }
}

TEST(AllocationBudget, EndsInBadAllocOnThisThreadAlone) {
  if (!AllocationBudget::works()) GTEST_SKIP() << "a sanitizer has its own allocator";
  const AllocationBudget budget(1000);
  EXPECT_NO_THROW(std::vector<char>(600));
  EXPECT_THROW(std::vector<char>(600), std::bad_alloc) << "what was freed is not given back";
}

TEST(AllocationBudget, EndsWithItsScope) {
  { const AllocationBudget budget(10); }
  EXPECT_NO_THROW(std::vector<char>(1000));
}

}  // namespace
}  // namespace limn
