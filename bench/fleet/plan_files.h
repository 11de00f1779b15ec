// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/fleet/plan.h"

namespace strainwave::bench {

/// Size and SHA-256 of files; of those that many inputs share, such as a campaign's journal, once.
class SeenFiles {
 public:
  /// @throws RecordError where the file cannot be read.
  PlannedFile Look(const std::string& path);
  const PlannedFile& LookOnce(const std::string& path);

 private:
  std::map<std::string, PlannedFile> seen_;
};

/// The record files that paths stand for, in their order: of a campaign its cycles, of another folder its
/// records. @throws BenchError for a folder without either, or no record at all.
std::vector<std::string> RecordPathsOf(const std::vector<std::string>& paths);

/// What a result rests on beside the record: of a cycle of a campaign its journal and what it was started
/// with.
std::vector<std::string> PathsBeside(const std::string& record);

/// @throws BenchError for the first of the files that is not what it was.
void DemandUnchanged(const PlannedInput& input, SeenFiles& files);
void DemandUnchanged(const PlannedFile& file, const PlannedFile& now);

}  // namespace strainwave::bench
