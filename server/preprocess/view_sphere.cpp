// SPDX-License-Identifier: Apache-2.0
#include "server/preprocess/view_sphere.h"

#include <array>
#include <numeric>

namespace limn {
namespace {

struct Cells {
  std::array<double, kViewCells> x{};
  std::array<double, kViewCells> y{};
  std::array<double, kViewCells> z{};
};

// One of each pair of opposite directions: the first component that is not zero is positive.
constexpr Cells makeCells() {
  Cells cells;
  std::size_t count = 0;
  for (int x = 0; x <= 2; ++x) {
    for (int y = x > 0 ? -2 : 0; y <= 2; ++y) {
      for (int z = x > 0 || y > 0 ? -2 : 1; z <= 2; ++z) {
        if (std::gcd(std::gcd(x, y), z) != 1) continue;
        cells.x[count] = x;
        cells.y[count] = y;
        cells.z[count] = z;
        ++count;
      }
    }
  }
  return cells;
}

constexpr Cells kCells = makeCells();
static_assert(kCells.x[kViewCells - 1] == 2.0, "the last cell is (2, 2, 1)");

}  // namespace

std::uint64_t facingCells(const glm::dvec3& normal) {
  std::array<bool, kViewCells> faces{};
  for (std::size_t i = 0; i < kViewCells; ++i)
    faces[i] = normal.x * kCells.x[i] + normal.y * kCells.y[i] + normal.z * kCells.z[i] > 0.0;
  std::uint64_t cells = 0;
  for (std::size_t i = 0; i < kViewCells; ++i)
    cells |= static_cast<std::uint64_t>(faces[i]) << i;
  return cells;
}

}  // namespace limn
