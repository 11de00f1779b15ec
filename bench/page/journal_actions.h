// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "bench/campaign/folder.h"
#include "bench/page/actions.h"

/// Actions of the page that the journal keeps. Each opens the journal and may wait for another program that
/// writes: not for the server's thread.
namespace strainwave::bench {

/// Severity of the lines of the journal that say what a person asked for on the page.
inline constexpr std::string_view kActionSeverity = "action";

/// A note, or what is done about an alarm.
ActionAnswer ActInJournal(const CampaignFolder& folder, const AskedAction& asked, const Moment& now);

/// A line about an action on the run: what, by whom, why. @param snapshot  as it was when that was asked for.
/// @throws std::exception where the journal cannot be written.
void RecordAction(const CampaignFolder& folder, const AskedAction& asked, const CampaignSnapshot& snapshot,
                  const std::string& utc);

/// What speaks against going on with the campaign; nothing: it may be resumed.
std::optional<ActionAnswer> MayNotResume(const CampaignSnapshot& snapshot, const AskedAction& asked);

}  // namespace strainwave::bench
