// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "daq/record.h"

namespace strainwave::bench {

/// A number that was measured with a vibration record: metadata of that name, or else the mean of a column.
std::optional<double> LabelOf(const daq::Record& record, const std::string& name);

/// The class of a record: metadata `class`, or else a column of that name with one number throughout.
std::optional<std::string> ClassOf(const daq::Record& record);

}  // namespace strainwave::bench
