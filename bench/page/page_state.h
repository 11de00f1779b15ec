// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "bench/campaign/campaign_status.h"
#include "bench/page/picture.h"

namespace strainwave::bench {

/// What a campaign is doing, as far as its files tell.
enum class BenchView {
  kNotBegun,     // nobody has run it yet
  kRunning,      // a process runs it
  kStopped,      // ended on request or by a stop criterion: torque off, brakes on
  kComplete,     // all cycles are done
  kFaulted,      // ended by a fault: torque off, brakes on
  kInterrupted,  // the program was gone without a word: the drives have stopped by their own supervision
  kUnreadable,   // the folder cannot be read any more
};

/// "running"; as the page and programs see it.
std::string_view NameOf(BenchView view);

/// @param begun  whether it was ever run.
BenchView ViewOf(const CampaignProgress& progress, bool begun);

/// Whether the shafts are known to stand with torque off and brakes on; nothing: it is not known.
std::optional<bool> IsSafe(BenchView view);

/// All that the page says of a campaign at a moment.
struct CampaignSnapshot {
  std::string campaign;  // name of its folder
  std::string specimen;
  std::string run;  // tells one run from the next, by which actions know whether they are meant
  BenchView view{BenchView::kNotBegun};
  std::string trouble;  // why the folder cannot be read
  CampaignProgress progress;
  double credited_load_s{};  // of the whole campaign
  std::int64_t last_event{};
  bool has_camera{};
  std::optional<BenchPicture> picture;  // the newest
};

/// The id of a run: the campaign's, and when that run began. A process that has the campaign and has not
/// begun its run yet has an id of its own: what was meant for the run before must not reach it.
/// @param begun    nothing: it was never run
/// @param process  that has the campaign now, or 0
std::string RunId(std::uint64_t campaign, const std::optional<RunBegun>& begun, int process);

/// One sentence: what the bench does, or why it stands.
std::string Sentence(const CampaignSnapshot& snapshot);

/// What `GET /api/v1/state` answers, but for the token; times and ages at the moment `now`.
nlohmann::json StateJson(const CampaignSnapshot& snapshot, const Moment& now);

/// A line of the journal as the page gets it.
nlohmann::json EventJson(const Event& event);

}  // namespace strainwave::bench
