// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "schedules/reader/bounds.h"

namespace strainwave::schedules {

/// How far the values of a schedule may go, each by itself. What one must be beside another is in
/// validate_schedule.cc, and beside a bench in bench/configuration/check_schedule.cc.
std::span<const QuantityBound> ScheduleBounds();

}  // namespace strainwave::schedules
