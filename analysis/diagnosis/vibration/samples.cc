// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/samples.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/lone_samples.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/vibration/shaft.h"
#include "analysis/diagnosis/vibration/shared_noise.h"
#include "analysis/diagnosis/vibration/spectrum.h"
#include "analysis/diagnosis/vibration/speed.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewestSamples = 256;
constexpr double kFewestTurns = 2.0;
constexpr double kFewestSamplesPerTurn = 4.0;
constexpr double kRefusedClipping = 0.05;  // share of samples

// Samples at the end of the range, if the range is what ends there: in a histogram of a free signal the last
// level holds fewer than the one before.
std::size_t Clipped(std::vector<double> values, double& at) {
  std::sort(values.begin(), values.end());
  std::size_t clipped = 0;
  for (const bool top : {false, true}) {
    if (top) std::reverse(values.begin(), values.end());
    const auto end =
        std::find_if(values.begin(), values.end(), [&](double v) { return v != values.front(); });
    const auto count = static_cast<std::size_t>(end - values.begin());
    if (end == values.end()) continue;
    const auto next =
        static_cast<std::size_t>(std::find_if(end, values.end(), [&](double v) { return v != *end; }) - end);
    if (count >= 8 && count > 3 * next) {
      clipped += count;
      at = values.front();
    }
  }
  return clipped;
}

void CheckTime(VibrationSamples& samples, VibrationRun& run, const std::string& which) {
  std::vector<double> steps;
  std::size_t repeated = 0;
  for (std::size_t i = 1; i < run.size(); ++i) {
    const double step = run.time_s[i] - run.time_s[i - 1];
    if (step < 0.0) {
      throw std::invalid_argument(
          fmt::format("{}time runs backwards at sample {} (expected ascending time)", which, i));
    }
    if (step == 0.0) ++repeated;
    steps.push_back(step);
  }
  run.period_s = Median(steps);
  if (!(run.time_s.back() > 0.0)) {
    throw std::invalid_argument(fmt::format("{}time stands still (expected ascending time)", which));
  }
  if (repeated * 200 > run.size()) {
    samples.warnings.push_back(fmt::format(
        "{}{:.1f} % of the time stamps repeat the one before: the samples are taken as evenly spaced", which,
        100.0 * static_cast<double>(repeated) / static_cast<double>(steps.size())));
    run.period_s = run.time_s.back() / static_cast<double>(steps.size());
    for (std::size_t i = 0; i < run.size(); ++i) run.time_s[i] = run.period_s * static_cast<double>(i);
    return;
  }
  double spread = 0.0;
  std::size_t counted = 0;
  for (const double step : steps) {
    if (step > 1.6 * run.period_s) continue;
    spread += (step - run.period_s) * (step - run.period_s);
    ++counted;
  }
  spread = std::sqrt(spread / static_cast<double>(std::max<std::size_t>(counted, 1))) / run.period_s;
  if (spread > 0.05) {
    samples.warnings.push_back(
        fmt::format("{}the time stamps jitter by {:.0f} % of the sampling period: lines near half the "
                    "sampling rate are smeared",
                    which, 100.0 * spread));
  }
}

// Without the shaft's own line at 2 per turn below half the sampling rate no order means anything.
void ExpectSampledTurns(const VibrationRun& run) {
  const double samples_per_turn = static_cast<double>(run.size()) / run.turns;
  if (samples_per_turn >= kFewestSamplesPerTurn) return;
  throw std::invalid_argument(fmt::format(
      "the input shaft makes {:.4g} turns a sample, {:.4g} rpm (expected at least {:.0f} samples a "
      "turn, and a speed in rpm or an angle in degrees)",
      1.0 / samples_per_turn, RpmFromRadPerS(run.mean_speed_rad_per_s), kFewestSamplesPerTurn));
}

void TakeChannels(VibrationSamples& samples, VibrationRun& run, const VibrationData& record,
                  const std::string& which, std::vector<std::vector<double>>& values) {
  for (const VibrationChannel& channel : record.channels) {
    if (channel.values.size() != run.size()) {
      throw std::invalid_argument(fmt::format("{}{} has {} samples, time has {} (expected as many)", which,
                                              channel.name, channel.values.size(), run.size()));
    }
    if (!(SpanOf(channel.values) > 0.0)) {
      samples.warnings.push_back(fmt::format("{}{} is constant at {:.6g} and was left out", which,
                                             channel.name, channel.values.front()));
      continue;
    }
    double at = 0.0;
    const std::size_t clipped = Clipped(channel.values, at);
    const double share = static_cast<double>(clipped) / static_cast<double>(run.size());
    const std::string found =
        fmt::format("{}{} is clipped: {:.1f} % of its samples stand at the end of the range, {:.4g}", which,
                    channel.name, 100.0 * share, at);
    if (share > kRefusedClipping) {
      throw std::invalid_argument(found + " (expected a range that holds the vibration)");
    }
    if (clipped > 0) samples.warnings.push_back(found + "; odd multiples of strong lines may come from that");
    run.channels.push_back({channel.name, 0, 1.0});
    values.push_back(channel.values);
  }
  if (run.channels.empty()) {
    throw std::invalid_argument(
        fmt::format("{}no channel moves (expected at least one accelerometer)", which));
  }
}

// Spikes are left out of every fit: with them in its scale a channel would count for more or less than the
// others, and what is found in the one that counts for more would look clearer than it is.
std::vector<double> WithoutLoneSamples(std::vector<double> values) {
  InterpolateOver(values, FindLoneSamples(values, EstimateNoise(values).step));
  return values;
}

// Without the shaft's lines: where the speed changes they are as broad as what they change by, and no median
// of a spectrum passes them over.
std::vector<double> WithoutLines(const VibrationRun& run, const std::vector<double>& channel) {
  std::vector<double> values = WithoutLoneSamples(channel);
  if (!run.angle_rad.empty()) {
    Eigen::Map<Eigen::VectorXd> all(values.data(), static_cast<Eigen::Index>(values.size()));
    const Eigen::MatrixXd gram = run.nominal.transpose() * run.nominal;
    const Eigen::VectorXd right = run.nominal.transpose() * all;
    all -= run.nominal * SymmetricFactor(gram).Solve(right);
  }
  return values;
}

}  // namespace

std::size_t VibrationSamples::channels() const {
  std::size_t count = 0;
  for (const VibrationRun& run : runs) count += run.channels.size();
  return count;
}

double VibrationSamples::highest_Hz() const {
  double highest = 1e300;
  for (const VibrationRun& run : runs) highest = std::min(highest, 0.5 / run.period_s);
  return highest;
}

double VibrationSamples::highest_order() const {
  double highest = 1e300;
  for (const VibrationRun& run : runs) {
    highest = std::min(highest, kPi / (run.period_s * run.mean_speed_rad_per_s));
  }
  return highest;
}

double VibrationSamples::shortest_turns() const {
  double turns = 1e300;
  for (const VibrationRun& run : runs) turns = std::min(turns, run.turns);
  return turns;
}

void FillNominal(VibrationRun& run) {
  const auto n = static_cast<Eigen::Index>(run.size());
  run.nominal.resize(n, run.angle_rad.empty() ? 1 : 5);
  run.nominal.col(0).setOnes();
  if (run.angle_rad.empty()) return;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double angle = run.angle_rad[static_cast<std::size_t>(i)];
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    run.nominal(i, 1) = c;
    run.nominal(i, 2) = s;
    run.nominal(i, 3) = c * c - s * s;
    run.nominal(i, 4) = 2.0 * s * c;
  }
}

VibrationSamples PrepareVibration(std::span<const VibrationData> records) {
  VibrationSamples samples;
  if (records.empty()) throw std::invalid_argument("there is no record (expected at least one)");
  samples.ratio = records.front().ratio;
  std::vector<std::vector<double>> values;
  bool measured_speed = true;
  bool any_without_speed = false;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const VibrationData& record = records[r];
    const std::string which = records.size() > 1 ? fmt::format("record {}: ", r + 1) : std::string();
    VibrationRun run;
    if (record.time_s.size() < kFewestSamples) {
      throw std::invalid_argument(fmt::format("{}the record has {} samples (expected at least {})", which,
                                              record.time_s.size(), kFewestSamples));
    }
    run.time_s = record.time_s;
    for (double& time : run.time_s) time -= record.time_s.front();
    CheckTime(samples, run, which);
    for (const double time : run.time_s) run.time_2pi.push_back(kTwoPi * time);
    TakeShaft(run, record, which);
    measured_speed = measured_speed && record.KnowsSpeedOfSamples();
    any_without_speed = any_without_speed || run.angle_rad.empty();
    TakeChannels(samples, run, record, which, values);
    if (!run.angle_rad.empty() && run.turns < kFewestTurns) {
      throw std::invalid_argument(
          fmt::format("{}the record is too short: {:.2f} turns of the input shaft at {:.4g} rpm (expected at "
                      "least {:.0f})",
                      which, run.turns, RpmFromRadPerS(run.mean_speed_rad_per_s), kFewestTurns));
    }
    samples.runs.push_back(std::move(run));
  }

  std::vector<double> noise;
  double mean_square = 0.0;
  for (VibrationRun& run : samples.runs) {
    FillNominal(run);
    std::vector<std::vector<double>> left;
    for (std::size_t of_run = 0; of_run < run.channels.size(); ++of_run) {
      const std::vector<double>& channel = values[noise.size()];
      const double rms = std::sqrt(
          Eigen::Map<const Eigen::VectorXd>(channel.data(), static_cast<Eigen::Index>(channel.size()))
              .squaredNorm() /
          static_cast<double>(channel.size()));
      left.push_back(WithoutLines(run, channel));
      noise.push_back(std::max(BroadbandDeviation(left.back()), 1e-9 * rms));
      mean_square += noise.back() * noise.back() / static_cast<double>(values.size());
    }
    run.decorrelation = DecorrelationOf(left);
  }
  samples.noise_floor = std::sqrt(mean_square);
  std::size_t c = 0;
  for (std::size_t r = 0; r < samples.runs.size(); ++r) {
    VibrationRun& run = samples.runs[r];
    for (VibrationSegment& channel : run.channels) {
      channel.first = samples.measured.size();
      samples.channel_starts.push_back(channel.first);
      channel.scale = samples.noise_floor / noise[c];
      if (samples.runs.size() > 1) channel.name += fmt::format("_{}", r + 1);
      for (std::size_t i = 0; i < run.size(); ++i) {
        if (i == 0 || run.FollowsAGap(i)) samples.segments.push_back(samples.measured.size());
        samples.measured.push_back(channel.scale * values[c][i]);
      }
      ++c;
    }
  }

  if (any_without_speed) {
    for (VibrationRun& run : samples.runs) run.angle_rad.clear();
    const double speed = samples.runs.size() == 1 ? SpeedFromLines(samples) : 0.0;
    if (speed > 0.0) {
      TakeSteadySpeed(samples.runs.front(), speed);
    } else {
      samples.warnings.push_back(
          "the record does not say the input speed, and no pair of lines gives it away: orders cannot be "
          "told from "
          "fixed frequencies, only resonances and lines in Hz can be looked for (expected input_speed_rpm)");
    }
  }
  for (VibrationRun& run : samples.runs) FillNominal(run);
  if (!samples.angle_known()) return samples;
  CorrectSpeed(samples, any_without_speed ? SpeedSource::kItsLines
                        : measured_speed  ? SpeedSource::kMeasured
                                          : SpeedSource::kStated);
  if (any_without_speed) {
    samples.warnings.push_back(
        fmt::format("the record does not say the input speed: {:.4g} rpm was taken from a pair of lines at "
                    "1 and 2 per turn",
                    RpmFromRadPerS(samples.runs.front().mean_speed_rad_per_s)));
  }
  for (const VibrationRun& run : samples.runs) ExpectSampledTurns(run);
  return samples;
}

}  // namespace strainwave::analysis::diagnosis
