// SPDX-License-Identifier: Apache-2.0
#include "bench/records/record_data.h"

#include <utility>

#include <fmt/format.h>

#include "analysis/units.h"
#include "bench/records/record_refusal.h"
#include "bench/records/vibration_channels.h"
#include "daq/record_rules.h"

namespace strainwave::bench {
namespace {

using daq::Record;

std::vector<double> Optional(const Record& record, std::string_view column) {
  return record.FindColumn(column) == nullptr ? std::vector<double>{} : record.CopyAsDoubles(column);
}

std::vector<double> Scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

std::vector<double> AngleColumn(const Record& record, std::string_view column) {
  return Scaled(record.CopyAsDoubles(column), RadFromDeg(1.0));
}

std::vector<double> VibrationTime(const Record& record) {
  if (record.FindColumn("time_s") != nullptr) return record.CopyAsDoubles("time_s");
  const double period_s = 1.0 / *daq::MetadataNumber(record, "sample_rate_hz");
  std::vector<double> time_s(record.rows());
  for (std::size_t i = 0; i < time_s.size(); ++i) time_s[i] = period_s * static_cast<double>(i);
  return time_s;
}

}  // namespace

analysis::diagnosis::TransmissionErrorData TransmissionErrorDataOf(const Record& record) {
  analysis::diagnosis::TransmissionErrorData data;
  data.input_angle_rad = AngleColumn(record, "input_angle_deg");
  data.output_angle_rad = AngleColumn(record, "output_angle_deg");
  for (const daq::Direction direction : record.Directions("direction")) {
    data.direction.push_back(static_cast<int>(direction));
  }
  data.time_s = Optional(record, "time_s");
  data.torque_Nm = Optional(record, "torque_Nm");
  data.temperature_degC = Optional(record, "temperature_degC");
  data.ratio = *daq::MetadataNumber(record, "ratio");
  data.absolute = record.Metadata("absolute") == "true";
  return data;
}

analysis::diagnosis::HysteresisData HysteresisDataOf(const Record& record) {
  analysis::diagnosis::HysteresisData data;
  data.time_s = record.CopyAsDoubles("time_s");
  data.torque_Nm = record.CopyAsDoubles("torque_Nm");
  data.output_angle_rad = AngleColumn(record, "output_angle_deg");
  data.temperature_degC = Optional(record, "temperature_degC");
  data.t1_Nm = *daq::MetadataNumber(record, "t1_Nm");
  data.t2_Nm = *daq::MetadataNumber(record, "t2_Nm");
  data.t3_Nm = *daq::MetadataNumber(record, "t3_Nm");
  return data;
}

analysis::diagnosis::MotionData MotionDataOf(const Record& record) {
  analysis::diagnosis::MotionData data;
  data.linear = daq::IsLinearAxis(record);
  const std::string drive = data.linear ? "force_N" : "torque_Nm";
  data.time_s = record.CopyAsDoubles("time_s");
  data.position = record.CopyAsDoubles(data.linear ? "position_m" : "position_rad");
  data.torque = record.FindColumn(drive) != nullptr
                    ? record.CopyAsDoubles(drive)
                    : Scaled(record.CopyAsDoubles("current_A"), *daq::CurrentGain(record));
  data.velocity = Optional(record, data.linear ? "velocity_m_per_s" : "velocity_rad_per_s");
  data.temperature_degC = Optional(record, "temperature_degC");
  data.inertia = daq::MetadataNumber(record, data.linear ? "mass_kg" : "inertia_kgm2");
  return data;
}

std::vector<double> InputSpeedsOf_rad_per_s(const Record& record) {
  if (record.FindColumn("input_speed_rad_per_s") != nullptr)
    return record.CopyAsDoubles("input_speed_rad_per_s");
  if (record.FindColumn("input_speed_rpm") != nullptr)
    return Scaled(record.CopyAsDoubles("input_speed_rpm"), RadPerSFromRpm(1.0));
  const std::optional<double> speed_rpm = daq::MetadataNumber(record, "input_speed_rpm");
  return speed_rpm ? std::vector{RadPerSFromRpm(*speed_rpm)} : std::vector<double>{};
}

std::vector<double> InputAnglesOf_rad(const Record& record) {
  if (record.FindColumn("input_angle_rad") != nullptr) return record.CopyAsDoubles("input_angle_rad");
  if (record.FindColumn("input_angle_deg") != nullptr) return AngleColumn(record, "input_angle_deg");
  return {};
}

std::vector<std::string> VibrationChannelsOf(const Record& record) {
  VibrationColumns columns = SortVibrationColumns(record);
  if (columns.channels.empty()) {
    throw RecordRefusal(
        record, fmt::format("no column is a channel of vibration{} (expected one such as accel_x_m_per_s2)",
                            columns.warnings.empty() ? "" : ": " + columns.warnings.front().second));
  }
  return std::move(columns.channels);
}

analysis::diagnosis::VibrationData VibrationDataOf(const Record& record) {
  analysis::diagnosis::VibrationData data;
  for (const std::string& name : VibrationChannelsOf(record)) {
    data.channels.push_back({name, record.CopyAsDoubles(name)});
  }
  data.time_s = VibrationTime(record);
  data.input_speed_rad_per_s = InputSpeedsOf_rad_per_s(record);
  data.input_angle_rad = InputAnglesOf_rad(record);
  data.ratio = daq::MetadataNumber(record, "ratio").value_or(data.ratio);
  return data;
}

}  // namespace strainwave::bench
