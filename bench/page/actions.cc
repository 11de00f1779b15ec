// SPDX-License-Identifier: Apache-2.0
#include "bench/page/actions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <system_error>

#include <fmt/core.h>

#include "bench/campaign/signed_words.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr auto kEverybody = std::optional<UserRole>();
constexpr auto kViewer = std::optional(UserRole::kViewer);
constexpr auto kOperator = std::optional(UserRole::kOperator);

constexpr std::array kActions{
    PageAction{"stop_now", "quick stop", kEverybody, EndRequest::kQuickStop},
    PageAction{"finish_cycle", "stop at the end of the cycle", kOperator, EndRequest::kFinishCycle},
    PageAction{"pause", "pause", kOperator, EndRequest::kPause},
    PageAction{"resume", "resume", kOperator, ResumeRequest{}},
    PageAction{"acknowledge", "acknowledge an alarm", kOperator, AlarmEvent::kAcknowledge},
    PageAction{"confirm", "confirm that the cause of an alarm is mended", kOperator, AlarmEvent::kConfirm},
    PageAction{"shelve", "shelve an alarm", kOperator, AlarmEvent::kShelve},
    PageAction{"unshelve", "take an alarm off its shelf", kOperator, AlarmEvent::kUnshelve},
    PageAction{"comment", "comment on an alarm", kViewer, AlarmEvent::kComment},
    PageAction{"note", "note", kViewer, NoteRequest{}},
};

struct Unfit {
  std::string sentence;
};

constexpr const char* kExpected = "expected {\"action\":\"stop_now\",\"run\":\"...\",\"token\":\"...\"}";

std::string Field(const json& request, const char* name) {
  const auto field = request.find(name);
  if (field == request.end() || !field->is_string()) {
    throw Unfit{fmt::format("'{}' is missing or no text ({})", name, kExpected)};
  }
  return field->get<std::string>();
}

double NumberField(const json& request, const char* name, const char* expected) {
  const auto field = request.find(name);
  if (field == request.end() || !field->is_number()) {
    throw Unfit{fmt::format("'{}' is missing or no number (expected {})", name, expected)};
  }
  return field->get<double>();
}

std::string NamesOfActions() {
  std::string names;
  for (const PageAction& action : kActions) {
    names += fmt::format("{}{}",
                         names.empty()                 ? ""
                         : &action == &kActions.back() ? " or "
                                                       : ", ",
                         action.name);
  }
  return names;
}

const PageAction& ActionNamed(const std::string& name) {
  const auto known = std::ranges::find(kActions, name, &PageAction::name);
  if (known == kActions.end()) {
    throw Unfit{fmt::format("there is no action '{:.40}' (expected {})", name, NamesOfActions())};
  }
  return *known;
}

struct Asked {
  AskedAction action;
  std::string run;
};

Asked Parse(std::string_view text) {
  const json request = json::parse(text, nullptr, false);
  if (!request.is_object()) throw Unfit{fmt::format("the request is no JSON object ({})", kExpected)};
  Asked asked;
  asked.run = Field(request, "run");
  asked.action.token = Field(request, "token");
  const PageAction& action = ActionNamed(Field(request, "action"));
  asked.action.action = &action;
  const auto* event = std::get_if<AlarmEvent>(&action.what);
  if (event != nullptr) {
    const double number = NumberField(request, "alarm", "the number of an alarm");
    if (!(number >= 1.0 && number <= 1e15 && number == std::floor(number))) {
      throw Unfit{fmt::format("'alarm' is {} (expected the number of an alarm)", number)};
    }
    asked.action.alarm = static_cast<std::int64_t>(number);
  }
  if (event != nullptr && *event == AlarmEvent::kShelve) {
    asked.action.shelf_length_s = NumberField(request, "for_s", "for how long, in seconds");
  }
  const bool is_its_text = std::holds_alternative<NoteRequest>(action.what) ||
                           (event != nullptr && *event == AlarmEvent::kComment);
  try {
    asked.action.text = WordsOf("text", request.contains("text") ? Field(request, "text") : "", !is_its_text);
  } catch (const BenchError& error) {
    if (action.at_least) throw Unfit{error.what()};  // no word keeps anybody from a quick stop
  } catch (const Unfit&) {
    if (action.at_least) throw;
  }
  return asked;
}

// What speaks against it; nothing: the person may.
std::optional<ActionAnswer> Forbidden(const PageAction& action, const Actor& actor) {
  if (!action.at_least) return std::nullopt;
  if (!actor.knows_users) {
    return NotDone(
        401, "login",
        fmt::format("'{}' needs a login, and this page has no users (expected: strainwave serve "
                    "DIR --users FILE; strainwave users FILE add NAME makes one); quick stop needs "
                    "none",
                    action.words));
  }
  if (!actor.user) {
    return NotDone(401, "login",
                   fmt::format("'{}' needs a login: nobody is logged in, or the login is over (expected: log "
                               "in again); quick stop needs none",
                               action.words));
  }
  if (*action.at_least == UserRole::kOperator && actor.user->role != UserRole::kOperator) {
    return NotDone(403, "role",
                   fmt::format("'{}' is for operators, and {} is a viewer (expected: somebody who may)",
                               action.words, actor.user->name));
  }
  return std::nullopt;
}

// The run, and who: a token is of use to nobody else.
std::string BoundTo(const CampaignSnapshot& snapshot, const Actor& actor) {
  return fmt::format("{} {}", snapshot.run, actor.session);
}

}  // namespace

nlohmann::json MustLogIn() {
  return NotDone(401, "login",
                 "from other machines the page is for who is logged in, and nobody is, or the login is over "
                 "(expected: log in)")
      .body;
}

nlohmann::json UserJson(const User& user) { return {{"name", user.name}, {"role", Name(user.role)}}; }

std::string TokenFor(const CampaignSnapshot& snapshot, const Actor& actor, Tokens& tokens) {
  return tokens.Issue(BoundTo(snapshot, actor));
}

ActionAnswer NotDone(int status, std::string_view why, std::string_view sentence) {
  return {status, {{"error", sentence}, {"why", why}}};
}

ActionAnswer Done(const AskedAction& asked, std::string sentence, const std::string& now_utc) {
  return {200, {{"done", asked.action->name}, {"sentence", std::move(sentence)}, {"at_utc", now_utc}}};
}

std::variant<ActionAnswer, AskedAction> Accept(std::string_view text, const CampaignSnapshot& snapshot,
                                               const Actor& actor, Tokens& tokens) {
  const auto refuse = [&](ActionAnswer answer) {
    answer.body["run"] = snapshot.run;
    answer.body["token"] = TokenFor(snapshot, actor, tokens);
    return answer;
  };
  Asked asked;
  try {
    asked = Parse(text);
  } catch (const Unfit& unfit) {
    return refuse(NotDone(400, "request", unfit.sentence));
  }
  if (auto forbidden = Forbidden(*asked.action.action, actor)) return refuse(std::move(*forbidden));
  if (asked.run != snapshot.run) {
    return refuse(
        NotDone(409, "stale",
                "the page is stale: it shows an earlier run of this campaign; nothing was done, look "
                "at the page again before you act"));
  }
  const Tokens::Use use = tokens.Look(asked.action.token, BoundTo(snapshot, actor));
  if (use.answer == Tokens::Answer::kUsed) return refuse(NotDone(409, "done", use.done));
  if (use.answer == Tokens::Answer::kUnknown) {
    return refuse(NotDone(
        409, "token",
        "the token is not known, since the page's program was started again or the token is for another run "
        "or another login; nothing was done, ask again with the new one"));
  }
  if (actor.user) asked.action.by = actor.user->name;
  return asked.action;
}

ActionAnswer EndRun(const AskedAction& asked, const AskProcess& ask, const std::string& now_utc) {
  int process = 0;
  try {
    process = ask(std::get<EndRequest>(asked.action->what));
  } catch (const std::system_error& error) {
    return NotDone(
        500, "process",
        fmt::format("the program that runs the campaign cannot be asked: {}; use the bench's own "
                    "quick-stop key (expected: this page served by the user who runs the campaign)",
                    error.what()));
  }
  if (process <= 0) {
    return NotDone(409, "not_running", "nobody runs this campaign: there is nobody to ask for a stop");
  }
  return Done(asked, fmt::format("asked process {} for: {}", process, asked.action->words), now_utc);
}

}  // namespace strainwave::bench
