// SPDX-License-Identifier: Apache-2.0
#include "analysis/transmission_error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "analysis/angle_weights.h"
#include "analysis/arguments.h"
#include "analysis/extremes_under_noise.h"
#include "analysis/mean_over_angle.h"
#include "analysis/noise_level.h"
#include "analysis/transmission_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

constexpr std::size_t kFewestSweepSamples = 8;
constexpr std::size_t kMinSteps = 36;
constexpr double kLongestStep_rad = 1.5 * kTwoPi / static_cast<double>(kMinSteps);
constexpr double kMaxRatioDeviation = 0.01;
// A sample that stands off alone: in noise of the others, and of the range of the error.
constexpr double kOffByNoise = 10.0;
constexpr double kOffByDeviation = 6.0;  // standard deviations over the angle, itself among them
constexpr double kOffByRange = 0.02;
constexpr double kOffAtLeast_rad = RadFromArcsec(1.0);
constexpr double kNeighboursOff = 0.3;  // of it: damage of a tooth reaches further

void RequireSweep(const char* direction, const AngleSweep& sweep) {
  const std::string input = fmt::format("{}.input_angle_rad", direction);
  const std::string output = fmt::format("{}.output_angle_rad", direction);
  RequireSameLength(input, sweep.input_angle_rad, output, sweep.output_angle_rad);
  if (sweep.input_angle_rad.empty()) {
    return;
  }
  RequireAtLeast(input, sweep.input_angle_rad, kFewestSweepSamples);
  RequireFinite(input, sweep.input_angle_rad);
  RequireFinite(output, sweep.output_angle_rad);
}

double Direction(std::span<const double> angle_rad) {
  return angle_rad.back() >= angle_rad.front() ? 1.0 : -1.0;
}

// Number of samples of the first revolution: up to the first one that has come round.
std::size_t FirstRevolution(std::span<const double> output_rad) {
  const double whole_rad = kTwoPi - 0.25 * UsualStep(output_rad);
  const double direction = Direction(output_rad);
  for (std::size_t i = 0; i < output_rad.size(); ++i) {
    if (direction * (output_rad[i] - output_rad.front()) >= whole_rad) {
      return std::max(i, kFewestSweepSamples);
    }
  }
  return output_rad.size();
}

double Slope(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / n;
  const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / n;
  double xy = 0.0;
  double xx = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mean_x) * (y[i] - mean_y);
    xx += (x[i] - mean_x) * (x[i] - mean_x);
  }
  return xy / xx;
}

// Where the longest step ends.
std::size_t LongestStep(std::span<const double> angle_rad) {
  std::size_t longest = 1;
  const auto step = [&](std::size_t i) { return std::abs(angle_rad[i] - angle_rad[i - 1]); };
  for (std::size_t i = 2; i < angle_rad.size(); ++i) {
    if (step(i) > step(longest)) longest = i;
  }
  return longest;
}

void CheckSweep(const char* direction, const AngleSweep& sweep, double ratio, std::size_t used,
                std::vector<std::string>* failed) {
  const auto output_rad = sweep.output_angle_rad.first(used);
  const auto input_rad = sweep.input_angle_rad.first(used);
  const double step_rad = UsualStep(output_rad);
  const double travel_rad = std::abs(output_rad.back() - output_rad.front());
  const auto steps = static_cast<std::size_t>(std::lround(travel_rad / step_rad)) + 1;
  const std::size_t longest = LongestStep(output_rad);
  const double longest_rad = std::abs(output_rad[longest] - output_rad[longest - 1]);
  if (std::min(steps, used) < kMinSteps) {
    failed->push_back(fmt::format("{}: {} steps in the revolution (expected at least {})", direction,
                                  std::min(steps, used), kMinSteps));
  } else if (longest_rad > kLongestStep_rad) {
    failed->push_back(
        fmt::format("{}: the sweep leaves out {:.3g} deg behind {:.4g} deg (expected steps of {:.3g} "
                    "deg at most)",
                    direction, DegFromRad(longest_rad), DegFromRad(output_rad[longest - 1]),
                    DegFromRad(kLongestStep_rad)));
  }
  if (travel_rad + 1.5 * step_rad < kTwoPi) {
    failed->push_back(fmt::format("{}: the sweep covers {:.5g} deg of the output (expected 360 deg)",
                                  direction, DegFromRad(travel_rad + step_rad)));
  }
  const double slope = Slope(output_rad, input_rad);
  if (!(std::abs(slope / ratio - 1.0) <= kMaxRatioDeviation)) {
    failed->push_back(fmt::format("{}: ratio looks like {:.4g}, file says {:.6g}", direction, slope, ratio));
  }
  // Play for a stepper that settles, and for the noise of an encoder that is read on the move.
  const double play_rad = std::max(0.25 * step_rad, 10.0 * EstimateNoise(output_rad).standard_deviation);
  const double sign = Direction(output_rad);
  double furthest_rad = output_rad.front();
  for (std::size_t i = 1; i < used; ++i) {
    if (sign * (output_rad[i] - furthest_rad) < -play_rad) {
      failed->push_back(fmt::format("{}: the output turns back at sample {}, at {:.5g} deg", direction, i,
                                    DegFromRad(output_rad[i])));
      return;
    }
    furthest_rad = sign > 0.0 ? std::max(furthest_rad, output_rad[i]) : std::min(furthest_rad, output_rad[i]);
  }
}

bool StartsAtZero(const AngleSweep& sweep) {
  return !sweep.input_angle_rad.empty() && sweep.input_angle_rad.front() == 0.0 &&
         sweep.output_angle_rad.front() == 0.0;
}

struct AnalysedSweep {
  SweepError error;
  double mean_error_rad{};  // standard error of the mean, without that of the zero
  HarmonicFit fit;
  std::vector<std::string> notes;
  std::vector<std::size_t> lone;  // samples that stand off what the orders say, alone
  std::string hidden;             // OrderAnalysis::second_harmonic_hidden
};

std::vector<std::size_t> LoneSamples(std::span<const double> residuals, std::span<const double> weights,
                                     double range) {
  double squares = 0.0;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    squares += std::abs(weights[i]) * residuals[i] * residuals[i];
  const double off = std::max({kOffByNoise * RobustStandardDeviation(residuals),
                               kOffByDeviation * std::sqrt(squares), kOffByRange * range, kOffAtLeast_rad});
  std::vector<std::size_t> lone;
  for (std::size_t i = 1; i + 1 < residuals.size(); ++i) {
    const double beside = std::max(std::abs(residuals[i - 1]), std::abs(residuals[i + 1]));
    if (std::abs(residuals[i]) > off && beside < kNeighboursOff * std::abs(residuals[i])) lone.push_back(i);
  }
  return lone;
}

AnalysedSweep AnalyseSweep(const AngleSweep& sweep, double ratio, std::size_t used, bool zeroed) {
  AnalysedSweep result;
  SweepError& error = result.error;
  error.output_angle_rad.assign(sweep.output_angle_rad.begin(),
                                sweep.output_angle_rad.begin() + static_cast<std::ptrdiff_t>(used));
  for (std::size_t i = 0; i < used; ++i) {
    error.error_rad.push_back(sweep.input_angle_rad[i] / ratio - sweep.output_angle_rad[i]);
  }
  OrderAnalysis orders = AnalyseOrders(error.output_angle_rad, error.error_rad, ratio);
  const double sigma_rad = orders.fit.residual_standard_deviation;
  error.noise_rad = sigma_rad;
  const std::vector<double> weights = AngleWeights(error.output_angle_rad);
  const Estimate mean_rad = MeanOverAngle({error.output_angle_rad, orders.fit});
  result.mean_error_rad = mean_rad.standard_error;
  error.e_avg_rad = {mean_rad.value, std::hypot(mean_rad.standard_error, zeroed ? sigma_rad : 0.0)};

  std::vector<double> smooth_rad(used);
  for (std::size_t i = 0; i < used; ++i) {
    smooth_rad[i] = error.error_rad[i] - orders.fit.residuals[i];
  }
  const auto [low, high] = std::minmax_element(error.error_rad.begin(), error.error_rad.end());
  const RangeUnderNoise range = ExpectRangeUnderNoise(smooth_rad, sigma_rad);
  error.e_max_rad = {*high - *low, range.root_mean_square_error};
  error.e_max_noise_bias_rad = range.bias;
  result.lone = LoneSamples(orders.fit.residuals, weights, error.e_max_rad.value);
  error.orders = std::move(orders.lines);
  result.notes = std::move(orders.notes);
  result.hidden = std::move(orders.second_harmonic_hidden);
  result.fit = std::move(orders.fit);
  return result;
}

}  // namespace

TransmissionError ComputeTransmissionError(const AngleSweep& cw, const AngleSweep& ccw, double ratio) {
  if (!std::isfinite(ratio) || ratio == 0.0) {
    throw std::invalid_argument(fmt::format("ratio = {} is not a finite number other than zero", ratio));
  }
  RequireSweep("cw", cw);
  RequireSweep("ccw", ccw);
  if (cw.input_angle_rad.empty() && ccw.input_angle_rad.empty()) {
    throw std::invalid_argument("cw and ccw are both empty (expected samples of one direction at least)");
  }
  TransmissionError result;
  std::optional<AnalysedSweep> analysed[2];
  const AngleSweep* sweeps[2] = {&cw, &ccw};
  const char* names[2] = {"cw", "ccw"};
  const bool zeroed = StartsAtZero(cw) || StartsAtZero(ccw);
  for (int k = 0; k < 2; ++k) {
    if (sweeps[k]->input_angle_rad.empty()) {
      continue;
    }
    const std::size_t used = FirstRevolution(sweeps[k]->output_angle_rad);
    if (sweeps[k]->output_angle_rad.front() == sweeps[k]->output_angle_rad[used - 1]) {
      result.failed_checks.push_back(fmt::format("{}: the output does not turn", names[k]));
      continue;
    }
    CheckSweep(names[k], *sweeps[k], ratio, used, &result.failed_checks);
    analysed[k] = AnalyseSweep(*sweeps[k], ratio, used, zeroed);
    for (const std::size_t sample : analysed[k]->lone) {
      result.failed_checks.push_back(fmt::format(
          "{}: sample {} at {:.5g} deg stands off all others alone (expected none: its angles are wrong)",
          names[k], sample, DegFromRad(sweeps[k]->output_angle_rad[sample])));
    }
    if (!analysed[k]->hidden.empty()) {
      result.failed_checks.push_back(fmt::format(
          "{}: {} (expected other steps: mean and range do not hold it)", names[k], analysed[k]->hidden));
    }
    for (std::string& note : analysed[k]->notes) {
      if (std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end()) {
        result.notes.push_back(std::move(note));
      }
    }
  }
  if (analysed[0] && analysed[1]) {
    if (Direction(cw.output_angle_rad) == Direction(ccw.output_angle_rad)) {
      result.failed_checks.push_back("the cw and the ccw sweep turn the same way");
    }
    const auto curve = [](const AnalysedSweep& sweep) {
      return MeasuredCurve{sweep.error.output_angle_rad, sweep.fit};
    };
    if (const auto lost_rad = MeanDifferenceAtEqualAngle(curve(*analysed[0]), curve(*analysed[1]))) {
      result.lost_motion_rad = {*lost_rad,
                                std::hypot(analysed[0]->mean_error_rad, analysed[1]->mean_error_rad)};
    }
  }
  if (analysed[0]) {
    result.cw = std::move(analysed[0]->error);
  }
  if (analysed[1]) {
    result.ccw = std::move(analysed[1]->error);
  }
  return result;
}

}  // namespace strainwave::analysis
