// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/bounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace strainwave::schedules {
namespace {

// Written in one unit and bounded in another, a value may be off by a rounding.
constexpr double kRounding = 1e-9;

// Far from what any bench has, and near enough that no sum, count or time in nanoseconds overflows.
QuantityBound WidestBound(std::optional<Dimension> dimension) {
  if (!dimension) return {{}, dimension, {}, "1e15", "no number of a bench is larger"};
  switch (*dimension) {
    case Dimension::kTime:
      return {{}, dimension, {}, "20000 d", "no test lasts longer"};
    case Dimension::kAngle:
      return {{}, dimension, {}, "10000 rev", "no measurement turns further"};
    case Dimension::kAngularSpeed:
      return {{}, dimension, {}, "100000 rpm", "no shaft of a bench turns faster"};
    case Dimension::kAngularAcceleration:
      return {{}, dimension, {}, "1000000 rad/s2", "no servo of a bench does more"};
    case Dimension::kTorque:
      return {{}, dimension, {}, "100 kNm", "no gear of this kind bears more"};
    case Dimension::kTorqueRate:
      return {{}, dimension, {}, "10000 Nm/s", "what rises faster passes a limit before it is seen"};
    case Dimension::kFrequency:
      return {{}, dimension, {}, "1000 kHz", "nothing on a bench is sampled faster"};
    case Dimension::kTemperature:
      return {{}, dimension, {}, "1000 degC", "no sensor of a bench shows more"};
    case Dimension::kTemperatureDifference:
      return {{}, dimension, {}, "100 K", "no two states of a gear are that far apart"};
    case Dimension::kAcceleration:
      return {{}, dimension, {}, "10000 g", "no accelerometer of a bench shows more"};
    case Dimension::kSensitivity:
      return {{}, dimension, {}, "100000 mV/g", "no accelerometer gives more"};
    case Dimension::kShare:
      return {{}, dimension, {}, "1000 %", "no share of a bench is larger"};
  }
  throw std::invalid_argument("dimension is not one of the enumeration");
}

double Parsed(std::string_view text, std::optional<Dimension> dimension) {
  return dimension ? ParseQuantity(text, *dimension) : ParseNumber(text);
}

std::string WithoutIndexes(std::string_view path) {
  std::string plain;
  bool inside = false;
  for (const char c : path) {
    inside = (inside || c == '[') && c != ']';
    if (!inside && c != ']') plain += c;
  }
  return plain;
}

bool EndsWithKeys(std::string_view path, std::string_view end) {
  return path.ends_with(end) && (path.size() == end.size() || path[path.size() - end.size() - 1] == '.');
}

}  // namespace

std::string BeyondBound(std::span<const QuantityBound> bounds, std::string_view path,
                        std::optional<Dimension> dimension, double value) {
  const std::string plain = WithoutIndexes(path);
  const auto own = std::ranges::find_if(bounds, [&](const QuantityBound& bound) {
    return bound.dimension == dimension && EndsWithKeys(plain, bound.path);
  });
  const QuantityBound bound = own != bounds.end() ? *own : WidestBound(dimension);
  const double most = Parsed(bound.most, dimension) * (1.0 + kRounding);
  if (value > most) {
    return fmt::format("is above {} (expected no more, since {})", bound.most, bound.reason);
  }
  if (value < -most) {
    return fmt::format("is below -{} (expected no less, since {})", bound.most, bound.reason);
  }
  if (!bound.least.empty() && value < Parsed(bound.least, dimension) * (1.0 - kRounding)) {
    return fmt::format("is below {} (expected no less, since {})", bound.least, bound.reason);
  }
  return {};
}

}  // namespace strainwave::schedules
