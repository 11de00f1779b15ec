// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "schedules/reader/findings.h"
#include "schedules/reader/schedule.h"

namespace strainwave::schedules {

/// Checks a schedule against itself: T1 < T2 < T3, teeth and ratio, thresholds in order, names of phases,
/// torques and speeds within the limits, whole revolutions where a measurement needs them, stop criteria that
/// something measures. Errors make the schedule unusable; warnings are for a person to judge.
///
/// Values that the reader marked wrong are left out, so that one mistake is reported once.
FindingList ValidateSchedule(const Schedule& schedule);

}  // namespace strainwave::schedules
