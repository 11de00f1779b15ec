// SPDX-License-Identifier: Apache-2.0
#include "bench/page/actions.h"

#include <cerrno>
#include <system_error>

#include <fmt/core.h>
#include <gtest/gtest.h>

namespace strainwave::bench::page_actions_test {
namespace {

constexpr const char* kNow = "2026-11-29T12:00:00.000Z";

class PageActions : public testing::Test {
 protected:
  PageActions() { snapshot_.run = "run 2"; }

  ActionAnswer Ask(const std::string& text, const std::string& now = kNow) {
    return Act(
        text, snapshot_, tokens_,
        [this](EndRequest request) {
          asked_.push_back(request);
          return process_;
        },
        now);
  }
  static std::string Request(const std::string& action, const std::string& run, const std::string& token) {
    return fmt::format(R"({{"action":"{}","run":"{}","token":"{}"}})", action, run, token);
  }

  CampaignSnapshot snapshot_;
  Tokens tokens_{"key"};
  int process_{42};
  std::vector<EndRequest> asked_;
};

TEST_F(PageActions, AskTheProcessOfTheRunOnce) {
  const std::string request = Request("stop_now", "run 2", tokens_.Issue("run 2"));
  const ActionAnswer first = Ask(request);
  EXPECT_EQ(first.status, 200);
  EXPECT_EQ(first.body["sentence"], "asked process 42 for: quick stop");
  EXPECT_EQ(first.body["at_utc"], kNow);

  const ActionAnswer second = Ask(request, "2026-11-29T12:00:01.000Z");
  EXPECT_EQ(second.status, 409);
  EXPECT_EQ(second.body["why"], "done");
  EXPECT_EQ(second.body["error"], "done already at 2026-11-29T12:00:00.000Z: quick stop");
  EXPECT_EQ(asked_, std::vector{EndRequest::kQuickStop});
}

TEST_F(PageActions, BringATokenForTheNext) {
  const std::string next = Ask(Request("pause", "run 2", tokens_.Issue("run 2"))).body["token"];
  EXPECT_EQ(Ask(Request("finish_cycle", "run 2", next)).status, 200);
  EXPECT_EQ(asked_, (std::vector{EndRequest::kPause, EndRequest::kFinishCycle}));
}

TEST_F(PageActions, OfAnEarlierRunDoNothing) {
  const ActionAnswer answer = Ask(Request("stop_now", "run 1", tokens_.Issue("run 1")));
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(answer.body["why"], "stale");
  EXPECT_EQ(answer.body["run"], "run 2");
  EXPECT_EQ(answer.body["error"],
            "the page is stale: it shows an earlier run of this campaign; nothing was done, look at the page "
            "again before you act");
  EXPECT_TRUE(asked_.empty());
}

TEST_F(PageActions, WithAForeignTokenDoNothing) {
  EXPECT_EQ(Ask(Request("stop_now", "run 2", tokens_.Issue("run 1"))).body["why"], "token");
  EXPECT_EQ(Ask(Request("stop_now", "run 2", "1.00")).body["why"], "token");
  EXPECT_TRUE(asked_.empty());
}

TEST_F(PageActions, KeepTheirTokenWhereNobodyRuns) {
  process_ = 0;
  const std::string request = Request("stop_now", "run 2", tokens_.Issue("run 2"));
  EXPECT_EQ(Ask(request).body["error"], "nobody runs this campaign: there is nobody to ask for a stop");
  process_ = 42;
  EXPECT_EQ(Ask(request).status, 200);
}

TEST_F(PageActions, SayWhyTheProcessCannotBeAsked) {
  const std::string request = Request("stop_now", "run 2", tokens_.Issue("run 2"));
  const ActionAnswer answer = Act(
      request, snapshot_, tokens_,
      [](EndRequest) -> int { throw std::system_error(EPERM, std::generic_category(), "process 42"); }, kNow);
  EXPECT_EQ(answer.status, 500);
  EXPECT_EQ(
      answer.body["error"],
      "the program that runs the campaign cannot be asked: process 42: Operation not permitted; use the "
      "bench's own quick-stop key (expected: this page served by the user who runs the campaign)");
}

TEST_F(PageActions, ThatMakeNoSenseAreAnsweredInWords) {
  const std::string token = tokens_.Issue("run 2");
  const std::string expected = R"( (expected {"action":"stop_now","run":"...","token":"..."}))";
  EXPECT_EQ(Ask("").body["error"], "the request is no JSON object" + expected);
  EXPECT_EQ(Ask("[1]").body["error"], "the request is no JSON object" + expected);
  EXPECT_EQ(Ask(R"({"action":"stop_now","token":"1"})").body["error"],
            "'run' is missing or no text" + expected);
  EXPECT_EQ(Ask(R"({"action":1,"run":"a","token":"1"})").body["error"],
            "'action' is missing or no text" + expected);
  const ActionAnswer answer = Ask(Request("raise_limit", "run 2", token));
  EXPECT_EQ(answer.status, 400);
  EXPECT_EQ(answer.body["error"],
            "there is no action 'raise_limit' (expected stop_now, finish_cycle or pause)");
  EXPECT_TRUE(asked_.empty());
}

}  // namespace
}  // namespace strainwave::bench::page_actions_test
