// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "daq/record.h"

/// Records with known content, and equality to the bit.
namespace strainwave::daq {

inline Record SampleLoop() {
  Record record;
  record.kind = RecordKind::kHysteresis;
  record.SetMetadata("t1_Nm", 7.0);
  record.SetMetadata("t2_Nm", "25.0");  // a number, but not in its shortest form
  record.SetMetadata("specimen", "Nr. 007 \"ä\"");
  record.columns.push_back({"time_s", std::vector{0.0, 0.1, 1.0 / 3.0}, "", ""});
  record.columns.push_back({"torque_Nm", std::vector{-0.0, 5e-324, -34.5}, "0815", "T-2024-11"});
  record.columns.push_back({"output_angle_deg", std::vector{0.0, 1e-17, 0.0625}, "", ""});
  return record;
}

inline Record SampleSweep() {
  Record record;
  record.kind = RecordKind::kTransmissionError;
  record.SetMetadata("ratio", -80.0);
  record.SetMetadata("absolute", "true");
  record.columns.push_back(
      {"direction", std::vector{Direction::kClockwise, Direction::kCounterClockwise}, "", ""});
  record.columns.push_back({"input_angle_deg", std::vector{0.0, 80.25}, "", ""});
  record.columns.push_back({"output_angle_deg", std::vector{0.0, -1.0}, "", ""});
  return record;
}

inline Record SampleVibration() {
  Record record;
  record.kind = RecordKind::kVibration;
  record.SetMetadata("sample_rate_hz", 25600.0);
  record.columns.push_back({"accel_x_m_per_s2", std::vector{0.1F, -9.81F, 1e-30F}, "A-1", ""});
  record.columns.push_back({"accel_motor_z_m_per_s2", std::vector{0.0F, 1.0F, 2.0F}, "", ""});
  return record;
}

inline bool SameBits(const Column::Values& a, const Column::Values& b) {
  if (a.index() != b.index()) return false;
  if (const auto* doubles = std::get_if<std::vector<double>>(&a)) {
    const auto& others = std::get<std::vector<double>>(b);
    if (doubles->size() != others.size()) return false;
    for (std::size_t i = 0; i < others.size(); ++i) {
      if (std::bit_cast<std::uint64_t>((*doubles)[i]) != std::bit_cast<std::uint64_t>(others[i]))
        return false;
    }
    return true;
  }
  return a == b;
}

inline bool SameRecord(const Record& a, const Record& b) {
  if (a.kind != b.kind || a.metadata != b.metadata || a.columns.size() != b.columns.size()) return false;
  for (std::size_t i = 0; i < a.columns.size(); ++i) {
    const Column& x = a.columns[i];
    const Column& y = b.columns[i];
    if (x.name != y.name || x.sensor_serial != y.sensor_serial || x.calibration != y.calibration ||
        !SameBits(x.values, y.values)) {
      return false;
    }
  }
  return true;
}

}  // namespace strainwave::daq
