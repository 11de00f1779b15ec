// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include <nlohmann/json.hpp>

#include "bench/accounts/users_file.h"
#include "bench/alarms/alarm_state.h"
#include "bench/campaign/end_request.h"
#include "bench/page/page_state.h"
#include "bench/page/tokens.h"

namespace strainwave::bench {

/// A status of HTTP and what goes with it.
struct ActionAnswer {
  int status{};
  nlohmann::json body;
};

/// Who asks: a person who is logged in, or nobody that is known.
struct Actor {
  std::optional<User> user;
  std::string session;     // its secret, to which tokens are bound; empty without one
  bool knows_users{true};  // whether the page has users at all
};

/// To who may not look without a login: error, why.
nlohmann::json MustLogIn();

/// name, role
nlohmann::json UserJson(const User& user);

struct ResumeRequest {};
struct NoteRequest {};

/// What can be asked for on the page.
struct PageAction {
  std::string_view name;
  std::string_view words;            // "quick stop"
  std::optional<UserRole> at_least;  // nothing: everybody, without a login
  std::variant<EndRequest, AlarmEvent, ResumeRequest, NoteRequest> what;
};

/// An action that may be carried out.
struct AskedAction {
  const PageAction* action{};
  std::string by;        // name; empty: nobody who is logged in
  std::string text;      // why; of a note or a comment: itself
  std::int64_t alarm{};  // number
  double shelf_length_s{};
  std::string token;  // spend it, then do it
};

/// Looks at the body of `POST /api/v1/actions`: {"action", "run", "token"}, and "text", "alarm", "for_s"
/// where the action has them. Refused is what nobody knows, what the person may not do, what is for a run
/// that is not the one of the snapshot, and a token that is not this person's or was used; the answer then
/// says so, and brings what a page needs to ask again (`run`, `token`).
std::variant<ActionAnswer, AskedAction> Accept(std::string_view request, const CampaignSnapshot& snapshot,
                                               const Actor& actor, Tokens& tokens);

/// A token for the next action of that person on the campaign as it is.
std::string TokenFor(const CampaignSnapshot& snapshot, const Actor& actor, Tokens& tokens);

/// The answer to what was done, without a token. @param now_utc  when.
ActionAnswer Done(const AskedAction& asked, std::string sentence, const std::string& now_utc);
/// The answer to what was not done: `why` in a word, and in a sentence.
ActionAnswer NotDone(int status, std::string_view why, std::string_view sentence);

/// Asks the process that runs the campaign; returns its id, 0 where there is none.
using AskProcess = std::function<int(EndRequest)>;
/// Of an end request alone.
ActionAnswer EndRun(const AskedAction& asked, const AskProcess& ask, const std::string& now_utc);

}  // namespace strainwave::bench
