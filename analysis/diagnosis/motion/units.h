// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// Compares the velocity column with the position's own: a factor that is a unit's is put right and told
/// (revolutions per minute, degrees, millimetres), a column that does not follow the position is dropped and
/// told. A position that can only be degrees is converted.
void SettleUnits(MotionData& record, const std::string& name, std::vector<std::string>& warnings);

/// What an inertia that came out `factor` times the known one may mean; empty where it agrees.
std::string InertiaWarning(double fitted, double known, double standard_error, bool linear);

}  // namespace strainwave::analysis::diagnosis
