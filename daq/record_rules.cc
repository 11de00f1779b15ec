// SPDX-License-Identifier: Apache-2.0
#include "daq/record_rules.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "daq/direction_words.h"
#include "daq/joint_columns.h"
#include "daq/kind_columns.h"
#include "daq/value_bounds.h"

namespace strainwave::daq {
namespace {

enum class Need { kFinite, kPositive, kNotZero };

struct NumberRule {
  RecordKind::Value kind;
  std::string_view key;
  Need need;
};

constexpr NumberRule kNumberRules[] = {
    {RecordKind::kTransmissionError, "ratio", Need::kNotZero},
    {RecordKind::kHysteresis, "t1_Nm", Need::kPositive},
    {RecordKind::kHysteresis, "t2_Nm", Need::kPositive},
    {RecordKind::kHysteresis, "t3_Nm", Need::kPositive},
    {RecordKind::kMotion, "inertia_kgm2", Need::kPositive},
    {RecordKind::kMotion, "mass_kg", Need::kPositive},
    {RecordKind::kVibration, "sample_rate_hz", Need::kPositive},
    {RecordKind::kVibration, "input_speed_rpm", Need::kFinite},
    {RecordKind::kVibration, "k1_Nm_per_rad", Need::kFinite},
    {RecordKind::kVibration, "k2_Nm_per_rad", Need::kFinite},
    {RecordKind::kVibration, "k3_Nm_per_rad", Need::kFinite},
    {RecordKind::kVibration, "e_avg_arcmin", Need::kFinite},
    {RecordKind::kVibration, "e_max_arcmin", Need::kFinite},
    {RecordKind::kVibration, "ratio", Need::kNotZero},
    {RecordKind::kMotor, "sample_rate_hz", Need::kPositive},
    {RecordKind::kHistory, "sample_rate_hz", Need::kPositive},
};

std::size_t CountPresent(const Record& record, Names names) {
  return static_cast<std::size_t>(std::count_if(
      names.begin(), names.end(), [&](std::string_view name) { return record.FindColumn(name) != nullptr; }));
}

// What the drive applies: the torque or force itself, or the current that has a gain in the metadata.
bool IsDriveColumn(std::string_view name) { return name == "torque_Nm" || name == "force_N"; }

bool HasCurrentFor(const Record& record, std::string_view name) {
  return IsDriveColumn(name) && record.FindColumn("current_A") != nullptr;
}

std::vector<std::string> CurrentGainKeys(const Record& record) {
  const std::string_view ending = record.FindColumn("position_rad") != nullptr ? "_Nm_per_A" : "_N_per_A";
  std::vector<std::string> keys;
  for (const auto& [key, value] : record.metadata) {
    if (key.ends_with(ending)) keys.push_back(key);
  }
  return keys;
}

// Collects what is found, so that the checks below read as rules.
class Report {
 public:
  explicit Report(std::vector<RuleBreak>& breaks) : breaks_(breaks) {}
  void Add(RecordPart part, std::string what, std::string expected) {
    breaks_.push_back({std::move(part), std::move(what), std::move(expected)});
  }
  bool Tells(std::string_view key) const {
    return std::ranges::any_of(breaks_, [key](const RuleBreak& found) { return found.part.name == key; });
  }

 private:
  std::vector<RuleBreak>& breaks_;
};

using Level = RecordPart::Level;

// What may not be zero is divided by: below this it would be as good as zero in any unit.
constexpr double kLeastMagnitude = 1e-15;

bool Satisfies(double value, Need need) {
  switch (need) {
    case Need::kFinite:
      return std::isfinite(value);
    case Need::kPositive:
      return std::isfinite(value) && value >= kLeastMagnitude;
    case Need::kNotZero:
      return std::isfinite(value) && std::abs(value) >= kLeastMagnitude;
  }
  return false;
}

// What `value` fails.
std::string Describe(double value, Need need) {
  if (value != 0.0 && std::abs(value) < kLeastMagnitude)
    return fmt::format("a number of {:g} or more{}", kLeastMagnitude,
                       need == Need::kNotZero ? " on either side of zero" : "");
  switch (need) {
    case Need::kFinite:
      return "a finite number";
    case Need::kPositive:
      return "a number above zero";
    case Need::kNotZero:
      return "a number other than zero";
  }
  return "";
}

// Of every key whose name ends in a unit, whatever the kind: any of them may be a label or a gain. What is no
// number at all is another rule's matter.
void CheckMetadataBounds(const Record& record, Report& report) {
  for (const auto& [key, text] : record.metadata) {
    const ValueBounds& bounds = BoundsOf(key);
    const std::optional<double> value = NumberFromText(text);
    const bool has_meaning = key == "ratio" || !bounds.unit.empty();
    if (!has_meaning || !value || !std::isfinite(*value) || bounds.Hold(*value) || report.Tells(key))
      continue;
    report.Add({Level::kMetadata, key}, fmt::format("{} is {}", key, text), bounds.Text());
  }
}

void CheckMetadata(const Record& record, Report& report) {
  bool numbers_good = true;
  for (const NumberRule& rule : kNumberRules) {
    if (rule.kind != record.kind) continue;
    const std::optional<std::string> text = record.Metadata(rule.key);
    if (!text) continue;
    const std::optional<double> value = NumberFromText(*text);
    if (value && Satisfies(*value, rule.need)) continue;
    numbers_good = false;
    report.Add({Level::kMetadata, std::string(rule.key)},
               value ? fmt::format("{} is {}", rule.key, *text) : fmt::format("{} is '{}'", rule.key, *text),
               value ? Describe(*value, rule.need) : "a number");
  }
  CheckMetadataBounds(record, report);
  if (record.kind == RecordKind::kMotion && record.FindColumn("current_A") != nullptr) {
    for (const std::string& key : CurrentGainKeys(record)) {
      const std::optional<double> gain = NumberFromText(*record.Metadata(key));
      if (gain && Satisfies(*gain, Need::kNotZero)) continue;
      report.Add({Level::kMetadata, key}, fmt::format("{} is '{}'", key, *record.Metadata(key)),
                 Describe(gain.value_or(0.0), Need::kNotZero));
    }
  }
  const std::optional<std::string> absolute = record.Metadata("absolute");
  if (absolute && *absolute != "true" && *absolute != "false") {
    report.Add({Level::kMetadata, "absolute"}, fmt::format("absolute is '{}'", *absolute), "true or false");
  }
  if (record.kind != RecordKind::kHysteresis || !numbers_good) return;
  constexpr std::pair<std::string_view, std::string_view> kAscending[] = {{"t1_Nm", "t2_Nm"},
                                                                          {"t2_Nm", "t3_Nm"}};
  for (const auto& [lower, upper] : kAscending) {
    const double lower_Nm = *MetadataNumber(record, lower);
    const double upper_Nm = *MetadataNumber(record, upper);
    if (lower_Nm < upper_Nm) continue;
    const std::string_view said = record.Metadata(lower) ? lower : upper;
    report.Add({Level::kMetadata, std::string(said)},
               fmt::format("{} = {} is not below {} = {}", lower, lower_Nm, upper, upper_Nm),
               "0 < t1_Nm < t2_Nm < t3_Nm");
  }
}

void CheckCurrentGain(const Record& record, std::string_view drive_column, Report& report) {
  const std::vector<std::string> keys = CurrentGainKeys(record);
  if (keys.size() == 1) return;
  report.Add({Level::kRecord},
             keys.empty() ? std::string("current_A has no gain")
                          : fmt::format("current_A has {} gains: {}", keys.size(), fmt::join(keys, ", ")),
             fmt::format("one metadata such as {}, or the column {}",
                         drive_column == "torque_Nm" ? "torque_constant_Nm_per_A" : "force_constant_N_per_A",
                         drive_column));
}

void CheckJoints(const Record& record, Report& report) {
  for (const JointColumnBreak& found : CheckJointColumns(record))
    report.Add({Level::kRecord}, found.what, found.expected);
}

void CheckRequiredColumns(const Record& record, const KindRule& rule, Report& report) {
  Names required = rule.required;
  std::string expected =
      fmt::format("the columns {} in a {} record", fmt::join(required, ", "), RecordKind(rule.kind).name());
  if (!rule.required_linear.empty()) {
    expected += fmt::format(", or {} for a linear axis", fmt::join(rule.required_linear, ", "));
    if (CountPresent(record, rule.required_linear) > CountPresent(record, rule.required)) {
      required = rule.required_linear;
    }
  }
  for (const std::string_view name : required) {
    if (record.FindColumn(name) != nullptr) continue;
    if (HasCurrentFor(record, name)) {
      CheckCurrentGain(record, name, report);
      continue;
    }
    report.Add({Level::kRecord}, fmt::format("column '{}' is missing", name), expected);
  }
  if (rule.kind == RecordKind::kJoints) CheckJoints(record, report);
  if (rule.kind != RecordKind::kVibration) return;
  const bool has_time = record.FindColumn("time_s") != nullptr;
  if (!has_time && !record.Metadata("sample_rate_hz")) {
    report.Add({Level::kRecord}, "neither column 'time_s' nor metadata 'sample_rate_hz' is there",
               "one of them in a vibration record");
  }
  if (record.columns.size() <= (has_time ? 1U : 0U)) {
    report.Add({Level::kRecord}, "no channel is there",
               "at least one column such as accel_x_m_per_s2 in a vibration record");
  }
}

void CheckLengths(const Record& record, Report& report) {
  if (record.columns.empty()) return;
  const Column& first = record.columns.front();
  if (first.size() == 0) {
    report.Add({Level::kRecord}, "the record has no rows", "at least one row of numbers");
  }
  for (const Column& column : record.columns) {
    if (column.size() == first.size()) continue;
    report.Add({Level::kColumn, column.name}, fmt::format("{} has {} rows", column.name, column.size()),
               fmt::format("{}, as '{}' has", first.size(), first.name));
  }
}

// What a cell without a value is.
enum class Missing { kIsWrong, kIsNaN };

template <typename Number>
void CheckNumbers(const std::string& name, std::span<const Number> values, Missing missing, Report& report) {
  const ValueBounds& bounds = BoundsOf(name);
  std::size_t found = 0;
  for (std::size_t row = 0; row < values.size() && found < kMostBreaksPerColumn; ++row) {
    const Number value = values[row];
    if (bounds.Hold(static_cast<double>(value)) || (missing == Missing::kIsNaN && std::isnan(value)))
      continue;
    ++found;
    report.Add({Level::kCell, name, row}, fmt::format("{} is {}", name, value),
               std::isfinite(value) ? bounds.Text() : "a finite number");
  }
}

void CheckNumbers(const Column& column, Missing missing, Report& report) {
  if (const auto* doubles = std::get_if<std::vector<double>>(&column.values)) {
    CheckNumbers<double>(column.name, *doubles, missing, report);
  } else if (const auto* floats = std::get_if<std::vector<float>>(&column.values)) {
    CheckNumbers<float>(column.name, *floats, missing, report);
  }
}

// Rates come from the mean step, periods from rates.
void CheckTimeStep(std::span<const double> time_s, Report& report) {
  constexpr double kLeastStep_s = 1e-9;  // of the fastest converters
  const double steps = static_cast<double>(time_s.size()) - 1.0;
  const double step_s = steps > 0.0 ? (time_s.back() - time_s.front()) / steps : 0.0;
  if (!(step_s > 0.0 && step_s < kLeastStep_s)) return;
  report.Add({Level::kCell, "time_s", time_s.size() - 1},
             fmt::format("time_s goes on by {:g} s a row", step_s),
             fmt::format("{:g} s or more", kLeastStep_s));
}

void CheckTime(std::span<const double> time_s, Report& report) {
  std::size_t found = 0;
  // NaN is another rule's matter, and does not hide a step back from the time before it.
  double latest_s = -std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < time_s.size() && found < kMostBreaksPerColumn; ++row) {
    if (std::isnan(time_s[row])) continue;
    if (time_s[row] < latest_s) {
      ++found;
      report.Add({Level::kCell, "time_s", row},
                 fmt::format("time_s runs backwards from {} to {}", latest_s, time_s[row]),
                 "time that never decreases");
    }
    latest_s = time_s[row];
  }
}

void CheckValues(const Record& record, Report& report) {
  for (const Column& column : record.columns) {
    const bool known = IsKnownColumn(record.kind, column.name);
    const bool is_direction = record.kind == RecordKind::kTransmissionError && column.name == "direction";
    if (is_direction != std::holds_alternative<std::vector<Direction>>(column.values) && known) {
      report.Add({Level::kColumn, column.name},
                 fmt::format("{} holds {}", column.name, is_direction ? "numbers" : "directions"),
                 is_direction ? std::string(kDirectionWords) : "numbers");
      continue;
    }
    if (!known && !TakesFurtherChannels(record.kind)) continue;
    CheckNumbers(column, Missing::kIsWrong, report);
    const auto* const time_s = std::get_if<std::vector<double>>(&column.values);
    if (column.name != "time_s" || time_s == nullptr) continue;
    CheckTime(*time_s, report);
    CheckTimeStep(*time_s, report);
  }
}

}  // namespace

std::vector<RuleBreak> CheckRecord(const Record& record) {
  std::vector<RuleBreak> breaks;
  Report report(breaks);
  const KindRule* rule = FindRule(record.kind);
  if (rule == nullptr) {
    report.Add(
        {Level::kKind},
        record.kind.name().empty() ? "kind is missing" : fmt::format("kind is '{}'", record.kind.name()),
        std::string(kKnownKinds));
    return breaks;
  }
  CheckMetadata(record, report);
  CheckRequiredColumns(record, *rule, report);
  CheckLengths(record, report);
  CheckValues(record, report);
  return breaks;
}

std::vector<RuleBreak> CheckBounds(const Record& record) {
  std::vector<RuleBreak> breaks;
  Report report(breaks);
  CheckMetadataBounds(record, report);
  for (const Column& column : record.columns) CheckNumbers(column, Missing::kIsNaN, report);
  return breaks;
}

bool IsKnownColumn(const RecordKind& kind, std::string_view column) {
  if (kind == RecordKind::kJoints && IsJointColumn(column)) return true;
  const KindRule* rule = FindRule(kind);
  return rule != nullptr && (Contains(rule->required, column) || Contains(rule->required_linear, column) ||
                             Contains(rule->optional, column));
}

bool TakesFurtherChannels(const RecordKind& kind) { return kind == RecordKind::kVibration; }

bool IsShaftAngle(std::string_view column) {
  constexpr std::string_view kAngles[] = {"input_angle_deg", "input_angle_rad", "output_angle_deg",
                                          "output_angle_rad"};
  return std::ranges::find(kAngles, column) != std::end(kAngles);
}

bool IsReadAsDoubles(const RecordKind& kind, std::string_view column) {
  return column == "time_s" || IsShaftAngle(column) ||
         (kind != RecordKind::kVibration && IsKnownColumn(kind, column));
}

bool IsLinearAxis(const Record& record) {
  const auto is_there = [&](std::string_view name) {
    return record.FindColumn(name) != nullptr || HasCurrentFor(record, name);
  };
  return record.kind == RecordKind::kMotion && !std::ranges::all_of(kRotaryRequired, is_there) &&
         std::ranges::all_of(kLinearRequired, is_there);
}

std::optional<double> CurrentGain(const Record& record) {
  const std::vector<std::string> keys = CurrentGainKeys(record);
  return keys.size() == 1 ? MetadataNumber(record, keys.front()) : std::nullopt;
}

std::optional<double> MetadataNumber(const Record& record, std::string_view key) {
  if (const std::optional<std::string> text = record.Metadata(key)) return NumberFromText(*text);
  if (key == "ratio") return 80.0;
  if (key == "t1_Nm") return 7.0;
  if (key == "t2_Nm") return 25.0;
  if (key == "t3_Nm") return 34.0;
  return std::nullopt;
}

}  // namespace strainwave::daq
