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
#include "bench/central/journal_rows.h"
#include "bench/central/record_store.h"
#include "bench/central/server.h"
#include "bench/page/page_state.h"

namespace strainwave::bench {

/// A clock further than this from the server's is wrong, and said to be in every row that has a stamp of it.
inline constexpr double kClockWrong_s = 86'400.0;

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
  int cycles{};            // complete ones
  std::int64_t rows{};     // of all kinds, new at the server or changed there
  int records{};           // files that the store has got
  double clock_off_s{};    // of the bench, against the server's; above zero: ahead
  std::vector<std::string> troubles;  // records that are not what the journal says
};

/// Brings one campaign's journal to the server. The journal is only read, and is what waits while the server is
/// away: whatever the server has not confirmed is read again from there.
class CampaignForward {
 public:
  CampaignForward(const CampaignFolder& folder, ForwardSettings settings);

  /// Everything that the server lacks, batch by batch, each in a transaction.
  /// @param is_new  the connection: what the server has is asked for first.
  /// @throws ServerError; as OpenCampaign.
  Forwarded Look(Server& server, bool is_new);

  const CampaignFolder& folder() const { return folder_; }

 private:
  struct Place {  // of the campaign's rows
    std::string bench;
    std::string bench_id;
    std::string campaign_id;
    std::string month;
  };

  void Begin(Server& server, const Journal& journal);
  /// Takes out what the server is known to have.
  void LeaveOutSent(JournalBatch& batch) const;
  void MeasureClock(Server& server);
  /// @return how many rows are new at the server, or have changed there.
  std::int64_t Send(Server& server, const JournalBatch& batch);
  std::int64_t SendCycles(Server& server, const JournalBatch& batch);
  std::int64_t SendResults(Server& server, const JournalBatch& batch);
  std::int64_t SendAlarms(Server& server, const JournalBatch& batch);
  std::int64_t SendRows(Server& server, const JournalBatch& batch);
  void SendState(Server& server, const CampaignSnapshot& snapshot, const Journal& journal);
  void Remember(const JournalBatch& batch);
  void KeepRecords(Server& server, const Journal& journal, Forwarded& done);
  bool IsClockWrong() const;
  std::vector<ServerValue> PlaceAnd(std::initializer_list<ServerValue> more) const;

  CampaignFolder folder_;
  ForwardSettings settings_;
  std::optional<RecordStore> store_;
  Place place_;
  JournalMarks marks_;
  std::map<std::string, std::string> changing_;  // rows that may change, as the server has them
  std::map<std::vector<std::string>, std::string> quantity_sets_;
  std::set<std::string> kept_records_;
  std::set<std::string> told_;  // of damaged records
  double clock_off_s_{};
  std::string state_;  // as sent last
  std::int64_t state_sent_ms_{};
};

}  // namespace strainwave::bench
