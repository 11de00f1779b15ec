// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal_chain.h"
#include "bench/campaign/salvage_note.h"
#include "bench/integrity/write_ahead_log.h"
#include "daq/record_checks.h"

namespace strainwave::bench {

enum class FileState {
  kWhole,         // matches the digest or the checksums that it was written with
  kDamaged,       // does not
  kMissing,       // is registered, or belongs to a complete cycle, and is not there
  kUnregistered,  // can be read, and nothing says what it was: written since the last cycle or by somebody
                  // else
};
std::string_view Name(FileState state);

struct FileIntegrity {
  std::string path;  // from the campaign's folder on
  std::optional<int> cycle;
  FileState state{FileState::kWhole};
  std::uint64_t bytes{};
  std::string reason;  // of a file that is not whole, in words
  /// Of a damaged file of records; empty where not even their list can be read.
  std::vector<daq::RecordCheck> records;
};

/// `campaign.db`.
struct JournalIntegrity {
  FileState state{FileState::kWhole};
  std::string reason;
  std::uint32_t pages{};
  std::uint32_t damaged_pages{};
  LogReport log;
  bool has_chain{};  // journals of earlier versions have none
  ChainReport chain;
};

/// Of all: neither damage nor loss in files, journal and chain; some; neither rows nor files that can be
/// read.
enum class Verdict { kWhole, kDamaged, kNothing };
std::string_view Name(Verdict verdict);

struct CampaignIntegrity {
  JournalIntegrity journal;
  std::vector<FileIntegrity> files;     // by path; all but the journal's and those of a running program
  int cycles{};                         // complete, as far as the journal can be read
  std::uint64_t bytes{};                // that were read
  std::optional<SalvageNote> salvaged;  // what was lost when it was salvaged is not missing
  int process{};                        // that runs the campaign; 0: nobody does

  std::size_t Count(FileState state) const;
  Verdict verdict() const;
};

/// @param done, all  bytes.
using BytesRead = std::function<void(std::uint64_t done, std::uint64_t all)>;

/// Reads every byte of a campaign and holds it against what it was when it was written: pages of the journal
/// against their checksums, its tables by SQLite's own check, its rows against the chain; files against their
/// digests, and the records of a file that does not match one by one.
/// @throws BenchError (wrong input) for a folder that is no campaign, or one of a newer format.
CampaignIntegrity VerifyCampaign(const CampaignFolder& folder, const BytesRead& progress);

}  // namespace strainwave::bench
