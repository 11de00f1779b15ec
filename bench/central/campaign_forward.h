// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bench/campaign/folder.h"
#include "bench/campaign/journal.h"
#include "bench/central/campaign_sender.h"
#include "bench/central/record_store.h"
#include "bench/central/server_source.h"

namespace strainwave::bench {

struct ForwardSettings {
  std::string machine;          // which one forwards (MachineId)
  std::filesystem::path store;  // of raw records; empty: none
  int cycles_per_batch{200};
  std::function<std::int64_t()> utc_ms;  // the clock of the bench
};

/// Tells this machine from others and gives nothing away of it: a hash of the file, /etc/machine-id.
/// @throws BenchError where there is none.
std::string MachineId(const std::filesystem::path& file);

/// What one look at a campaign has brought to the server.
struct Forwarded {
  std::string bench;
  int cycles{};                       // complete ones
  std::int64_t rows{};                // of all kinds, new at the server or changed there
  int records{};                      // files that the store has got
  double clock_off_s{};               // of the bench, against the server's; above zero: ahead
  std::vector<std::string> troubles;  // records that are not what the journal says
};

/// Brings one campaign's journal to the server. The journal is only read, and is what waits while the server
/// is away: whatever the server has not confirmed is read again from there.
class CampaignForward {
 public:
  CampaignForward(const CampaignFolder& folder, ForwardSettings settings);

  /// Everything that the server lacks, batch by batch, each in a transaction; and every five minutes a sign
  /// of life. Where there is nothing to say, the server is not asked for.
  /// @throws ServerError; as OpenCampaign.
  Forwarded Look(ServerSource& source);

  const CampaignFolder& folder() const { return folder_; }

 private:
  /// @return whether the connection is a new one: what the server lacks is to be found anew.
  bool Connect(ServerSource& source, const Journal& journal);
  /// Takes out what the server is known to have.
  void LeaveOutSent(JournalBatch& batch) const;
  void TakeAsSent(const JournalBatch& batch);
  void TellState(ServerSource& source, const SentState& state, const Journal& journal);
  void KeepRecords(ServerSource& source, const Journal& journal, Forwarded& done);

  CampaignFolder folder_;
  ForwardSettings settings_;
  std::optional<RecordStore> store_;
  CampaignSender sender_;
  int connection_{};  // 0: none yet
  JournalMarks marks_;
  std::map<std::string, std::string> changing_;  // rows that may change, as the server has them
  std::set<std::string> kept_records_;           // of which the server knows
  JournalFileMarks looked_at_;                   // files whose records are in the store, or told of
  std::set<std::string> done_;                   // the same of those beyond, until a look has come to its end
  std::optional<SentState> state_;
  std::int64_t state_sent_ms_{};
};

}  // namespace strainwave::bench
