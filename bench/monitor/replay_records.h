// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "bench/prediction/exported_model.h"
#include "bench/records/record_reader.h"
#include "daq/record.h"

namespace strainwave::bench {

/// Reads what a model takes out of a file, each record a measurement of its own: records of vibration or of
/// joints as they are, those of motors cut into cycles as in training. The reader that is returned throws
/// RecordError, and BenchError for a file of another kind.
std::function<std::vector<daq::Record>(const std::filesystem::path& file)> ReplayedRecords(
    const SignalNeeds& needs, RecordReader reader);

}  // namespace strainwave::bench
