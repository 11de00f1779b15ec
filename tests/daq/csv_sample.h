// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <bit>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include "daq/csv_record.h"
#include "daq/record_error.h"
#include "daq/record_rules.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq {

inline const std::string kLoop =
    "# kind: hysteresis\n"
    "# t1_Nm: 7\n"
    "time_s,torque_Nm,output_angle_deg\n"
    "0,1.5,0.01\n"
    "0.1,-2.5,0.02\n"
    "0.2,3,0.03\n";

inline std::string ErrorOf(const std::string& text) {
  return MessageOf<RecordError>([&] { ParseCsvRecord(text, "r.csv"); });
}

inline std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

}  // namespace strainwave::daq
