// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/operating_envelope.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "analysis/units.h"
#include "daq/value_bounds.h"

namespace strainwave::bench {
namespace {

using enum OperatingQuantity;

constexpr OperatingName kNames[] = {
    {"output_torque_Nm", kOutputTorque, 1.0}, {"torque_Nm", kOutputTorque, 1.0},
    {"input_speed_rpm", kInputSpeed, 1.0},    {"input_speed_rad_per_s", kInputSpeed, RpmFromRadPerS(1.0)},
    {"temperature_degC", kTemperature, 1.0},  {"gear_temperature_degC", kTemperature, 1.0},
};

// How far beyond its range a quantity may lie. On the simulated bench, trained at 40 Nm, 2400 rpm and 45 °C
// for lives of 80 cycles, each of these moves e_max by a third of its interval's half width.
constexpr double kTorqueShare = 0.05;    // of the greatest torque
constexpr double kLeastTorque_Nm = 0.5;  // around a gear without load: what a transducer's zero may be off
constexpr double kSpeedShare = 0.05;     // of the highest speed
constexpr double kTemperature_K = 5.0;

double ToleranceOf(OperatingQuantity quantity, double greatest) {
  switch (quantity) {
    case kOutputTorque:
      return std::max(kLeastTorque_Nm, kTorqueShare * greatest);
    case kInputSpeed:
      return kSpeedShare * greatest;
    case kTemperature:
      return kTemperature_K;
  }
  return 0.0;
}

// Torque and speed count without their sign: a gear that turns back and forth under load is loaded all the
// time.
double MeanOf(const OperatingName& name, std::span<const double> samples) {
  double sum = 0.0;
  for (const double sample : samples) sum += name.quantity == kTemperature ? sample : std::abs(sample);
  return name.factor * sum / static_cast<double>(samples.size());
}

std::string TextOf(const OperatingEnvelope::Range& range) {
  const std::string least = fmt::format("{:.4g}", range.least);
  const std::string greatest = fmt::format("{:.4g}", range.greatest);
  return least == greatest ? least : fmt::format("{} to {}", least, greatest);
}

}  // namespace

std::string_view NameOf(OperatingQuantity quantity) {
  return std::ranges::find(kNames, quantity, &OperatingName::quantity)->name;
}

std::span<const OperatingName> OperatingNames() { return kNames; }

OperatingPoint OperatingPointOf(std::span<const NamedSignal> signals) {
  OperatingPoint point;
  for (const OperatingName& name : kNames) {
    const auto signal = std::ranges::find(signals, name.name, &NamedSignal::name);
    if (signal == signals.end() || signal->samples.empty() || point[name.quantity]) continue;
    if (daq::FindImplausible(signal->samples, daq::BoundsOf(name.name))) continue;
    point[name.quantity] = MeanOf(name, signal->samples);
  }
  return point;
}

OperatingPoint Completed(const OperatingPoint& own, const OperatingPoint& given) {
  OperatingPoint point = own;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    if (!point[quantity]) point[quantity] = given[quantity];
  }
  return point;
}

std::vector<std::string> Contradictions(const OperatingPoint& own, const OperatingPoint& given) {
  std::vector<std::string> found;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    if (!own[quantity] || !given[quantity]) continue;
    const double off = std::abs(*own[quantity] - *given[quantity]);
    if (off <= ToleranceOf(quantity, std::max(*own[quantity], *given[quantity]))) continue;
    found.push_back(fmt::format("{} is {:.4g} and was given as {:.4g}; {:.4g} counts", NameOf(quantity),
                                *own[quantity], *given[quantity], *own[quantity]));
  }
  return found;
}

void OperatingEnvelope::Include(OperatingQuantity quantity, const std::optional<Range>& range) {
  Seen& seen = seen_[static_cast<std::size_t>(quantity)];
  if (!range) {
    seen.everywhere = false;
  } else if (!seen.range) {
    seen.range = range;
  } else {
    seen.range = {std::min(seen.range->least, range->least), std::max(seen.range->greatest, range->greatest)};
  }
}

void OperatingEnvelope::Include(const OperatingPoint& point) {
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const std::optional<double>& value = point[quantity];
    Include(quantity, value ? std::optional(Range{*value, *value}) : std::nullopt);
  }
}

void OperatingEnvelope::Include(const OperatingEnvelope& other) {
  for (const OperatingQuantity quantity : kOperatingQuantities) Include(quantity, other.RangeOf(quantity));
}

std::optional<OperatingEnvelope::Range> OperatingEnvelope::RangeOf(OperatingQuantity quantity) const {
  const Seen& seen = seen_[static_cast<std::size_t>(quantity)];
  return seen.everywhere ? seen.range : std::nullopt;
}

std::vector<std::string> OperatingEnvelope::Left(const OperatingPoint& point) const {
  std::vector<std::string> left;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const std::optional<Range> range = RangeOf(quantity);
    if (!range || !point[quantity]) continue;
    const double value = *point[quantity];
    const double tolerance = ToleranceOf(quantity, range->greatest);
    if (value >= range->least - tolerance && value <= range->greatest + tolerance) continue;
    left.push_back(fmt::format("{} is {:.4g} (trained at {})", NameOf(quantity), value, TextOf(*range)));
  }
  return left;
}

std::vector<std::string> OperatingEnvelope::NotKnown(const OperatingPoint& point) const {
  std::vector<std::string> unknown;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const std::optional<Range> range = RangeOf(quantity);
    if (!range || point[quantity]) continue;
    unknown.push_back(fmt::format("{} is not known (trained at {})", NameOf(quantity), TextOf(*range)));
  }
  if (const auto names = WithoutRange(); !names.empty())
    unknown.push_back(
        fmt::format("the training did not know {}: another one now is not noticed", fmt::join(names, ", ")));
  return unknown;
}

std::string OperatingEnvelope::Text() const {
  std::vector<std::string> parts;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const std::optional<Range> range = RangeOf(quantity);
    parts.push_back(fmt::format("{} {}", NameOf(quantity), range ? TextOf(*range) : "not known"));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<std::string> OperatingEnvelope::WithoutRange() const {
  std::vector<std::string> names;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    if (!RangeOf(quantity)) names.emplace_back(NameOf(quantity));
  }
  return names;
}

nlohmann::ordered_json OperatingEnvelope::Json() const {
  nlohmann::ordered_json json;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const std::optional<Range> range = RangeOf(quantity);
    json[std::string(NameOf(quantity))] =
        range ? nlohmann::ordered_json{range->least, range->greatest} : nlohmann::ordered_json();
  }
  return json;
}

OperatingEnvelope OperatingEnvelope::From(const nlohmann::ordered_json& json) {
  OperatingEnvelope envelope;
  for (const OperatingQuantity quantity : kOperatingQuantities) {
    const nlohmann::ordered_json& entry = json.at(std::string(NameOf(quantity)));
    std::optional<Range> range;
    if (!entry.is_null()) range = {entry.at(0).get<double>(), entry.at(1).get<double>()};
    if (range && !(range->least <= range->greatest)) {
      throw std::invalid_argument(fmt::format("{} has no range", NameOf(quantity)));
    }
    envelope.Include(quantity, range);
  }
  return envelope;
}

std::string OutsideText(double distance, const std::vector<std::string>& left) {
  std::vector<std::string> reasons = left;
  if (!(distance <= 1.0)) reasons.insert(reasons.begin(), fmt::format("{:.1f} times the limit", distance));
  return fmt::format("{}", fmt::join(reasons, "; "));
}

}  // namespace strainwave::bench
