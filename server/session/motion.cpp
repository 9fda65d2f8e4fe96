// SPDX-License-Identifier: Apache-2.0
//
// Based on: R. M. Murray, Z. Li, S. S. Sastry, "A Mathematical Introduction to Robotic
// Manipulation" (1994), ch. 2: exponential and logarithm of a rigid motion.
#include "server/session/motion.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>

namespace limn {
namespace {

/// Older than this, or after such a pause, a pose says nothing about the present motion.
constexpr std::int64_t kMemoryMs = 600;

glm::dmat3 frameOf(const protocol::Pose& pose) {
  const glm::dvec3 backward = -glm::normalize(pose.forward);
  const glm::dvec3 right = glm::normalize(glm::cross(glm::normalize(pose.up), backward));
  return {right, glm::cross(backward, right), backward};
}

glm::dmat3 crossMatrix(const glm::dvec3& w) {
  return {{0.0, w.z, -w.y}, {-w.z, 0.0, w.x}, {w.y, -w.x, 0.0}};
}

/// A rigid motion x → rotation · x + shift.
struct Rigid {
  glm::dmat3 rotation{1.0};
  glm::dvec3 shift{0.0};
};

/// A motion as its screw: angle and axis, and the velocity of the origin.
struct Screw {
  glm::dvec3 turn{0.0};
  glm::dvec3 velocity{0.0};
};

Screw logOf(const Rigid& motion) {
  glm::dquat q = glm::quat_cast(motion.rotation);
  if (q.w < 0.0) q = -q;
  const glm::dvec3 imaginary(q.x, q.y, q.z);
  const double sine = glm::length(imaginary);
  const double angle = 2.0 * std::atan2(sine, q.w);
  if (angle < 1e-6) return {glm::dvec3(0.0), motion.shift};
  const glm::dvec3 turn = imaginary / sine * angle;
  const glm::dmat3 w = crossMatrix(turn);
  const double tail = (1.0 - 0.5 * angle / std::tan(0.5 * angle)) / (angle * angle);
  return {turn, (glm::dmat3(1.0) - 0.5 * w + tail * (w * w)) * motion.shift};
}

Rigid expOf(const Screw& screw) {
  const double angle = glm::length(screw.turn);
  if (angle < 1e-6) return {glm::dmat3(1.0), screw.velocity};
  const glm::dmat3 w = crossMatrix(screw.turn);
  const double a = std::sin(angle) / angle;
  const double b = (1.0 - std::cos(angle)) / (angle * angle);
  const double c = (1.0 - a) / (angle * angle);
  const glm::dmat3 one(1.0);
  return {one + a * w + b * (w * w), (one + b * w + c * (w * w)) * screw.velocity};
}

}  // namespace

void Motion::add(const protocol::Pose& pose, std::int64_t nowMs) {
  if (count_ > 0 && nowMs - samples_[count_ - 1].atMs > kMemoryMs) count_ = 0;
  const Sample sample{pose.eye, frameOf(pose), nowMs};
  newest_ = pose;
  // Poses of the same moment tell no speed: the later one stands for both.
  if (count_ > 0 && nowMs <= samples_[count_ - 1].atMs) --count_;
  if (count_ == kSamples) {
    std::move(samples_.begin() + 1, samples_.end(), samples_.begin());
    --count_;
  }
  samples_[count_++] = sample;
}

std::optional<protocol::Pose> Motion::at(std::int64_t aheadMs) const {
  if (count_ < 2) return std::nullopt;
  const Sample& last = samples_[count_ - 1];
  std::size_t first = 0;
  while (last.atMs - samples_[first].atMs > kMemoryMs)
    ++first;
  if (first + 1 >= count_) return std::nullopt;
  const Sample& old = samples_[first];
  Rigid motion;
  motion.rotation = last.frame * glm::transpose(old.frame);
  motion.shift = last.eye - motion.rotation * old.eye;
  if (last.eye == old.eye && last.frame == old.frame) return std::nullopt;
  Screw screw = logOf(motion);
  const double factor = static_cast<double>(aheadMs) / static_cast<double>(last.atMs - old.atMs);
  screw.turn *= factor;
  screw.velocity *= factor;
  const Rigid ahead = expOf(screw);
  protocol::Pose pose = newest_;
  pose.eye = ahead.rotation * last.eye + ahead.shift;
  pose.forward = -(ahead.rotation * last.frame[2]);
  pose.up = ahead.rotation * last.frame[1];
  return pose;
}

}  // namespace limn
