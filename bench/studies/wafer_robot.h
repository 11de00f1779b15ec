// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/studies/studies.h"

namespace strainwave::bench {

/// Motor records of a wafer robot's axis with worn teeth of its harmonic drive (`hd`: 0, ½, 1) and of its
/// timing belt (`tb`: 0, ⅓, ⅔, 1), after docs/sources.md#lee-2023: four assemblies a condition, 25 cycles
/// each, one file a cycle, and the vertical vibration of five other cycles of each. Assemblies differ in
/// friction, stiffness, phase and size of what was cut, cycles in temperature and speed. The worst condition
/// fails: `failed_conditions.csv`.
StudySummary MakeWaferRobot(const StudySettings& settings);
/// The same with moves that take half as long again: another motion profile.
StudySummary MakeSlowWaferRobot(const StudySettings& settings);

}  // namespace strainwave::bench
