// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "daq/record.h"

namespace strainwave::bench {

/// What a user should know of a measured record: what a reader left out, took by default or corrected.
struct RecordWarning {
  std::string file;  // empty where it is about several
  int line{};        // of a CSV; 0 where there is none
  std::string text;
};

/// Its notes and what is odd about its metadata, with the group of an HDF5 file.
std::vector<RecordWarning> WarningsOf(const daq::Record& record);

/// `FILE:LINE: warning: WHAT`, `FILE: warning: WHAT` or `warning: WHAT`, as standard error shows it.
std::string WarningLine(const RecordWarning& warning);

enum class NamedFiles { kNo, kYes };
/// As JSON lists them under `warnings`: `WHAT`, or `FILE: WHAT` where they are about several files.
std::vector<std::string> WarningTexts(std::span<const RecordWarning> warnings,
                                      NamedFiles files = NamedFiles::kNo);

}  // namespace strainwave::bench
