// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "bench/campaign/folder.h"
#include "bench/page/actions.h"
#include "bench/page/tokens.h"
#include "bench/serving/worker.h"

namespace strainwave::bench {

/// Carries out what is asked for on the page. A stop is asked for at once and written into the journal after;
/// what has to wait for the journal or for a process is done in a thread of its own.
class ActionDesk {
 public:
  using Finish = std::function<void(ActionAnswer)>;
  using Complain = std::function<void(const std::string& sentence)>;

  /// @param complain  takes what nobody waits for, from another thread.
  ActionDesk(const CampaignFolder& folder, Complain complain);

  /// For the next action of that person.
  std::string Token(const CampaignSnapshot& snapshot, const Actor& actor);
  /// @param body  of `POST /api/v1/actions`; @param finish  is called later, from another thread.
  /// @return what is said at once; nothing: `finish` will be called.
  std::optional<ActionAnswer> Take(std::string_view body, const CampaignSnapshot& snapshot,
                                   const Actor& actor, Finish finish);

 private:
  ActionAnswer End(const AskedAction& asked, const CampaignSnapshot& snapshot);
  void Record(const AskedAction& asked, const CampaignSnapshot& snapshot, const std::string& utc) const;
  ActionAnswer DoLong(const AskedAction& asked, const CampaignSnapshot& snapshot) const;

  static constexpr std::size_t kMostWaiting = 32;

  const CampaignFolder folder_;
  const Complain complain_;
  Tokens tokens_;
  Worker worker_{kMostWaiting, Worker::AtEnd::kFinish};  // its thread reads the first two, and ends before
};

}  // namespace strainwave::bench
