// SPDX-License-Identifier: Apache-2.0
#include "bench/monitor/replay_records.h"

#include <utility>

#include <fmt/format.h>

#include "bench/errors/bench_error.h"
#include "bench/health/motor_records.h"
#include "bench/prediction/record_features.h"

namespace strainwave::bench {
namespace {

std::vector<daq::Record> ReadJointRecords(const RecordReader& reader, const std::filesystem::path& file) {
  std::vector<daq::Record> records = reader.Read(file);
  for (const daq::Record& record : records) {
    if (record.kind != daq::RecordKind::kJoints)
      Refuse(file, fmt::format("kind is {}", record.kind.name()), "joints");
  }
  return records;
}

}  // namespace

std::function<std::vector<daq::Record>(const std::filesystem::path& file)> ReplayedRecords(
    const SignalNeeds& needs, RecordReader reader) {
  if (needs.records == daq::RecordKind::kMotor)
    return [reader = std::move(reader)](const auto& file) { return ReadMotorCycles(reader, file); };
  if (needs.records == daq::RecordKind::kJoints)
    return [reader = std::move(reader)](const auto& file) { return ReadJointRecords(reader, file); };
  const MotorTorque torque = MotorTorqueAdded(HasMotorTorque(needs.signals.channels));
  return [reader = std::move(reader), torque](const auto& file) {
    return ReadVibrationRecords(file, torque, reader);
  };
}

}  // namespace strainwave::bench
