// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/rotation_results.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "analysis/efficiency.h"
#include "analysis/quantities.h"
#include "analysis/samples/holds.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kFewestRows = 8;
// When the brake lets go, the input swings on its presliding springs by some hundredths of a radian at some
// 40 Hz; over this time the swing averages out, and what is left is motion.
constexpr double kSpeedTime_s = 0.05;
constexpr double kMovingSpeed_rad_per_s = 2.0;

std::vector<double> Numbers(const daq::Record& record, std::string_view name) {
  const daq::Column* column = record.FindColumn(name);
  if (column == nullptr) return {};
  if (const auto* wide = std::get_if<std::vector<double>>(&column->values)) return *wide;
  if (const auto* narrow = std::get_if<std::vector<float>>(&column->values)) {
    return {narrow->begin(), narrow->end()};
  }
  return {};
}

// The breakaway of the unloaded gear, at the input. The drive's own speed is too noisy near zero; the
// encoder's travel over some samples tells presliding from motion.
std::vector<Result> StartingTorque(const daq::Record& record, std::span<const double> torque_Nm) {
  const std::string name(analysis::quantities::kStartingTorque.name);
  const std::vector<double> time_s = Numbers(record, "time_s");
  const std::vector<double> position_rad = Numbers(record, "position_rad");
  std::vector<double> speed(position_rad.size(), 0.0);
  std::size_t before = 0;
  for (std::size_t i = 0; i < position_rad.size(); ++i) {
    while (time_s[i] - time_s[before] > kSpeedTime_s) ++before;
    if (time_s[i] - time_s[before] < 0.5 * kSpeedTime_s) continue;
    speed[i] = (position_rad[i] - position_rad[before]) / (time_s[i] - time_s[before]);
  }
  // The swing may look like motion for a moment; the motion that stays begins after the last rest.
  std::size_t rest = speed.size();
  while (rest > 0 && std::abs(speed[rest - 1]) >= kMovingSpeed_rad_per_s) --rest;
  const std::size_t from = rest > kFewestRows ? rest - kFewestRows : 0;
  const auto starting = analysis::MeasureStartingTorque(
      torque_Nm.subspan(from), std::span<const double>(speed).subspan(from), kMovingSpeed_rad_per_s);
  if (!starting) return {{name, std::nan(""), 0.0, "the input did not break away"}};
  return {{name, starting->value, starting->standard_error, ""}};
}

// About the mean, so that a sensor's offset is no vibration.
double Rms(std::span<const float> samples) {
  double sum = 0.0;
  double square_sum = 0.0;
  for (const float sample : samples) {
    sum += static_cast<double>(sample);
    square_sum += static_cast<double>(sample) * static_cast<double>(sample);
  }
  const double count = static_cast<double>(samples.size());
  const double mean = sum / count;
  return std::sqrt(std::max(0.0, square_sum / count - mean * mean));
}

// A sensor that is dead or at the end of its range, for a part of the record at least; empty: none.
std::string StandingFlag(std::span<const float> samples) {
  constexpr std::size_t kLooked = 6;  // equal samples in a row that are worth a closer look
  const std::vector<double> values(samples.begin(), samples.end());
  const auto segments = analysis::samples::StandingSegments(values, kLooked);
  if (segments.empty()) return {};
  std::size_t standing = 0;
  for (const auto& segment : analysis::samples::FindFrozen(values)) standing += segment.count;
  for (const auto& end : analysis::samples::FindSaturated(values)) standing = std::max(standing, end.count);
  if (segments.front().count == samples.size()) standing = samples.size();
  if (standing == 0) return {};
  return fmt::format("{} of {} samples stand at one value: not connected, or at the end of its range",
                     standing, samples.size());
}

}  // namespace

std::vector<Result> RotationResults(const daq::Record& record, double ratio) {
  const std::vector<double> input_torque_Nm = Numbers(record, "torque_Nm");
  const std::vector<double> input_speed = Numbers(record, "velocity_rad_per_s");
  if (input_torque_Nm.size() < kFewestRows) return {};
  std::vector<double> output_torque_Nm = Numbers(record, "output_torque_Nm");
  if (output_torque_Nm.empty()) return StartingTorque(record, input_torque_Nm);
  std::vector<double> output_speed;
  for (const double speed : input_speed) output_speed.push_back(speed / ratio);
  // The transducer reads what drives the output on; the gear exerts the opposite on the load.
  for (double& torque : output_torque_Nm) torque = -torque;
  const auto efficiency =
      analysis::MeasureEfficiency({input_torque_Nm, input_speed, output_torque_Nm, output_speed});
  std::string flag;
  for (const std::string& check : efficiency.failed_checks) flag += (flag.empty() ? "" : "; ") + check;
  return {{std::string(analysis::quantities::kEfficiency.name), 100.0 * efficiency.efficiency.value,
           100.0 * efficiency.efficiency.standard_error, flag}};
}

std::vector<Result> VibrationResults(const daq::Record& record) {
  std::vector<Result> results;
  for (const daq::Column& column : record.columns) {
    const auto* samples = std::get_if<std::vector<float>>(&column.values);
    if (samples == nullptr || samples->empty()) continue;
    results.push_back(
        {std::string(analysis::kVibrationRms) + column.name, Rms(*samples), 0.0, StandingFlag(*samples)});
  }
  return results;
}

}  // namespace strainwave::bench
