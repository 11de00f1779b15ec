// SPDX-License-Identifier: Apache-2.0
#include "bench/page/action_desk.h"

#include <exception>
#include <utility>

#include <fmt/core.h>

#include "bench/page/journal_actions.h"
#include "bench/page/resumed_run.h"
#include "bench/utc.h"

namespace strainwave::bench {

ActionDesk::ActionDesk(const CampaignFolder& folder, Complain complain)
    : folder_(folder), complain_(std::move(complain)), tokens_(RandomKey()) {}

std::string ActionDesk::Token(const CampaignSnapshot& snapshot, const Actor& actor) {
  return TokenFor(snapshot, actor, tokens_);
}

void ActionDesk::Record(const AskedAction& asked, const CampaignSnapshot& snapshot,
                        const std::string& utc) const {
  try {
    RecordAction(folder_, asked, snapshot, utc);
  } catch (const std::exception& error) {
    complain_(fmt::format("'{}', asked for at {} on the page, is not in the journal: {}", asked.action->words,
                          utc, error.what()));
  }
}

// The process hears it before anything is written.
ActionAnswer ActionDesk::End(const AskedAction& asked, const CampaignSnapshot& snapshot) {
  const std::string utc = UtcNow();
  ActionAnswer answer = EndRun(
      asked, [this](EndRequest what) { return AskToEnd(folder_, what); }, utc);
  if (answer.status != 200) return answer;
  tokens_.Spend(asked.token, fmt::format("done already at {}: {}", utc, asked.action->words));
  if (!worker_.Post([this, asked, snapshot, utc] { Record(asked, snapshot, utc); })) {
    complain_(fmt::format("'{}', asked for at {} on the page, is not in the journal: too much waits for it",
                          asked.action->words, utc));
  }
  return answer;
}

ActionAnswer ActionDesk::DoLong(const AskedAction& asked, const CampaignSnapshot& snapshot) const {
  if (!std::holds_alternative<ResumeRequest>(asked.action->what)) return ActInJournal(folder_, asked, Now());
  const std::string utc = UtcNow();
  Record(asked, snapshot, utc);
  return ResumeRun(folder_, asked, utc);
}

std::optional<ActionAnswer> ActionDesk::Take(std::string_view body, const CampaignSnapshot& snapshot,
                                             const Actor& actor, Finish finish) {
  auto accepted = Accept(body, snapshot, actor, tokens_);
  if (auto* refused = std::get_if<ActionAnswer>(&accepted)) return std::move(*refused);
  const AskedAction asked = std::get<AskedAction>(std::move(accepted));
  const auto with_next = [&](ActionAnswer answer) {
    answer.body["run"] = snapshot.run;
    answer.body["token"] = Token(snapshot, actor);
    return answer;
  };
  if (std::holds_alternative<EndRequest>(asked.action->what)) return with_next(End(asked, snapshot));
  if (std::holds_alternative<ResumeRequest>(asked.action->what)) {
    if (auto not_now = MayNotResume(snapshot, asked)) return with_next(std::move(*not_now));
  }
  tokens_.Spend(asked.token, fmt::format("asked for already at {}: {}", UtcNow(), asked.action->words));
  const bool taken = worker_.Post([this, asked, snapshot, finish = std::move(finish), run = snapshot.run,
                                   token = Token(snapshot, actor)] {
    ActionAnswer answer = DoLong(asked, snapshot);
    answer.body["run"] = run;
    answer.body["token"] = token;
    finish(std::move(answer));
  });
  if (taken) return std::nullopt;
  return with_next(
      NotDone(503, "busy", "too much waits for the journal: nothing was done (expected: ask again)"));
}

}  // namespace strainwave::bench
