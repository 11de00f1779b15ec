// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/simulated_axis.h"

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/motion/samples.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kSmoothing_s = 0.02;  // half width of the path's local parabolas
constexpr std::size_t kFewestOnASide = 3;
constexpr double kStepsOfLoop = 40.0;  // in a period of the velocity loop
constexpr double kStepsOfSample = 20.0;
// A gap in the record: the axis is taken up again where it stands then.
constexpr double kLongestStep = 10.0;  // usual ones
// The loop is none where it is further off its path than this share of the travel.
constexpr double kOffItsPath = 0.05;

struct Path {
  std::vector<double> position, velocity, acceleration;
};

// Local parabolas over time, by least squares (Savitzky and Golay), at uneven instants.
Path Smoothed(std::span<const double> time_s, std::span<const double> position, double step_s) {
  const auto n = static_cast<std::ptrdiff_t>(position.size());
  const auto side =
      static_cast<std::ptrdiff_t>(std::max<double>(kFewestOnASide, std::round(kSmoothing_s / step_s)));
  Path path;
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    double s[5]{};
    double b[3]{};
    for (std::ptrdiff_t j = std::max<std::ptrdiff_t>(0, i - side); j <= std::min(n - 1, i + side); ++j) {
      const double u = (time_s[static_cast<std::size_t>(j)] - time_s[static_cast<std::size_t>(i)]) / step_s;
      if (std::abs(u) > kLongestStep * static_cast<double>(side)) continue;
      const double value = position[static_cast<std::size_t>(j)];
      double power = 1.0;
      for (int k = 0; k < 5; ++k, power *= u) {
        s[k] += power;
        if (k < 3) b[k] += power * value;
      }
    }
    const double d0 = s[2] * s[4] - s[3] * s[3];
    const double d1 = s[1] * s[4] - s[2] * s[3];
    const double d2 = s[1] * s[3] - s[2] * s[2];
    const double det = s[0] * d0 - s[1] * d1 + s[2] * d2;
    const double e1 = s[0] * s[4] - s[2] * s[2];
    const double e2 = s[0] * s[3] - s[1] * s[2];
    const double f2 = s[0] * s[2] - s[1] * s[1];
    path.position.push_back((d0 * b[0] - d1 * b[1] + d2 * b[2]) / det);
    path.velocity.push_back((-d1 * b[0] + e1 * b[1] - e2 * b[2]) / det / step_s);
    path.acceleration.push_back(2.0 * (d2 * b[0] - e2 * b[1] + f2 * b[2]) / det / (step_s * step_s));
  }
  return path;
}

double SquareOf(double x) { return x * x; }

// An inertia on a bristle: friction is the bristle's stiffness times its bend, and Coulomb's where that is
// more. Both ends of a step by the backward rule, so that any stiffness is stable.
class BristleAxis {
 public:
  BristleAxis(const AxisNumbers& numbers, double presliding)
      : numbers_(numbers), stiffness_(numbers.coulomb / presliding) {}

  void PutAt(double position, double velocity) {
    position_ = position;
    velocity_ = velocity;
    bend_ = 0.0;
  }
  void Step(double torque, double step_s) {
    const double free = numbers_.inertia * velocity_ + step_s * (torque - numbers_.offset);
    const double drag = numbers_.inertia + step_s * numbers_.viscous;
    const double stuck = (free - step_s * stiffness_ * bend_) / (drag + step_s * step_s * stiffness_);
    const double friction = stiffness_ * (bend_ + step_s * stuck);
    if (std::abs(friction) <= numbers_.coulomb) {
      velocity_ = stuck;
      bend_ += step_s * stuck;
    } else {
      const double sliding = std::copysign(numbers_.coulomb, friction);
      velocity_ = (free - step_s * sliding) / drag;
      bend_ = sliding / stiffness_;
    }
    position_ += step_s * velocity_;
  }
  double position() const { return position_; }
  double velocity() const { return velocity_; }

 private:
  AxisNumbers numbers_;
  double stiffness_;
  double position_{};
  double velocity_{};
  double bend_{};
};

struct Loop {
  double velocity_gain, integral_gain, position_gain;
};

Loop LoopOf(double inertia, double bandwidth_Hz) {
  const double velocity_rad_per_s = kTwoPi * 4.0 * bandwidth_Hz;
  return {inertia * velocity_rad_per_s, inertia * SquareOf(velocity_rad_per_s) / 5.0, kTwoPi * bandwidth_Hz};
}

}  // namespace

std::optional<MotionData> SimulateAxis(const MotionData& measured, const AxisNumbers& numbers,
                                       std::uint64_t draw) {
  const std::size_t n = measured.position.size();
  if (!(numbers.inertia > 0.0) || !(numbers.coulomb > 0.0) || numbers.viscous < 0.0) return std::nullopt;
  std::vector<double> steps;
  for (std::size_t i = 1; i < n; ++i) steps.push_back(measured.time_s[i] - measured.time_s[i - 1]);
  std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
  const double step_s = steps[steps.size() / 2];
  const MotionSamples samples = PrepareMotion({&measured, 1});
  const auto [lowest, highest] = std::ranges::minmax(measured.position);
  const double travel = highest - lowest;

  boost::random::mt19937_64 random(draw);
  boost::random::normal_distribution<double> normal;
  boost::random::uniform_real_distribution<double> uniform;
  const double presliding = travel * std::pow(10.0, -5.0 + 1.5 * uniform(random));
  const double bandwidth_Hz = 5.0 * std::pow(6.0, uniform(random));
  const Loop loop = LoopOf(numbers.inertia, bandwidth_Hz);
  const Path path = Smoothed(measured.time_s, measured.position, step_s);
  const double fine_s = std::min(step_s / kStepsOfSample, 1.0 / (4.0 * bandwidth_Hz * kStepsOfLoop));

  MotionData simulated = measured;
  BristleAxis axis(numbers, presliding);
  axis.PutAt(path.position[0], path.velocity[0]);
  double integral = numbers.offset;
  double torque = integral;
  double off = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double seen = axis.position() + samples.position_noise * normal(random);
    const double quantum = samples.position_step;
    simulated.position[i] = quantum > 0.0 ? quantum * std::round(seen / quantum) : seen;
    simulated.torque[i] = torque + samples.torque_noise * normal(random);
    if (!measured.velocity.empty())
      simulated.velocity[i] = axis.velocity() + samples.velocity_noise * normal(random);
    off += SquareOf(axis.position() - path.position[i]);
    if (i + 1 == n) break;
    const double until_next_s = measured.time_s[i + 1] - measured.time_s[i];
    if (until_next_s > kLongestStep * step_s) {
      axis.PutAt(path.position[i + 1], path.velocity[i + 1]);
      continue;
    }
    const int parts = std::max(1, static_cast<int>(std::ceil(until_next_s / fine_s)));
    const double part_s = until_next_s / parts;
    for (int part = 0; part < parts; ++part) {
      const double share = static_cast<double>(part + 1) / parts;
      const auto at = [&](const std::vector<double>& of) { return of[i] + share * (of[i + 1] - of[i]); };
      const double error =
          at(path.velocity) + loop.position_gain * (at(path.position) - axis.position()) - axis.velocity();
      integral += loop.integral_gain * error * part_s;
      torque = loop.velocity_gain * error + integral + numbers.inertia * at(path.acceleration);
      axis.Step(torque, part_s);
    }
  }
  off = std::sqrt(off / static_cast<double>(n));
  if (!(off < kOffItsPath * travel)) return std::nullopt;
  return simulated;
}

}  // namespace strainwave::analysis::diagnosis
