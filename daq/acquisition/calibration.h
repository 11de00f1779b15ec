// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "daq/cycle_file.h"

namespace strainwave::daq::acquisition {

/// How raw values of one channel become a quantity: y = P((raw - zero) / sensitivity), where P is a
/// polynomial. Files keep the raw values and the calibration beside them, so that a later one can take its
/// place.
struct Calibration {
  std::string id{};  // empty: there is none, raw values pass unchanged
  std::string sensor_serial{};
  double sensitivity{1};             // raw per unit of x
  double zero{};                     // raw value where there is nothing to measure
  std::vector<double> polynomial{};  // y = p[0] + p[1] x + p[2] x^2 ...; empty for y = x
  std::optional<std::chrono::year_month_day> date{};
  std::optional<std::chrono::year_month_day> due{};
  Attributes teds{};  // what the sensor's data sheet says, by the names of `teds.h`

  bool operator==(const Calibration&) const = default;

  double Apply(double raw) const noexcept;
};

/// Names and texts as they stand in a file: `calibration`, `calibrated_sensor`, `sensitivity`, `zero`,
/// `polynomial`, `calibration_date`, `calibration_due`, and each field of the data sheet under its own name.
/// What there is nothing to say about is left out.
Attributes AttributesOf(const Calibration& calibration);

/// The same back; names that belong to no calibration are passed over.
/// @throws std::invalid_argument naming the attribute, its text and the rule.
Calibration CalibrationFrom(std::span<const std::pair<std::string, std::string>> attributes);

/// Sensitivity, zero and polynomial of a size that sensors have, so that values stay numbers.
/// @throws std::invalid_argument naming the term, its value and the rule.
void DemandPlausible(const Calibration& calibration);

/// "2026-11-22" as a date of the calendar. @throws std::invalid_argument for any other text.
std::chrono::year_month_day DateFrom(const std::string& text);
std::string TextOf(std::chrono::year_month_day date);

/// What an expired or missing calibration does to a measurement.
enum class ExpiredPolicy { kBlocks, kStamps };
enum class CalibrationVerdict { kGood, kStamps, kBlocks };

struct CalibrationFinding {
  CalibrationVerdict verdict{CalibrationVerdict::kGood};
  std::string reason;  // in words; empty where the verdict is good
};

/// Judges a channel's calibration on a day: expired, missing, of another sensor (`sensor_serial`, where both
/// are known), or not yet made. It is good on the due day itself.
CalibrationFinding JudgeCalibration(const Calibration& calibration, const std::string& channel,
                                    const std::string& sensor_serial, std::chrono::year_month_day today,
                                    ExpiredPolicy policy);

}  // namespace strainwave::daq::acquisition
