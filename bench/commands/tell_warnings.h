// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bench/records/record_warnings.h"

namespace strainwave::bench {

/// Each on a line of standard error.
void TellWarnings(std::span<const RecordWarning> warnings);

}  // namespace strainwave::bench
