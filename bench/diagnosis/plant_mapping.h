// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "analysis/diagnosis/study.h"
#include "bench/configuration/bench_description.h"
#include "bench/diagnosis/study_kind.h"

namespace strainwave::bench {

/// What a diagnosed model is on the simulated bench: the terms that differ from its nominal plant, and, in
/// words, what of the model this bench has no place for (a linear axis, a cause of another make of machine).
struct PlantMapping {
  std::vector<TermDescription> terms;  // as in `terms:` of a plant file; each name once, `line` is 0
  std::vector<std::string> not_run;    // one sentence each
};

/// Numbers that the mapping needs beside the fitted ones, of the gear and the record.
struct MappingContext {
  double ratio{80.0};
  double t1_Nm{7.0};  // knees of the torque-twist curve, from the hysteresis record
  double t2_Nm{25.0};
  double duration_s{};             // of the record; 0 where it has no time
  double temperature_degC{22.0};   // mean of the record
  double input_speed_rad_per_s{};  // of a vibration record; 0: that of the plant's own amplitudes (2400 rpm)
};

/// Converts the parameters of `diagnose` (units of the field, amplitude · cos(order · angle − phase)) to
/// terms of the simulated plant (SI, amplitude · sin(order · angle + phase)). The signs of both agree:
/// transmission error is input / ratio − output.
///
/// The bench with these terms shows in a record of this kind what the model says and no more: what its own
/// plant has of the same sort beyond the model is switched off, and so is the spread between specimens, since
/// a record is of one of them. What records of other kinds would show stays as it is.
///  * transmission_error: angles count from the encoders' zeros, which a record that starts elsewhere does
///  not
///    know. What the bench's own drag makes between the directions is taken off the play.
///  * hysteresis: the fitted stiffness is that of the gear and of all in series, so nothing is in series
///  then.
///  * motion: the axis is the bench's input shaft; its position counts from the encoder's zero.
///  * vibration: one amplitude stands for all channels, the mean of them; phases are the bench's own.
///
/// @param kind     a campaign has no terms
/// @param nominal  the fitted nominal parameters; those that are missing keep the plant's own numbers.
/// @throws std::invalid_argument for a parameter of a known cause that is missing.
PlantMapping PlantTermsOf(StudyKind kind, std::span<const analysis::diagnosis::ParameterValue> nominal,
                          std::span<const analysis::diagnosis::Study::NamedCause> causes,
                          const MappingContext& context = {});

}  // namespace strainwave::bench
