// SPDX-License-Identifier: GPL-3.0-or-later
// GPL because of CGAL's solver, the oracle here.
#include "shared/core/linear_program.h"

#include <CGAL/Gmpzf.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <gtest/gtest.h>

#include <vector>

namespace limn {
namespace {

using Exact = CGAL::Gmpzf;
using Program = CGAL::Quadratic_program<double>;

glm::dvec3 randomDirection(Rng& rng) {
  while (true) {
    const glm::dvec3 d(2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1);
    const double length = glm::length(d);
    if (length > 0.1 && length < 1.0) return d / length;
  }
}

Program programOf(const std::vector<HalfSpace>& constraints, const LinearGoal& goal) {
  Program program(CGAL::LARGER, false, 0.0, false, 0.0);
  for (int row = 0; row < static_cast<int>(constraints.size()); ++row) {
    const HalfSpace& c = constraints[static_cast<std::size_t>(row)];
    for (int axis = 0; axis < 3; ++axis)
      program.set_a(axis, row, c.normal[axis]);
    program.set_b(row, c.offset);
  }
  for (int axis = 0; axis < 3; ++axis) {
    program.set_c(axis, goal.direction[axis]);
    program.set_d(axis, axis, 1.0 / goal.reach);  // CGAL takes twice the matrix
  }
  return program;
}

double valueAt(const LinearGoal& goal, const glm::dvec3& x) {
  return glm::dot(goal.direction, x) + glm::dot(x, x) / (2.0 * goal.reach);
}

/// Half-spaces that all have the ball of radius `room` around the origin: none is infeasible for
/// room > 0; negative room makes many so.
std::vector<HalfSpace> randomConstraints(Rng& rng, std::size_t count, double room) {
  std::vector<HalfSpace> constraints;
  const glm::dvec3 axis = randomDirection(rng);
  for (std::size_t i = 0; i < count; ++i) {
    HalfSpace c{randomDirection(rng), -room - rng.uniform()};
    // As around an edge: normals of one side, mostly.
    if (glm::dot(c.normal, axis) < 0.0 && i % 4 != 0) c.normal = -c.normal;
    constraints.push_back(c);
  }
  return constraints;
}

TEST(LinearProgram, FindsTheMinimumThatTheExactSolverFinds) {
  Rng rng(7);
  Rng order(1);
  for (int round = 0; round < 150; ++round) {
    auto constraints = randomConstraints(rng, 3 + rng.below(12), 0.0);
    const LinearGoal goal{randomDirection(rng) * rng.uniform(), round % 2 == 0 ? 1e5 : 10.0};
    const Program program = programOf(constraints, goal);  // the solution refers to it
    const auto exact = CGAL::solve_quadratic_program(program, Exact());
    ASSERT_TRUE(exact.is_optimal());
    const auto found = solveLinearProgram(constraints, goal, order);
    ASSERT_TRUE(found.has_value());
    for (const HalfSpace& c : constraints)
      EXPECT_GE(glm::dot(c.normal, *found), c.offset - 1e-8);
    const double value = CGAL::to_double(exact.objective_value());
    EXPECT_NEAR(valueAt(goal, *found), value, 1e-7 * (1.0 + std::abs(value))) << "round " << round;
  }
}

TEST(LinearProgram, ComesAsCloseToTheUnregularisedMinimumAsItsReachSays) {
  Rng rng(11);
  Rng order(1);
  int bounded = 0;
  for (int round = 0; round < 100; ++round) {
    auto constraints = randomConstraints(rng, 12, 0.0);
    const LinearGoal goal{randomDirection(rng), 1e5};
    const Program program = programOf(constraints, goal);
    const auto exact = CGAL::solve_linear_program(program, Exact());
    if (!exact.is_optimal()) continue;
    glm::dvec3 at(0.0);
    int axis = 0;
    for (auto it = exact.variable_values_begin(); it != exact.variable_values_end(); ++it)
      at[axis++] = CGAL::to_double(*it);
    if (glm::length(at) > 100.0) continue;
    ++bounded;
    const auto found = solveLinearProgram(constraints, goal, order);
    ASSERT_TRUE(found.has_value());
    EXPECT_LE(
        glm::dot(goal.direction, *found),
        CGAL::to_double(exact.objective_value()) + glm::dot(at, at) / (2.0 * goal.reach) + 1e-7);
  }
  EXPECT_GT(bounded, 20);
}

TEST(LinearProgram, SaysWhatCannotBeSatisfiedWhenTheExactSolverDoes) {
  Rng rng(3);
  Rng order(1);
  int infeasible = 0;
  for (int round = 0; round < 150; ++round) {
    auto constraints = randomConstraints(rng, 4 + rng.below(10), -0.4);
    const LinearGoal goal{randomDirection(rng), 100.0};
    const Program program = programOf(constraints, goal);  // the solution refers to it
    const auto exact = CGAL::solve_quadratic_program(program, Exact());
    const auto found = solveLinearProgram(constraints, goal, order);
    EXPECT_EQ(found.has_value(), !exact.is_infeasible()) << "round " << round;
    infeasible += exact.is_infeasible() ? 1 : 0;
  }
  EXPECT_GT(infeasible, 20);
}

TEST(LinearProgram, StaysWhereItIsOnAFlatFloor) {
  std::vector<HalfSpace> floor(6, {{0.0, 0.0, 1.0}, 0.0});
  Rng order(1);
  const auto found = solveLinearProgram(floor, {{0.0, 0.0, 1.0}, 1e5}, order);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(glm::length(*found), 0.0, 1e-9);
}

}  // namespace
}  // namespace limn
