// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/record_features.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "analysis/units.h"
#include "bench/prediction/record_operating_point.h"
#include "bench/records/look_at_samples.h"
#include "bench/records/record_data.h"
#include "bench/records/record_refusal.h"
#include "bench/records/vibration_channels.h"

namespace strainwave::bench {
namespace {

constexpr double kSteady = 0.01;

double SampleRate(const daq::Record& record, std::span<const double> time_s) {
  if (time_s.size() < 2 || !(time_s.back() > time_s.front())) {
    throw RecordRefusal(record,
                        "no time passes (expected samples of rising time_s, or metadata sample_rate_hz)");
  }
  const double steps = static_cast<double>(time_s.size() - 1);
  const double step_s = (time_s.back() - time_s.front()) / steps;
  // Half a step off its place: a sample is missing, or the clock wandered.
  constexpr double kOffPlace = 0.5;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    const double off = (time_s[i] - time_s.front()) / step_s - static_cast<double>(i);
    if (std::abs(off) > kOffPlace) {
      throw RecordRefusal(
          record, fmt::format("time_s is off its place by {:.3g} steps at {:g} s (expected even samples)",
                              off, time_s[i]));
    }
  }
  return 1.0 / step_s;
}

double InputSpeed(const daq::Record& record, std::span<const double> speed_rad_per_s) {
  if (speed_rad_per_s.empty()) {
    throw RecordRefusal(
        record,
        "there is no speed of the input shaft (expected metadata or column input_speed_rpm, or column "
        "input_speed_rad_per_s)");
  }
  const auto [low, high] = std::ranges::minmax(speed_rad_per_s);
  const double middle = 0.5 * std::abs(low + high);
  if (middle == 0.0)
    throw RecordRefusal(record, "the input shaft stands still (expected a speed other than zero)");
  if (high - low > kSteady * middle) {
    throw RecordRefusal(
        record, fmt::format("the input shaft turns at {:.4g} to {:.4g} rad/s (expected one speed, to a "
                            "hundredth, for energies by order)",
                            low, high));
  }
  return middle;
}

}  // namespace

void AddMotorTorque(daq::Record& vibration, const daq::Record& rotation) {
  if (vibration.FindColumn(kMotorTorqueChannel) != nullptr || rotation.FindColumn("torque_Nm") == nullptr)
    return;
  const std::vector<double> time_s = rotation.CopyAsDoubles("time_s");
  const std::vector<double> torque_Nm = rotation.CopyAsDoubles("torque_Nm");
  const double rate_hz = SampleRateOf_hz(vibration);
  std::vector<double> values(vibration.rows());
  std::size_t k = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double now_s = static_cast<double>(i) / rate_hz;
    while (k + 2 < time_s.size() && time_s[k + 1] < now_s) ++k;
    const double share = std::clamp((now_s - time_s[k]) / (time_s[k + 1] - time_s[k]), 0.0, 1.0);
    values[i] = torque_Nm[k] + share * (torque_Nm[k + 1] - torque_Nm[k]);
  }
  vibration.columns.push_back({kMotorTorqueChannel, std::move(values), "", ""});
}

bool HasMotorTorque(const std::vector<std::string>& channels) {
  return std::ranges::find(channels, kMotorTorqueChannel) != channels.end();
}

std::vector<daq::Record> ReadVibrationRecords(const std::filesystem::path& path, MotorTorque motor_torque,
                                              const RecordReader& reader) {
  std::vector<daq::Record> records = reader.Read(path);
  const auto rotation = std::ranges::find_if(records, [](const daq::Record& record) {
    return record.kind == daq::RecordKind::kMotion && record.FindColumn("output_torque_Nm") != nullptr &&
           record.rows() > 1;
  });
  for (daq::Record& record : records) {
    if (record.kind != daq::RecordKind::kVibration || rotation == records.end()) continue;
    AddOperatingPoint(record, *rotation);
    if (motor_torque == MotorTorque::kAdded) AddMotorTorque(record, *rotation);
  }
  for (daq::Record& record : records) {
    if (record.kind == daq::RecordKind::kVibration) LookAtSamples(record);
  }
  std::vector<std::string> kinds;
  for (const daq::Record& record : records) {
    const std::string kind(record.kind.name());
    if (std::ranges::find(kinds, kind) == kinds.end()) kinds.push_back(kind);
  }
  std::erase_if(records,
                [](const daq::Record& record) { return record.kind != daq::RecordKind::kVibration; });
  if (records.empty()) {
    throw BenchError(ExitCode::kWrongInput, fmt::format("{}: error: kind is {} (expected vibration)",
                                                        path.string(), fmt::join(kinds, ", ")));
  }
  return records;
}

std::optional<double> SteadyInputSpeedOf_rad_per_s(const daq::Record& record) {
  const std::vector<double> speed_rad_per_s = InputSpeedsOf_rad_per_s(record);
  if (speed_rad_per_s.empty()) return std::nullopt;
  const auto [low, high] = std::ranges::minmax(speed_rad_per_s);
  const double middle = 0.5 * std::abs(low + high);
  if (middle == 0.0 || high - low > kSteady * middle) return std::nullopt;
  return middle;
}

std::vector<double> ChannelOf(const daq::Record& record, const std::string& channel) {
  const std::vector<std::string> channels = VibrationChannelsOf(record);
  if (channel.empty() && channels.size() == 1) return record.CopyAsDoubles(channels.front());
  if (std::ranges::find(channels, channel) == channels.end()) {
    throw RecordRefusal(
        record,
        channel.empty()
            ? fmt::format("there are {} channels and none is named (expected --channel with one "
                          "of {})",
                          channels.size(), fmt::join(channels, ", "))
            : fmt::format("there is no channel '{}' (expected {})", channel, fmt::join(channels, ", ")));
  }
  return record.CopyAsDoubles(channel);
}

double SampleRateOf_hz(const daq::Record& record) {
  if (const auto text = record.Metadata("sample_rate_hz")) {
    const auto rate_hz = daq::NumberFromText(*text);
    if (rate_hz && *rate_hz > 0.0) return *rate_hz;
  }
  const bool has_time = record.FindColumn("time_s") != nullptr;
  return SampleRate(record, has_time ? record.CopyAsDoubles("time_s") : std::vector<double>{});
}

RecordFeatures FeaturesOfRecord(const daq::Record& record, ChannelFeatures& features) {
  const std::vector<std::string> channels = VibrationChannelsOf(record);
  const std::size_t per_channel = features.CountPerChannel();
  RecordFeatures result{features.Names(channels), std::vector<double>(channels.size() * per_channel)};
  std::optional<double> samples_per_turn;
  if (IsByOrder(features.settings().set)) {
    const analysis::diagnosis::VibrationData data = VibrationDataOf(record);
    samples_per_turn =
        SampleRate(record, data.time_s) * kTwoPi / InputSpeed(record, data.input_speed_rad_per_s);
  }
  std::span<double> left = result.values;
  for (const std::string& channel : channels) {
    try {
      features.Compute(record.CopyAsDoubles(channel), samples_per_turn, left.first(per_channel));
    } catch (const std::invalid_argument& error) {
      throw RecordRefusal(record, fmt::format("{}: {}", channel, error.what()));
    }
    left = left.subspan(per_channel);
  }
  return result;
}

}  // namespace strainwave::bench
