// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace strainwave::bench {

/// Tells a person what to do by hand and waits until it is done; false when nobody is there or they refuse.
using AskOperator = std::function<bool(const std::string& what)>;

}  // namespace strainwave::bench
