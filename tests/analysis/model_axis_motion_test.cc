// SPDX-License-Identifier: Apache-2.0
#include "analysis/model/axis_motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::analysis::model::model_axis_motion_test {
namespace {

constexpr double kContact = 120.0;     // rad/s of an inertia behind backlash on its contact, half damped
constexpr double kLoadFriction = 3.0;  // of it, as a deceleration in rad/s²

// A load on its own between the two ends of a gap, by many small steps.
std::vector<double> PushesOver(double gap, double start, double step_s, std::size_t count,
                               const std::function<double(double time_s)>& near) {
  constexpr int kSmaller = 10;
  const double h = step_s / kSmaller;
  const double stiffness = kContact * kContact;
  double load = near(0.0) - 0.5 * start * gap;
  double speed = (near(h) - near(-h)) / (2.0 * h);
  std::vector<double> pushes{0.0};
  for (std::size_t i = 1; i < count; ++i) {
    double push = 0.0;
    for (int k = 1; k <= kSmaller; ++k) {
      const double time_s = step_s * static_cast<double>(i - 1) + h * k;
      const double into = std::abs(near(time_s) - load) - 0.5 * gap;
      const double sense = near(time_s) > load ? 1.0 : -1.0;
      const double closing = (near(time_s + h) - near(time_s - h)) / (2.0 * h) - speed;
      push = into > 0.0 ? sense * std::max(0.0, stiffness * into + sense * kContact * closing) : 0.0;
      const double pushed = speed + h * push;
      speed = std::abs(pushed) <= h * kLoadFriction ? 0.0 : pushed - std::copysign(h * kLoadFriction, pushed);
      load += h * speed;
    }
    pushes.push_back(push);
  }
  return pushes;
}

// By how much the pushes over a gap are off those of steps that are so much finer, over their size.
double ShareOff(double start, double step_s, std::size_t count, std::size_t finer) {
  constexpr double kGap = 0.02;
  const auto near = [](double time_s) { return std::sin(4.0 * time_s) + 0.3 * std::sin(9.0 * time_s + 1.0); };
  const auto speed = [](double time_s) {
    return 4.0 * std::cos(4.0 * time_s) + 2.7 * std::cos(9.0 * time_s + 1.0);
  };
  const std::vector<double> over_gap =
      PushesOver(kGap, start, step_s / static_cast<double>(finer), count * finer, near);
  InertiaBehindBacklash load(
      {.gap = kGap, .friction = kLoadFriction, .contact_rad_per_s = kContact, .start = start}, near(0.0),
      speed(0.0));
  double square = 0.0;
  double off_square = 0.0;
  for (std::size_t i = 1; i < count; ++i) {
    const double time_s = step_s * static_cast<double>(i);
    const double push = load.Follow(near(time_s), speed(time_s), step_s);
    square += over_gap[i * finer] * over_gap[i * finer];
    off_square += std::pow(push - over_gap[i * finer], 2);
  }
  return std::sqrt(off_square / square);
}

// Impacts come by a part of a step too early or too late.
TEST(InertiaBehindBacklash, IsPushedAtTheEndsOfItsGapAlone) {
  for (const double start : {1.0, 0.0, -1.0}) EXPECT_LT(ShareOff(start, 0.0001, 60000, 1), 0.1) << start;
}

// A quarter of a radian of the contact's swing is one step.
TEST(InertiaBehindBacklash, IsPushedTheSameOverLongSteps) {
  EXPECT_LT(ShareOff(1.0, 0.002, 1500, 100), 0.12);
}

TEST(InertiaBehindBacklash, IsPushedLikeARigidOneWithoutAGap) {
  InertiaBehindBacklash load({.gap = 0.0, .friction = kLoadFriction, .contact_rad_per_s = kContact}, 0.0,
                             1.0);
  for (int i = 1; i < 700; ++i) {
    const double time_s = 0.002 * i;
    const double push = load.Follow(std::sin(time_s), std::cos(time_s), 0.002);
    if (i < 100) continue;  // it settles on its contact
    EXPECT_NEAR(push, kLoadFriction - std::sin(time_s), 0.01);
  }
}

}  // namespace
}  // namespace strainwave::analysis::model::model_axis_motion_test
