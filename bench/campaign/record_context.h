// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/campaign/record_results.h"
#include "daq/record.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What is known of the bench that a record was measured on.
struct RecordContext {
  BenchCorrections corrections;       // all zero for a record from elsewhere
  std::string campaign;               // the folder that they are from; empty without one
  std::vector<std::string> notes;     // what was taken: sentences
  std::vector<std::string> warnings;  // what would have been needed
};

/// The campaign that a file lies in.
struct CampaignBeside {
  std::string folder;
  bool has_stored_it{};  // the very file (SHA-256)
  BenchCorrections corrections;
  schedules::Specimen specimen;
};

/// Of `FOLDER/cycles/NNNNNN.h5` where FOLDER holds a campaign; else nothing.
/// @throws BenchError, DatabaseError as OpenCampaign.
std::optional<CampaignBeside> FindCampaignBeside(const std::filesystem::path& file);

/// What the campaign knows of one of the file's records: blank test, encoder's error, repeatability. Nothing
/// is taken for the blank test's own records, nor of a file that is not the one the campaign has stored.
RecordContext ContextOfRecord(const daq::Record& record, const std::optional<CampaignBeside>& campaign);

/// The record with the corrections taken off its output angle, for whoever does not take them apart.
daq::Record Corrected(daq::Record record, const BenchCorrections& corrections);

}  // namespace strainwave::bench
