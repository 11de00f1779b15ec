// SPDX-License-Identifier: Apache-2.0
#include "bench/page/actions.h"

#include <algorithm>
#include <array>
#include <optional>
#include <system_error>

#include <fmt/core.h>

namespace strainwave::bench {
namespace {

using nlohmann::json;

struct KnownAction {
  std::string_view name;
  EndRequest request;
  std::string_view words;  // what was asked of the process
};

constexpr std::array kActions{
    KnownAction{"stop_now", EndRequest::kQuickStop, "quick stop"},
    KnownAction{"finish_cycle", EndRequest::kFinishCycle, "stop at the end of the cycle"},
    KnownAction{"pause", EndRequest::kPause, "pause"},
};

struct ActionRequest {
  const KnownAction* action{};
  std::string run;
  std::string token;
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

ActionRequest Parse(std::string_view text) {
  const json request = json::parse(text, nullptr, false);
  if (!request.is_object()) throw Unfit{fmt::format("the request is no JSON object ({})", kExpected)};
  ActionRequest parsed{nullptr, Field(request, "run"), Field(request, "token")};
  const std::string name = Field(request, "action");
  const auto known = std::ranges::find(kActions, name, &KnownAction::name);
  if (known == kActions.end()) {
    throw Unfit{fmt::format("there is no action '{:.40}' (expected stop_now, finish_cycle or pause)", name)};
  }
  parsed.action = &*known;
  return parsed;
}

}  // namespace

ActionAnswer Act(std::string_view text, const CampaignSnapshot& snapshot, Tokens& tokens,
                 const AskProcess& ask, const std::string& now_utc) {
  const auto refuse = [&](int status, const char* why, const std::string& sentence) {
    return ActionAnswer{
        status,
        {{"error", sentence}, {"why", why}, {"run", snapshot.run}, {"token", tokens.Issue(snapshot.run)}}};
  };
  ActionRequest request;
  try {
    request = Parse(text);
  } catch (const Unfit& unfit) {
    return refuse(400, "request", unfit.sentence);
  }
  if (request.run != snapshot.run) {
    return refuse(
        409, "stale",
        "the page is stale: it shows an earlier run of this campaign; nothing was done, look at the "
        "page again before you act");
  }
  const Tokens::Use use = tokens.Look(request.token, request.run);
  if (use.answer == Tokens::Answer::kUsed) return refuse(409, "done", use.done);
  if (use.answer == Tokens::Answer::kUnknown) {
    return refuse(
        409, "token",
        "the token is not known, since the page's program was started again or the token is not for "
        "this run; nothing was done, ask again with the new one");
  }
  int process = 0;
  try {
    process = ask(request.action->request);
  } catch (const std::system_error& error) {
    return refuse(500, "process",
                  fmt::format("the program that runs the campaign cannot be asked: {}; use the bench's own "
                              "quick-stop key (expected: this page served by the user who runs the campaign)",
                              error.what()));
  }
  if (process <= 0) {
    return refuse(409, "not_running", "nobody runs this campaign: there is nobody to ask for a stop");
  }
  tokens.Spend(request.token, fmt::format("done already at {}: {}", now_utc, request.action->words));
  return {200,
          {{"done", request.action->name},
           {"sentence", fmt::format("asked process {} for: {}", process, request.action->words)},
           {"at_utc", now_utc},
           {"run", snapshot.run},
           {"token", tokens.Issue(snapshot.run)}}};
}

}  // namespace strainwave::bench
