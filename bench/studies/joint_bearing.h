// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/studies/studies.h"

namespace strainwave::bench {

/// A robot's joint that goes to and fro over 270°, three accelerometers near its wrist at 1031 Hz, 4096
/// samples a record, after docs/sources.md#jaber: the ball bearing of the input shaft is sound, damaged on
/// its inner race, damaged on its outer race over 1 or 2 mm, or on both races. Every condition is mounted
/// anew several times (`units`, 4 by default), each mounting with its own friction, gear, structure, sensors
/// and place of the damage; its records differ in load, speed and start, and a quarter of them has a filter
/// before the converter that the others lack.
StudySummary MakeJointBearing(const StudySettings& settings);

}  // namespace strainwave::bench
