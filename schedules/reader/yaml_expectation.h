// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "schedules/reader/quantity.h"
#include "schedules/reader/yaml_map.h"
#include "schedules/reader/yaml_node.h"

namespace strainwave::schedules {

/// " above zero"; empty for any value.
std::string_view BoundText(Bound bound);

/// "a time above zero in us, ms, s, min, h or d".
std::string Expectation(Dimension dimension, Bound bound);

/// `value`, if it is within the bound.
/// @throws std::invalid_argument naming the expectation, if not.
double Bounded(double value, Bound bound, const std::string& expectation);

/// "a list", "no value", …
std::string_view TypeText(YamlNode::Type type);

}  // namespace strainwave::schedules
