// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/alarms/alarm_list.h"
#include "bench/alarms/alarm_rules.h"
#include "bench/campaign/pause.h"
#include "bench/page/page_state.h"

namespace strainwave::bench {

/// What one look at a campaign has shown of what notices are about.
struct NoticeView {
  std::string campaign;  // name of its folder
  std::string specimen;
  std::string folder;  // its path, for commands that a person types
  std::string run;     // tells one run from the next
  BenchView view{BenchView::kNotBegun};
  std::string sentence;               // what the bench does, or why it stands
  int process{};                      // that holds the campaign; 0: nobody does
  std::optional<double> quiet_s;      // since its last sign of life; nothing: none is known
  std::vector<AlarmInstance> alarms;  // open
  std::vector<AlarmRule> rules;       // the bench file's
};

/// @param held_s  since the process has taken the campaign, as far as that is known. It counts as a sign of
///   life, as the newest readings, the checkpoint and the beginning of the run do.
NoticeView NoticeViewOf(const CampaignSnapshot& snapshot, const std::string& folder, const Moment& now,
                        const std::optional<double>& held_s);

/// "2026-03-01T12:00:00.250Z" as a moment of this machine: as long before `now` as UTC says, or `now` where
/// UTC cannot tell or says later.
Moment MomentOf(const std::string& utc, const Moment& now);

}  // namespace strainwave::bench
