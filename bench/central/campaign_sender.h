// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "bench/central/journal_rows.h"
#include "bench/central/server.h"

namespace strainwave::bench {

/// A clock further than this from the server's is wrong, and said to be in every row that has a stamp of it.
inline constexpr double kClockWrong_s = 86'400.0;

/// What tells a campaign from others, as its bench knows it.
struct SentCampaign {
  std::string identity;
  std::string schedule;
  std::string specimen;
  std::string started_utc;
};

/// What a bench does, for the page.
struct SentState {
  std::string state;  // "running"
  std::string phase;
  int cycle{};
  int cycles{};
  int complete{};
  int open_alarms{};
  ServerValue last_alarm;  // nothing: it has had none
  ServerValue last_alarm_utc;

  bool operator==(const SentState&) const = default;
};

/// Writes the rows of one campaign into the server's tables. What the server has already is left as it is.
class CampaignSender {
 public:
  /// On a new connection: says whose rows will come. @param utc_ms  of the bench's clock, now.
  /// @throws ServerError, also where the role is no bench's, or the bench another machine's.
  void Begin(Server& server, const std::string& machine, const SentCampaign& campaign, std::int64_t utc_ms);
  void KeepInput(Server& server, const std::string& bytes);
  /// How far the server is.
  JournalMarks Marks(Server& server) const;
  /// "PATH SHA256" of the files that a store has.
  std::set<std::string> Records(Server& server) const;

  /// A batch, in one transaction. @return how many rows are new at the server, or have changed there.
  std::int64_t Send(Server& server, const JournalBatch& batch);
  void SendState(Server& server, const SentState& state, std::int64_t utc_ms);
  void SendRecord(Server& server, const std::string& path, const std::string& sha256, std::uint64_t bytes);

  const std::string& bench() const { return bench_; }
  /// Of the bench's clock, against the server's; above zero: ahead.
  double clock_off_s() const { return clock_off_s_; }

 private:
  std::int64_t SendCycles(Server& server, const JournalBatch& batch);
  std::int64_t SendResults(Server& server, const JournalBatch& batch);
  std::int64_t SendAlarms(Server& server, const JournalBatch& batch);
  std::int64_t SendRows(Server& server, const JournalBatch& batch);
  void MeasureClock(Server& server, std::int64_t utc_ms);
  ServerValue ClockIsWrong() const;
  std::vector<ServerValue> PlaceAnd(std::initializer_list<ServerValue> more) const;

  std::string bench_;
  std::string bench_id_;
  std::string campaign_id_;
  std::string month_;
  std::string started_utc_;
  std::map<std::vector<std::string>, std::string> quantity_sets_;
  double clock_off_s_{};
};

}  // namespace strainwave::bench
