// SPDX-License-Identifier: Apache-2.0
#include "bench/records/vibration_channels.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <span>
#include <string_view>
#include <variant>

#include <fmt/format.h>

#include "analysis/quantities.h"
#include "daq/record_rules.h"
#include "daq/value_bounds.h"

namespace strainwave::bench {
namespace {

constexpr std::string_view kReadElsewhere[] = {
    "time_s",          "output_torque_Nm",      "torque_Nm", "temperature_degC", "gear_temperature_degC",
    "input_speed_rpm", "input_speed_rad_per_s", "class"};

// Of sensors, beside those that have bounds (daq/value_bounds.h).
constexpr std::string_view kFurtherUnits[] = {"Pa", "kPa", "MPa", "bar", "mbar", "dB",   "mV",  "uV",
                                              "mA", "um",  "nm",  "K",   "C",    "degF", "pct", "percent",
                                              "kN", "mNm", "mg",  "gal", "T",    "mT",   "Ohm"};
constexpr std::string_view kUnitsOfTime[] = {"s", "ms", "us", "ns", "min", "h", "sec", "seconds"};

// A name all of whose words are of these says when or which, and not what a sensor felt.
constexpr std::string_view kWordsOfTimeAndLabels[] = {
    "time",     "times",   "timestamp", "stamp",  "date",      "datetime", "clock",   "epoch",   "unix",
    "utc",      "t",       "tick",      "ticks",  "day",       "hour",     "minute",  "second",  "seconds",
    "sec",      "elapsed", "s",         "ms",     "us",        "ns",       "zeit",    "uhrzeit", "datum",
    "index",    "idx",     "ix",        "sample", "samples",   "sampleno", "count",   "counter", "number",
    "no",       "nr",      "num",       "n",      "row",       "line",     "id",      "frame",   "seq",
    "sequence", "cycle",   "run",       "file",   "block",     "window",   "segment", "label",   "labels",
    "class",    "classes", "target",    "fault",  "condition", "severity", "state",   "health",  "rul",
    "specimen", "unit",    "of"};

template <typename Names>
bool Holds(const Names& names, std::string_view name) {
  return std::ranges::find(names, name) != std::end(names);
}

// What a predictor learns may stand beside the signals as a column.
bool IsPredicted(std::string_view name) {
  return std::ranges::find(analysis::kPredictedQuantities, name, &analysis::Quantity::name) !=
         analysis::kPredictedQuantities.end();
}

// In small letters: "SampleNo [1]" is sample, no, 1.
std::vector<std::string> WordsOf(std::string_view name) {
  std::vector<std::string> words;
  bool in_word = false;
  bool after_small = false;
  for (const char character : name) {
    const auto letter = static_cast<unsigned char>(character);
    const bool is_letter = std::isalpha(letter) != 0 || letter > 127;
    if (is_letter && (!in_word || (after_small && std::isupper(letter) != 0))) words.emplace_back();
    if (is_letter) words.back() += static_cast<char>(letter > 127 ? letter : std::tolower(letter));
    in_word = is_letter;
    after_small = is_letter && std::isupper(letter) == 0;
  }
  return words;
}

bool StandsForTimeOrLabel(std::string_view name) {
  const std::vector<std::string> words = WordsOf(name);
  return !words.empty() && std::ranges::all_of(words, [](const std::string& word) {
    return Holds(kWordsOfTimeAndLabels, word);
  });
}

bool HasUnit(std::string_view name) {
  return !daq::BoundsOf(name).unit.empty() || Holds(kFurtherUnits, daq::UnitOf(name)) ||
         daq::UnitOf(name).find('/') != std::string::npos;
}

// Shorter ones are not told from a signal.
constexpr std::size_t kLeastOfARamp = 16;
// Of the range: how far stamps that were rounded, or jitter, are off even ones.
constexpr double kOffLine = 0.01;
// Of all steps: those like the middle one, of a counter that begins anew now and then.
constexpr double kLikeSteps = 0.9;
// Of the middle step: what rounding leaves of equal ones.
constexpr double kStepRounding = 0.1;

bool RisesEvenly(std::span<const double> values) {
  const double first = values.front();
  const double slope = (values.back() - first) / static_cast<double>(values.size() - 1);
  const double most = kOffLine * std::abs(values.back() - first);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values[i] - first - slope * static_cast<double>(i)) <= most)) return false;
    if (i > 0 && (values[i] - values[i - 1]) * slope < 0.0) return false;
  }
  return slope != 0.0;
}

bool RisesByOneStep(std::span<const double> values) {
  std::vector<double> steps(values.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = values[i + 1] - values[i];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  const double step = *middle;
  if (step == 0.0) return false;
  const auto like = std::ranges::count_if(
      steps, [step](double one) { return std::abs(one - step) <= kStepRounding * std::abs(step); });
  return static_cast<double>(like) >= kLikeSteps * static_cast<double>(steps.size());
}

// Of strictly rising values of so many samples no sensor is known but a clock.
bool RisesAlways(std::span<const double> values) {
  const double sign = values.back() > values.front() ? 1.0 : -1.0;
  return std::ranges::adjacent_find(
             values, [sign](double one, double next) { return !(sign * next > sign * one); }) == values.end();
}

std::string WhyNoSignal(const std::vector<double>& values) {
  if (values.size() < kLeastOfARamp) return {};
  // A vibration turns back within its first samples; most columns are done here.
  constexpr std::size_t kGlance = 256;
  const auto glance = std::span(values).first(std::min(values.size(), kGlance));
  if (!RisesEvenly(values) && !RisesAlways(glance) && !RisesByOneStep(glance)) return {};
  if (RisesByOneStep(values)) return "goes on by one step a sample, as time or an index does";
  if (RisesEvenly(values) || RisesAlways(values)) return "never turns back, as time or an index does";
  return {};
}

bool IsOneValue(const std::vector<double>& values) {
  return std::ranges::all_of(values, [&](double value) { return value == values.front(); });
}

}  // namespace

VibrationColumns SortVibrationColumns(const daq::Record& record) {
  VibrationColumns sorted;
  std::vector<std::string> without_unit;
  for (const daq::Column& column : record.columns) {
    const std::string& name = column.name;
    if (std::holds_alternative<std::vector<daq::Direction>>(column.values) || daq::IsShaftAngle(name) ||
        Holds(kReadElsewhere, name) || IsPredicted(name)) {
      continue;
    }
    const bool has_unit = HasUnit(name) && !Holds(kUnitsOfTime, daq::UnitOf(name));
    if (!has_unit && (StandsForTimeOrLabel(name) || Holds(kUnitsOfTime, daq::UnitOf(name)))) {
      sorted.warnings.emplace_back(
          name, fmt::format(
                    "the column {} is left out: the name stands for time, an index or a label (expected the "
                    "name and unit of a signal, such as accel_x_m_per_s2)",
                    name));
      continue;
    }
    const std::string why = WhyNoSignal(record.CopyAsDoubles(name));
    if (!why.empty()) {
      sorted.warnings.emplace_back(
          name, fmt::format("the column {} is left out: it {} (expected a signal)", name, why));
    } else if (has_unit) {
      sorted.channels.push_back(name);
    } else {
      without_unit.push_back(name);
    }
  }
  const bool taken = sorted.channels.empty();
  for (const std::string& name : without_unit) {
    if (taken && !IsOneValue(record.CopyAsDoubles(name))) {
      sorted.channels.push_back(name);
      sorted.warnings.emplace_back(
          name,
          fmt::format(
              "the column {} is taken for a signal although no unit stands in its name (expected {}_UNIT)",
              name, name));
      continue;
    }
    sorted.warnings.emplace_back(
        name,
        fmt::format("the column {} is left out: no unit stands in its name (expected {}_UNIT)", name, name));
  }
  return sorted;
}

}  // namespace strainwave::bench
