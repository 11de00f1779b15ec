// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"

namespace strainwave::bench {

struct KeptFile {
  std::string path;  // from the campaign's folder on, with slashes
  FileDigest digest;
};

/// What a cycle has left beside its records: its picture and raw streams. (The digest of the records is in
/// the cycle's own row.) Reads all of them: not in a transaction, which others who write would have to wait
/// for.
/// @throws std::system_error.
std::vector<KeptFile> FilesOfCycle(const CampaignFolder& folder, int cycle);

/// Registers in the journal what a run has left: pictures of cycles, streams, what is kept of faults, bus
/// logs and plots. A file whose size or, for a plot, content has changed is registered anew.
/// @throws std::system_error, DatabaseError.
void RegisterFiles(const CampaignFolder& folder, Journal& journal);

}  // namespace strainwave::bench
