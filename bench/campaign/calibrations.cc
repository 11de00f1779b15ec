// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/calibrations.h"

#include <algorithm>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

using daq::acquisition::CalibrationVerdict;
using daq::acquisition::ExpiredPolicy;

ChannelCalibration FromFile(std::string channel, const std::string& serial, const std::string& id,
                            const std::string& due, std::string unit) {
  ChannelCalibration of{std::move(channel), serial, std::move(unit), {}};
  of.calibration.id = id;
  of.calibration.sensor_serial = serial;
  if (!due.empty()) of.calibration.due = daq::acquisition::DateFrom(due);
  return of;
}

// Where the bench file says until when a channel's calibration holds, or else which it is.
const schedules::Origin* PlaceOf(const std::string& channel, const BenchDescription& bench) {
  std::string section = channel;
  if (channel == "output_torque") section = "torque_transducer";
  if (channel.ends_with("_angle")) section = channel.substr(0, channel.size() - 5) + "encoder";
  for (std::size_t i = 0; i < bench.accelerometers.size(); ++i) {
    if (bench.accelerometers[i].name == channel) section = fmt::format("accelerometers[{}]", i);
  }
  for (const char* key : {".calibration_due", ".calibration"}) {
    const auto found = bench.origins.find(section + key);
    if (found != bench.origins.end() && found->second.line > 0) return &found->second;
  }
  return nullptr;
}

}  // namespace

std::vector<ChannelCalibration> CalibrationsOf(const BenchDescription& bench) {
  const auto& torque = bench.transducer;
  std::vector<ChannelCalibration> all{
      FromFile("output_torque", torque.serial, torque.calibration, torque.calibration_due, "Nm")};
  for (const auto& [channel, encoder] :
       {std::pair{"input_angle", &bench.input_encoder}, std::pair{"output_angle", &bench.output_encoder}}) {
    all.push_back(FromFile(channel, encoder->serial, encoder->calibration, encoder->calibration_due, "deg"));
  }
  for (const AccelerometerDescription& sensor : bench.accelerometers) {
    all.push_back(FromFile(sensor.name, sensor.serial, sensor.calibration, sensor.calibration_due, "m/s^2"));
  }
  return all;
}

std::vector<CalibrationTrouble> CalibrationTroubles(std::span<const ChannelCalibration> of_bench,
                                                    std::span<const ChannelCalibration> of_devices,
                                                    std::chrono::year_month_day today) {
  std::vector<CalibrationTrouble> troubles;
  const auto judge = [&](const ChannelCalibration& of) {
    if (of.calibration.id.empty() || of.calibration.id == "none") return;
    // What is mounted says the device itself, where it does.
    const auto device = std::ranges::find(of_devices, of.channel, &ChannelCalibration::channel);
    const std::string& mounted = device == of_devices.end() || device->sensor_serial.empty()
                                     ? of.sensor_serial
                                     : device->sensor_serial;
    const auto finding = daq::acquisition::JudgeCalibration(of.calibration, of.channel, mounted, today,
                                                            ExpiredPolicy::kBlocks);
    if (finding.verdict == CalibrationVerdict::kGood ||
        std::ranges::find(troubles, of.channel, &CalibrationTrouble::channel) != troubles.end()) {
      return;
    }
    const std::string sensor = mounted.empty() ? "without a serial number" : mounted;
    troubles.push_back({of.channel, fmt::format("{} (sensor {})", finding.reason, sensor)});
  };
  std::ranges::for_each(of_bench, judge);
  std::ranges::for_each(of_devices, judge);
  return troubles;
}

void RefuseToStart(std::span<const CalibrationTrouble> troubles, const BenchDescription& bench) {
  if (troubles.empty()) return;
  std::string text;
  for (const CalibrationTrouble& trouble : troubles) {
    const schedules::Origin* const place = PlaceOf(trouble.channel, bench);
    const std::string at = place == nullptr
                               ? bench.file_name
                               : fmt::format("{}:{}:{}", bench.file_name, place->line, place->column);
    text += fmt::format(
        "{}{}: error: {} (expected a calibration that holds today: have the sensor calibrated and write the "
        "new certificate into the bench file, or start with --accept-expired, and every record says so)",
        text.empty() ? "" : "\n", at, trouble.words);
  }
  throw BenchError(ExitCode::kWrongInput, text);
}

std::chrono::year_month_day Today() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
}

}  // namespace strainwave::bench
