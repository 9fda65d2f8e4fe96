// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/forest/view_sphere.h"

#include <array>
#include <limits>
#include <numeric>

namespace limn {
namespace {

struct Cells {
  std::array<float, kViewCells> x{};
  std::array<float, kViewCells> y{};
  std::array<float, kViewCells> z{};
};

// One of each pair of opposite directions: the first component that is not zero is positive.
constexpr Cells makeCells() {
  Cells cells;
  std::size_t count = 0;
  for (int x = 0; x <= 2; ++x) {
    for (int y = x > 0 ? -2 : 0; y <= 2; ++y) {
      for (int z = x > 0 || y > 0 ? -2 : 1; z <= 2; ++z) {
        if (std::gcd(std::gcd(x, y), z) != 1) continue;
        cells.x[count] = static_cast<float>(x);
        cells.y[count] = static_cast<float>(y);
        cells.z[count] = static_cast<float>(z);
        ++count;
      }
    }
  }
  return cells;
}

constexpr Cells kCells = makeCells();
static_assert(kCells.x[kViewCells - 1] == 2.0F, "the last cell is (2, 2, 1)");

}  // namespace

int silhouetteCells(std::span<const glm::vec3> normals) {
  // How much the faces look into each cell, at least and at most. Written for the vectoriser.
  std::array<float, kViewCells> least;
  std::array<float, kViewCells> most;
  least.fill(std::numeric_limits<float>::max());
  most.fill(std::numeric_limits<float>::lowest());
  for (const glm::vec3& n : normals) {
    for (std::size_t i = 0; i < kViewCells; ++i) {
      const float facing = n.x * kCells.x[i] + n.y * kCells.y[i] + n.z * kCells.z[i];
      least[i] = facing < least[i] ? facing : least[i];
      most[i] = facing > most[i] ? facing : most[i];
    }
  }
  int count = 0;
  for (std::size_t i = 0; i < kViewCells; ++i)
    count += least[i] <= 0.0F && most[i] > 0.0F ? 1 : 0;
  return count;
}

}  // namespace limn
