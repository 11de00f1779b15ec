// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace strainwave::bench {

/// What a parameter of a model is, for a technician: "stiffness up to T1". Empty for a name that is not
/// known.
std::string_view ParameterWords(std::string_view name);

/// True for a number that comes in long lists, one a line, channel or node of a curve, and that is read by
/// programs rather than by people.
bool IsDetail(std::string_view name);

}  // namespace strainwave::bench
