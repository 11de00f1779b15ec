// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/diagnosis/study.h"
#include "bench/diagnosis/study_kind.h"
#include "daq/record.h"

namespace strainwave::bench {

/// A model that can be run: the nominal one of a kind, or one that `diagnose` extended.
struct RunnableModel {
  StudyKind kind{};
  std::vector<analysis::diagnosis::ParameterValue> nominal;  // others are those of the usual excitation
  std::vector<analysis::diagnosis::Study::NamedCause> causes;
  double noise{};  // standard deviation in the unit of the response
};

/// @param name  of a kind, or the path of an `extended_model.yaml`.
/// @throws ModelFileError; BenchError for a name that is neither.
RunnableModel ReadRunnableModel(const std::string& name, bool with_nuisance_terms);

/// A record to run the model on where none is given: with the columns that its causes need.
daq::Record ExcitationFor(const RunnableModel& model);

/// What the model would have measured under the excitation of `like`: the same record with the response
/// replaced (the output angle; the torque of a motion; the channels of a vibration) and white noise on it.
/// Nothing else of the record changes. The same seed gives the same bits.
/// @throws std::invalid_argument where the model cannot be run on such a record, in words.
daq::Record SimulateRecord(const RunnableModel& model, const daq::Record& like, std::uint64_t seed,
                           bool noise);

}  // namespace strainwave::bench
