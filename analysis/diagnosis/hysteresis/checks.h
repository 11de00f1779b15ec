// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "analysis/diagnosis/records.h"

namespace strainwave::analysis::diagnosis {

/// Refuses a record that cannot be diagnosed.
/// @throws std::invalid_argument in words for a technician: too short, torque that never goes beyond T1 or
///   never reverses, constant or saturated signals.
void RequireDiagnosableLoop(const HysteresisData& record);

/// What looks odd about a record that can be diagnosed all the same: units mixed up, torque to one side only,
/// a peak that was not reached; sentences.
/// @param twist_range_rad   of the record.
/// @param peak_torque_Nm    largest size of its torque.
std::vector<std::string> OddThingsAbout(const HysteresisData& record, double twist_range_rad,
                                        double peak_torque_Nm);

/// What fitted stiffnesses say about bench and numbers: all moved alike from those of the reference unit
/// (gain of the torque signal), or all by one compliance (couplings in series). Empty where neither, or where
/// the knees are not those of the reference unit (7 and 25 Nm), whose stiffness alone is known.
std::string CommonStiffnessChange(std::span<const double> k_Nm_per_rad, double t1_Nm, double t2_Nm);

}  // namespace strainwave::analysis::diagnosis
