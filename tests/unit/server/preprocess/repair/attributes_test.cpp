// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/repair/repair.h"
#include "tests/corpus/corpus.h"

#include "shared/core/rng.h"
#include "shared/mesh/half_edge.h"
#include "shared/mesh/primitives.h"
#include "shared/progressive/vertex_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace limn {
namespace {

float linear(int srgb) {
  const double x = srgb / 255.0;
  return static_cast<float>(x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4));
}

glm::vec3 linear(const SrgbColor& c) {
  return {linear(c.x), linear(c.y), linear(c.z)};
}

ImportedMesh imported(const TriangleMesh& mesh) {
  ImportedMesh result;
  result.format = "ply";
  for (const glm::ivec3& p : mesh.positions)
    result.positions.emplace_back(p);
  for (const glm::uvec3& t : mesh.triangles) {
    result.corners.insert(result.corners.end(), {t.x, t.y, t.z});
    result.polygonBegin.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  return result;
}

using Place = std::array<std::int64_t, 3>;

Place placeOf(const glm::dvec3& p) {
  return {std::llround(p.x), std::llround(p.y), std::llround(p.z)};
}

TEST(RepairAttributes, EightBitColoursComeBackExactly) {
  ImportedMesh input = imported(primitives::icosphere(3));
  Rng rng(4);
  std::map<Place, SrgbColor> colors;
  for (const glm::dvec3& p : input.positions) {
    const SrgbColor color(rng.below(256), rng.below(256), rng.below(256));
    colors[placeOf(p)] = color;
    input.colors.push_back(linear(color));
  }
  const auto repaired = repairMesh(input, {18});
  ASSERT_TRUE(repaired) << repaired.error().message;
  const TriangleMesh& mesh = repaired->mesh;
  ASSERT_EQ(mesh.attributes.colors.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_EQ(mesh.attributes.colors[v], colors.at(placeOf(mesh.grid.toModel(mesh.positions[v]))));
  EXPECT_TRUE(mesh.attributes.normals.empty());
  EXPECT_TRUE(repaired->seams.empty());
  EXPECT_FALSE(repaired->repairs.contains("blended_attributes"));
}

TEST(RepairAttributes, ModelsWithoutHaveNone) {
  const auto repaired = repairMesh(imported(primitives::cube()), {12});
  ASSERT_TRUE(repaired);
  EXPECT_EQ(repaired->mesh.attributes.kinds(), 0);
  EXPECT_TRUE(repaired->seams.empty());
}

// Two halves of a sheet, each with vertices and a colour of its own: welded along the middle, which
// is a seam and has the mean of the colours, as light goes.
TEST(RepairAttributes, WeldedVerticesBlendAndTheSeamIsKnown) {
  ImportedMesh input;
  input.format = "ply";
  input.positions =
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}};
  input.corners = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  input.polygonBegin = {0, 3, 6, 9, 12};
  for (int v = 0; v < 8; ++v)
    input.colors.push_back(v < 4 ? glm::vec3(1.0F, 0.0F, 0.0F) : glm::vec3(0.0F, 0.0F, 1.0F));
  const auto repaired = repairMesh(input, {12});
  ASSERT_TRUE(repaired);
  const TriangleMesh& mesh = repaired->mesh;
  EXPECT_EQ(mesh.positions.size(), 6U);
  EXPECT_EQ(repaired->repairs.at("blended_attributes"), 2U);
  const double middle = mesh.grid.fromModel({1.0, 0.0, 0.0}).x;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double x = mesh.positions[v].x;
    const SrgbColor expected = x < middle - 2   ? SrgbColor(255, 0, 0)
                               : x > middle + 2 ? SrgbColor(0, 0, 255)
                                                : SrgbColor(188, 0, 188);
    EXPECT_EQ(mesh.attributes.colors[v], expected);
  }
  ASSERT_EQ(repaired->seams.size(), 12U);
  EXPECT_EQ(std::count(repaired->seams.begin(), repaired->seams.end(), kFeatureSeam), 2);
}

// Solids that only touch are parted again, and keep their own colours.
TEST(RepairAttributes, WhatRepairPartsKeepsItsOwnColours) {
  ImportedMesh input = imported(primitives::cube());
  const auto side = std::max_element(
      input.positions.begin(),
      input.positions.end(),
      [](const auto& a, const auto& b) { return a.x < b.x; });
  const double far = side->x;
  const double low =
      std::min_element(input.positions.begin(), input.positions.end(), [](auto& a, auto& b) {
        return a.x < b.x;
      })->x;
  // A copy that touches the first cube along an edge.
  const std::size_t count = input.positions.size();
  input.colors.assign(count, glm::vec3(1.0F, 0.0F, 0.0F));
  const auto corners = input.corners;
  for (std::size_t v = 0; v < count; ++v) {
    glm::dvec3 p = input.positions[v];
    p.x += far - low;
    p.y += far - low;
    input.positions.push_back(p);
    input.colors.emplace_back(0.0F, 1.0F, 0.0F);
  }
  for (const std::uint32_t corner : corners)
    input.corners.push_back(corner + static_cast<std::uint32_t>(count));
  for (std::size_t c = corners.size() + 3; c <= input.corners.size(); c += 3)
    input.polygonBegin.push_back(static_cast<std::uint32_t>(c));
  const auto repaired = repairMesh(input, {12});
  ASSERT_TRUE(repaired);
  EXPECT_GT(repaired->repairs.at("split_vertices"), 0U);
  EXPECT_FALSE(repaired->repairs.contains("blended_attributes"));
  EXPECT_TRUE(repaired->seams.empty());
  for (const SrgbColor& color : repaired->mesh.attributes.colors)
    EXPECT_TRUE(color == SrgbColor(255, 0, 0) || color == SrgbColor(0, 255, 0));
}

// Normals turn with the faces that repair turns; where the file has none, the surface's own stand.
TEST(RepairAttributes, NormalsPointOutwardOfSolidsThatWereInsideOut) {
  ImportedMesh input = imported(primitives::icosphere(3));
  glm::dvec3 center(0.0);
  for (const glm::dvec3& p : input.positions)
    center += p / static_cast<double>(input.positions.size());
  for (glm::dvec3& p : input.positions)
    p -= center;
  for (std::size_t v = 0; v < input.positions.size(); ++v)
    input.normals.push_back(
        v % 7 == 0 ? glm::vec3(0.0F) : glm::vec3(-glm::normalize(input.positions[v])));
  for (std::size_t c = 0; c < input.corners.size(); c += 3)
    std::swap(input.corners[c], input.corners[c + 1]);
  const auto repaired = repairMesh(input, {14});
  ASSERT_TRUE(repaired);
  const TriangleMesh& mesh = repaired->mesh;
  ASSERT_EQ(mesh.attributes.normals.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const glm::dvec3 outward = glm::normalize(mesh.grid.toModel(mesh.positions[v]));
    EXPECT_GT(glm::dot(glm::dvec3(decodeNormal(mesh.attributes.normals[v])), outward), 0.99);
  }
}

TEST(RepairAttributes, MaterialsGiveColoursAndSeams) {
  ImportedMesh input = imported(primitives::cube());
  const std::size_t faces = input.polygonBegin.size() - 1;
  for (std::size_t f = 0; f < faces; ++f)
    input.materials.push_back(f < faces / 2 ? 0 : 1);
  input.materialColors = {{1.0F, 1.0F, 0.0F}, {0.0F, 1.0F, 1.0F}};
  const auto repaired = repairMesh(input, {12});
  ASSERT_TRUE(repaired);
  EXPECT_EQ(repaired->mesh.attributes.colors.size(), repaired->mesh.positions.size());
  const auto links = HalfEdgeMesh::build(
      static_cast<std::uint32_t>(repaired->mesh.positions.size()),
      repaired->mesh.triangles);
  ASSERT_EQ(repaired->seams.size(), 3 * faces);
  for (HalfEdgeId h = 0; h < repaired->seams.size(); ++h) {
    // The order of faces stays.
    const bool differs = (h / 3 < faces / 2) != (links->twin(h) / 3 < faces / 2);
    EXPECT_EQ(repaired->seams[h] != 0, differs);
  }
}

// Real assemblies: bricks and engine parts whose materials meet.
TEST(RepairAttributes, SeamsOfRealModelsAreFound) {
  const auto folder = corpus::modelsFolder();
  if (!folder) GTEST_SKIP() << corpus::kNoModels;
  for (const char* name : {"lego-car.ply", "engine.glb"}) {
    if (!std::filesystem::exists(*folder / name)) continue;
    const auto input = importMesh(*folder / name);
    ASSERT_TRUE(input) << input.error().message;
    const auto repaired = repairMesh(*input, {14});
    ASSERT_TRUE(repaired) << repaired.error().message;
    EXPECT_EQ(repaired->mesh.attributes.colors.size(), repaired->mesh.positions.size());
    EXPECT_GT(std::count(repaired->seams.begin(), repaired->seams.end(), kFeatureSeam), 200);
  }
}

TEST(VertexAttributes, NormalsAreTheNearestOfTheLattice) {
  Rng rng(3);
  for (int i = 0; i < 2000; ++i) {
    const auto any = [&] { return static_cast<double>(rng.below(20001)) - 10000.0; };
    const glm::dvec3 direction(any(), any(), any() + 0.5);
    const OctNormal code = encodeNormal(direction);
    EXPECT_GT(glm::dot(glm::dvec3(decodeNormal(code)), glm::normalize(direction)), 0.999995);
    EXPECT_EQ(octNormal(octPoint(code)), code);
    EXPECT_EQ(encodeNormal(glm::dvec3(octPoint(code))), code);
  }
}

TEST(VertexAttributes, EveryLatticePointIsOnTheOctahedronAndComesBack) {
  for (std::int32_t s = -kOctRadius; s <= kOctRadius; s += 7) {
    for (std::int32_t t = -kOctRadius; t <= kOctRadius; ++t) {
      const glm::ivec3 p = octPoint(glm::ivec2(s, t));
      ASSERT_EQ(std::abs(p.x) + std::abs(p.y) + std::abs(p.z), kOctRadius);
      ASSERT_EQ(octPoint(octUnfold(p)), p);
    }
  }
}

}  // namespace
}  // namespace limn
