// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "daq/acquisition/trigger.h"
#include "daq/cycle_file.h"

namespace strainwave::daq::acquisition {

/// Writes what was around a trigger as a stream (`daq/FORMAT.md`), whole or not at all, with the attributes
/// `trigger_cause`, `trigger_sample` and `trigger_row` beside the caller's.
/// @throws DataFileError.
void WriteCapture(const std::filesystem::path& path, const SourceDescription& source, const Capture& capture,
                  Attributes attributes);

}  // namespace strainwave::daq::acquisition
