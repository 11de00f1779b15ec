// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bench/faults/fault_model.h"
#include "bench/faults/train_faults.h"

namespace strainwave::bench {

/// What a training of faults came to, in words, on standard output.
void PrintFaultTraining(const FaultRecords& records, const FaultOutcome& outcome);

/// What a model says of a record.
void PrintFaultVerdict(const FaultModel& model, const FaultVerdict& verdict);

}  // namespace strainwave::bench
