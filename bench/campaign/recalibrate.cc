// SPDX-License-Identifier: Apache-2.0
// A later calibration, applied to what an earlier one has scaled.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/campaign/calibrations.h"
#include "bench/configuration/device_file.h"
#include "bench/errors/bench_error.h"
#include "daq/value_bounds.h"
#include "schedules/reader/yaml_map.h"

namespace strainwave::bench {
namespace {

using SensorCalibration = daq::acquisition::Calibration;
using schedules::Presence;
using schedules::ReadContext;
using schedules::YamlMap;
using schedules::YamlNode;

constexpr schedules::FileKind kCalibrationFile{"calibration", "calibrations: 1"};
constexpr int kMostIterations = 60;
constexpr double kAgreement = 1e-14;  // of x, relative

class CalibrationFileError : public schedules::FileError {
 public:
  using FileError::FileError;
};

double Polynomial(const std::vector<double>& coefficients, double x) {
  double y = 0.0;
  for (auto it = coefficients.rbegin(); it != coefficients.rend(); ++it) y = y * x + *it;
  return y;
}

double Slope(const std::vector<double>& coefficients, double x) {
  double slope = 0.0;
  for (std::size_t i = coefficients.size(); i-- > 1;) {
    slope = slope * x + static_cast<double>(i) * coefficients[i];
  }
  return slope;
}

// The raw value that `calibration` has made `value` of: Newton's method, as a calibration curve hardly bends.
double RawOf(const SensorCalibration& calibration, double value) {
  double x = value;
  if (!calibration.polynomial.empty()) {
    for (int i = 0;; ++i) {
      const double step = (Polynomial(calibration.polynomial, x) - value) / Slope(calibration.polynomial, x);
      x -= step;
      if (std::abs(step) <= kAgreement * std::max(1.0, std::abs(x))) break;
      if (i == kMostIterations || !std::isfinite(x)) {
        throw std::invalid_argument(
            fmt::format("the polynomial of calibration {} cannot be gone back through at {} (must rise or "
                        "fall throughout)",
                        calibration.id, value));
      }
    }
  }
  return calibration.zero + x * calibration.sensitivity;
}

// A column in the unit of a sensor; what a record derives from one in another unit is left alone.
bool IsCalibrated(const daq::Column& column) {
  const std::string unit = daq::UnitOf(column.name);
  return unit == "Nm" || unit == "deg" || unit == "m/s^2";
}

template <typename Number>
void Scale(std::vector<Number>& values, const daq::ValueBounds& bounds, const SensorCalibration& before,
           const SensorCalibration& after) {
  for (Number& value : values) {
    if (!std::isfinite(value)) continue;
    const double scaled = after.Apply(RawOf(before, static_cast<double>(value)));
    if (!bounds.Hold(scaled)) {
      throw std::invalid_argument(fmt::format("calibration {} makes {:g} of {:g} (expected {})", after.id,
                                              scaled, static_cast<double>(value), bounds.Text()));
    }
    value = static_cast<Number>(scaled);
  }
}

SensorCalibration ReadSensor(YamlMap& map) {
  SensorCalibration calibration;
  calibration.sensor_serial = map.Text("serial");
  calibration.id = map.Text("calibration");
  calibration.sensitivity = map.Number("sensitivity", schedules::Bound::kNotZero);
  calibration.zero = map.Number("zero", schedules::Bound::kAny, "0");
  for (const char* key : {"polynomial", "date", "due"}) {
    const std::string text = map.Text(key, "");
    if (text.empty() || map.is_wrong(key)) continue;
    try {
      const std::string name = key == std::string("polynomial") ? key : fmt::format("calibration_{}", key);
      const std::pair<std::string, std::string> attribute{name, text};
      const SensorCalibration read = daq::acquisition::CalibrationFrom({&attribute, 1});
      if (!read.polynomial.empty()) calibration.polynomial = read.polynomial;
      if (read.date) calibration.date = read.date;
      if (read.due) calibration.due = read.due;
    } catch (const std::invalid_argument& error) {
      map.AddError(key, fmt::format("{} (expected {})", error.what(),
                                    key == std::string("polynomial") ? "numbers with spaces between them"
                                                                     : "YYYY-MM-DD"));
    }
  }
  map.Finish();
  try {
    DemandPlausible(calibration);
  } catch (const std::invalid_argument& error) {
    if (!map.is_wrong("sensitivity")) map.AddError("sensitivity", error.what());
  }
  return calibration;
}

}  // namespace

std::vector<SensorCalibration> ReadCalibrations(const std::filesystem::path& file) {
  const auto read = [](const YamlNode& root, ReadContext& context) {
    YamlMap map(root, context);
    map.Version("calibrations");
    std::vector<SensorCalibration> calibrations;
    for (YamlMap& sensor : map.MapList("sensors", Presence::kRequired)) {
      calibrations.push_back(ReadSensor(sensor));
    }
    map.Finish();
    return calibrations;
  };
  try {
    return ParseFile<CalibrationFileError>(TextOfFile<CalibrationFileError>(file, kCalibrationFile),
                                           file.string(), kCalibrationFile, read);
  } catch (const CalibrationFileError& error) {
    throw BenchError(ExitCode::kWrongInput, error.what());
  }
}

std::size_t Recalibrate(std::span<NamedRecord> records, std::span<const SensorCalibration> calibrations) {
  std::size_t columns = 0;
  for (NamedRecord& named : records) {
    for (daq::Column& column : named.record.columns) {
      const auto after = std::ranges::find_if(calibrations, [&](const SensorCalibration& of) {
        return !column.sensor_serial.empty() && of.sensor_serial == column.sensor_serial;
      });
      if (after == calibrations.end() || !IsCalibrated(column)) continue;
      const SensorCalibration before = daq::acquisition::CalibrationFrom(column.calibration_terms);
      const daq::ValueBounds& bounds = daq::BoundsOf(column.name);
      if (auto* const wide = std::get_if<std::vector<double>>(&column.values))
        Scale(*wide, bounds, before, *after);
      if (auto* const narrow = std::get_if<std::vector<float>>(&column.values))
        Scale(*narrow, bounds, before, *after);
      column.calibration = after->id;
      column.calibration_terms = AttributesOf(*after);
      ++columns;
    }
  }
  return columns;
}

}  // namespace strainwave::bench
