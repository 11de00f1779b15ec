// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/shaft.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kMostTurnBack = 0.25;    // turns
constexpr double kMostOfOneTurn = 1.001;  // turns that an angle which starts anew each turn may span

// From 0, without the jumps of an angle that starts anew each turn.
std::vector<double> Unwrapped(std::vector<double> angle_rad) {
  const bool wraps = SpanOf(angle_rad) <= kMostOfOneTurn * kTwoPi;
  const double first = angle_rad.front();
  double turns = 0.0;
  double before = first;
  for (double& angle : angle_rad) {
    if (wraps && angle - before > kPi) turns -= 1.0;
    if (wraps && angle - before < -kPi) turns += 1.0;
    before = angle;
    angle += kTwoPi * turns - first;
  }
  return angle_rad;
}

std::vector<double> Integrated(const std::vector<double>& time_s, const std::vector<double>& speed) {
  std::vector<double> angle_rad(speed.size(), 0.0);
  for (std::size_t i = 1; i < speed.size(); ++i)
    angle_rad[i] = angle_rad[i - 1] + 0.5 * (speed[i] + speed[i - 1]) * (time_s[i] - time_s[i - 1]);
  return angle_rad;
}

void ExpectOnePerSample(const char* what, std::size_t count, const VibrationRun& run,
                        const std::string& which) {
  if (count == run.size()) return;
  throw std::invalid_argument(
      fmt::format("{}{} values of the input {} for {} samples (expected one{} a sample)", which, count, what,
                  run.size(), what == std::string("speed") ? ", or one" : ""));
}

// Which way the shaft turns makes no difference to orders; but one way it has to turn.
void TakeOneWay(VibrationRun& run, std::vector<double> angle_rad, const std::string& which) {
  if (angle_rad.back() < 0.0) {
    for (double& angle : angle_rad) angle = -angle;
  }
  double furthest = 0.0;
  double back = 0.0;
  for (double& angle : angle_rad) {
    back = std::max(back, furthest - angle);
    angle = furthest = std::max(furthest, angle);
  }
  if (back > kMostTurnBack * kTwoPi) {
    throw std::invalid_argument(
        fmt::format("{}the input shaft turns {:.3g} turns forth and {:.3g} back (expected a shaft that turns "
                    "one way)",
                    which, furthest / kTwoPi, back / kTwoPi));
  }
  if (!(furthest > 0.0)) {
    throw std::invalid_argument(fmt::format("{}the input speed is zero (expected a turning shaft)", which));
  }
  run.angle_rad = std::move(angle_rad);
}

}  // namespace

void FindSpeeds(VibrationRun& run) {
  const std::size_t n = run.size();
  run.turns = run.angle_rad.back() / kTwoPi;
  run.mean_speed_rad_per_s = run.angle_rad.back() / run.span_s();
  const auto reach = static_cast<std::size_t>(
      std::clamp(static_cast<double>(n) / (8.0 * run.turns), 1.0, static_cast<double>(n) / 50.0));
  run.speed_rad_per_s.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = i > reach ? i - reach : 0;
    const std::size_t after = std::min(i + reach, n - 1);
    run.speed_rad_per_s[i] = (run.angle_rad[after] - run.angle_rad[before]) /
                             std::max(run.time_s[after] - run.time_s[before], 1e-300);
  }
  run.speed_spread = SpanOf(run.speed_rad_per_s) / run.mean_speed_rad_per_s;
}

void TakeSteadySpeed(VibrationRun& run, double speed_rad_per_s) {
  run.angle_rad.clear();
  for (const double time_s : run.time_s) run.angle_rad.push_back(speed_rad_per_s * time_s);
  run.speed_rad_per_s.assign(run.size(), speed_rad_per_s);
  run.mean_speed_rad_per_s = speed_rad_per_s;
  run.speed_spread = 0.0;
  run.turns = run.angle_rad.back() / kTwoPi;
}

void TakeShaft(VibrationRun& run, const VibrationData& record, const std::string& which) {
  if (!record.input_angle_rad.empty()) {
    ExpectOnePerSample("angle", record.input_angle_rad.size(), run, which);
    TakeOneWay(run, Unwrapped(record.input_angle_rad), which);
    FindSpeeds(run);
    return;
  }
  const std::vector<double>& speed = record.input_speed_rad_per_s;
  if (speed.empty()) return;
  if (speed.size() == 1) {
    if (speed.front() == 0.0) {
      throw std::invalid_argument(fmt::format("{}the input speed is zero (expected a turning shaft)", which));
    }
    TakeSteadySpeed(run, std::abs(speed.front()));
    return;
  }
  ExpectOnePerSample("speed", speed.size(), run, which);
  TakeOneWay(run, Integrated(run.time_s, speed), which);
  run.turns = run.angle_rad.back() / kTwoPi;
  run.speed_rad_per_s = speed;
  double mean = 0.0;
  for (const double value : speed) mean += value / static_cast<double>(run.size());
  if (mean < 0.0) {
    for (double& value : run.speed_rad_per_s) value = -value;
  }
  run.mean_speed_rad_per_s = std::abs(mean);
  run.speed_spread = SpanOf(run.speed_rad_per_s) / run.mean_speed_rad_per_s;
}

}  // namespace strainwave::analysis::diagnosis
