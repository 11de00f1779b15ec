// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/studies/studies.h"

namespace strainwave::bench {

/// Records of the joints of PUMA 560 arms, healthy, with a brake that drags, or with a worn reducer. Arms
/// come from two origins, test rigs and plants, which move and carry differently; each arm has friction, gain
/// and offset of its torque signal of its own, each record a temperature and a speed. Some arms are seen both
/// healthy and faulty: without them a fault and an arm could not be told apart.
///
/// Columns of labels.csv: class (healthy or faulty), origin (rig or plant), fault (none, brake or reducer),
/// joint (0, or the number of the faulty one), payload_kg, speed_share.
StudySummary MakeArmStudy(const StudySettings& settings);

}  // namespace strainwave::bench
