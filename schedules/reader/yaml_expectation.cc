// SPDX-License-Identifier: Apache-2.0
#include "schedules/reader/yaml_expectation.h"

#include <fmt/format.h>

#include <stdexcept>

namespace strainwave::schedules {

std::string_view BoundText(Bound bound) {
  switch (bound) {
    case Bound::kAny:
      return "";
    case Bound::kNotZero:
      return " other than zero";
    case Bound::kNotNegative:
      return ", zero or more";
    case Bound::kPositive:
      return " above zero";
  }
  throw std::invalid_argument("bound is not one of the enumeration");
}

std::string Expectation(Dimension dimension, Bound bound) {
  return fmt::format("{}{} in {}", DimensionName(dimension), BoundText(bound), AcceptedUnits(dimension));
}

double Bounded(double value, Bound bound, const std::string& expectation) {
  const bool too_low = (bound == Bound::kPositive || bound == Bound::kNotNegative) && value < 0.0;
  if (too_low) throw std::invalid_argument(fmt::format("negative (expected {})", expectation));
  const bool is_zero = value == 0.0 && (bound == Bound::kPositive || bound == Bound::kNotZero);
  if (is_zero) throw std::invalid_argument(fmt::format("zero (expected {})", expectation));
  return value;
}

std::string_view TypeText(YamlNode::Type type) {
  switch (type) {
    case YamlNode::Type::kNull:
      return "no value";
    case YamlNode::Type::kScalar:
      return "a single value";
    case YamlNode::Type::kSequence:
      return "a list";
    case YamlNode::Type::kMap:
      return "a map";
  }
  throw std::invalid_argument("type is not one of the enumeration");
}

}  // namespace strainwave::schedules
