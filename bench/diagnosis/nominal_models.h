// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "analysis/diagnosis/study.h"
#include "bench/diagnosis/study_kind.h"
#include "daq/record.h"

/// What the simulation knows of each kind before it has seen data: numbers of a size-20 unit of ratio 80 from
/// its data sheet, and of an ordinary axis.
namespace strainwave::bench {

/// Parameters of the nominal model by the names of the kind's study. For a kind whose names depend on the
/// record (channels of a vibration) those that are the same for all.
std::vector<analysis::diagnosis::ParameterValue> NominalParameters(StudyKind kind);

/// Those of them that stand in a data sheet, so that a fit that moves far from them tells something: not
/// offsets and phases, which are any number, and nothing of an axis of any make.
std::vector<analysis::diagnosis::ParameterValue> DataSheetParameters(StudyKind kind);

/// Standard deviation of the white noise on a response, in the unit of the kind's study.
double NominalNoise(StudyKind kind);

/// Which optional columns an excitation has.
struct ExcitationColumns {
  bool temperature{};  // warms up as a run does
  bool torque{};       // of a transmission error sweep: load in both directions
};

/// A record of a kind as a measurement of it usually runs, with a plausible response in it:
/// transmission_error: a turn of the output each way in steps of 1 deg; hysteresis: two loops to 34 Nm at
/// 1 Nm/s with holds; motion: 20 s of several sines at 1 kHz; vibration: 2 s at 2400 rpm, three channels at
/// 12 kHz.
/// @throws std::invalid_argument for another kind.
daq::Record UsualExcitation(StudyKind kind, const ExcitationColumns& columns);

}  // namespace strainwave::bench
