// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/calibration.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "daq/acquisition/teds.h"
#include "daq/record.h"

namespace strainwave::daq::acquisition {
namespace {

// From volts per 1e12 units to counts of 1e-6 of one; the zero and the coefficients likewise.
constexpr double kLeastSensitivity = 1e-15;
constexpr double kMostMagnitude = 1e15;
constexpr std::size_t kMostCoefficients = 12;  // no sensor's curve has more

void DemandMagnitude(const char* name, double value, double least) {
  if (std::abs(value) >= least && std::abs(value) <= kMostMagnitude) return;
  throw std::invalid_argument(fmt::format("{} = {} is not a number of a magnitude from {:g} to {:g}", name,
                                          value, least, kMostMagnitude));
}

double NumberOf(const std::string& name, const std::string& text) {
  const std::optional<double> number = NumberFromText(text);
  if (!number || !std::isfinite(*number)) {
    throw std::invalid_argument(fmt::format("{} = '{}' is not a finite number", name, text));
  }
  return *number;
}

std::string JoinedText(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : " ") + ShortestText(number);
  return text;
}

std::vector<double> NumbersOf(const std::string& name, const std::string& text) {
  std::vector<double> numbers;
  std::istringstream words(text);
  for (std::string word; words >> word;) numbers.push_back(NumberOf(name, word));
  return numbers;
}

}  // namespace

double Calibration::Apply(double raw) const noexcept {
  const double x = (raw - zero) / sensitivity;
  if (polynomial.empty()) return x;
  double y = 0;
  for (auto coefficient = polynomial.rbegin(); coefficient != polynomial.rend(); ++coefficient) {
    y = y * x + *coefficient;
  }
  return y;
}

std::chrono::year_month_day DateFrom(const std::string& text) {
  int year{};
  unsigned month{}, day{};
  int used{};
  if (text.size() == 10 && std::sscanf(text.c_str(), "%4d-%2u-%2u%n", &year, &month, &day, &used) == 3 &&
      used == 10) {
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                           std::chrono::day(day)};
    if (date.ok()) return date;
  }
  throw std::invalid_argument(fmt::format("'{}' is not a date such as 2026-11-22", text));
}

std::string TextOf(std::chrono::year_month_day date) {
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()));
}

Attributes AttributesOf(const Calibration& calibration) {
  Attributes attributes;
  if (calibration.id.empty()) return attributes;
  attributes.emplace_back("calibration", calibration.id);
  if (!calibration.sensor_serial.empty()) {
    attributes.emplace_back("calibrated_sensor", calibration.sensor_serial);
  }
  attributes.emplace_back("sensitivity", ShortestText(calibration.sensitivity));
  attributes.emplace_back("zero", ShortestText(calibration.zero));
  if (!calibration.polynomial.empty()) {
    attributes.emplace_back("polynomial", JoinedText(calibration.polynomial));
  }
  if (calibration.date) attributes.emplace_back("calibration_date", TextOf(*calibration.date));
  if (calibration.due) attributes.emplace_back("calibration_due", TextOf(*calibration.due));
  attributes.insert(attributes.end(), calibration.teds.begin(), calibration.teds.end());
  return attributes;
}

Calibration CalibrationFrom(std::span<const std::pair<std::string, std::string>> attributes) {
  Calibration calibration;
  for (const auto& [name, text] : attributes) {
    if (name == "calibration") calibration.id = text;
    if (name == "calibrated_sensor") calibration.sensor_serial = text;
    if (name == "sensitivity") calibration.sensitivity = NumberOf(name, text);
    if (name == "zero") calibration.zero = NumberOf(name, text);
    if (name == "polynomial") calibration.polynomial = NumbersOf(name, text);
    if (name == "calibration_date") calibration.date = DateFrom(text);
    if (name == "calibration_due") calibration.due = DateFrom(text);
    if (IsTedsField(name)) calibration.teds.emplace_back(name, text);
  }
  DemandPlausible(calibration);
  return calibration;
}

void DemandPlausible(const Calibration& calibration) {
  if (calibration.sensitivity == 0) throw std::invalid_argument("sensitivity = 0 scales nothing");
  DemandMagnitude("sensitivity", calibration.sensitivity, kLeastSensitivity);
  DemandMagnitude("zero", calibration.zero, 0.0);
  if (calibration.polynomial.size() > kMostCoefficients) {
    throw std::invalid_argument(fmt::format("polynomial has {} coefficients, more than {}",
                                            calibration.polynomial.size(), kMostCoefficients));
  }
  for (const double coefficient : calibration.polynomial) DemandMagnitude("polynomial", coefficient, 0.0);
}

CalibrationFinding JudgeCalibration(const Calibration& calibration, const std::string& channel,
                                    const std::string& sensor_serial, std::chrono::year_month_day today,
                                    ExpiredPolicy policy) {
  const auto bad = [policy](std::string reason) {
    return CalibrationFinding{
        policy == ExpiredPolicy::kBlocks ? CalibrationVerdict::kBlocks : CalibrationVerdict::kStamps,
        std::move(reason)};
  };
  if (calibration.id.empty()) return bad(fmt::format("channel {} has no calibration", channel));
  const std::string which = fmt::format("calibration {} of channel {}", calibration.id, channel);
  if (!sensor_serial.empty() && !calibration.sensor_serial.empty() &&
      sensor_serial != calibration.sensor_serial) {
    return bad(fmt::format("{} is of sensor {}, but sensor {} is mounted", which, calibration.sensor_serial,
                           sensor_serial));
  }
  if (calibration.date && std::chrono::sys_days(*calibration.date) > std::chrono::sys_days(today)) {
    return bad(
        fmt::format("{} was made on {}, after today, {}", which, TextOf(*calibration.date), TextOf(today)));
  }
  if (calibration.due && std::chrono::sys_days(*calibration.due) < std::chrono::sys_days(today)) {
    return bad(fmt::format("{} was due on {}, {} days ago", which, TextOf(*calibration.due),
                           (std::chrono::sys_days(today) - std::chrono::sys_days(*calibration.due)).count()));
  }
  return {};
}

}  // namespace strainwave::daq::acquisition
