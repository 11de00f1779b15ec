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

  std::string Token() { return TokenFor(snapshot_, actor_, tokens_); }
  std::string TokenOf(const std::string& run) {
    CampaignSnapshot other;
    other.run = run;
    return TokenFor(other, actor_, tokens_);
  }
  void LogIn(UserRole role) { actor_ = {.user = User{"meier", role, "hash"}, .session = "secret"}; }

  ActionAnswer Refused(const std::string& text) {
    const auto accepted = Accept(text, snapshot_, actor_, tokens_);
    const auto* answer = std::get_if<ActionAnswer>(&accepted);
    return answer == nullptr ? ActionAnswer{200, {}} : *answer;
  }
  AskedAction Accepted(const std::string& text) {
    const auto accepted = Accept(text, snapshot_, actor_, tokens_);
    const auto* asked = std::get_if<AskedAction>(&accepted);
    EXPECT_NE(asked, nullptr) << std::get<ActionAnswer>(accepted).body;
    return asked == nullptr ? AskedAction{} : *asked;
  }
  ActionAnswer End(const AskedAction& asked) {
    return EndRun(
        asked,
        [this](EndRequest request) {
          asked_.push_back(request);
          return process_;
        },
        kNow);
  }
  static std::string Request(const std::string& action, const std::string& run, const std::string& token,
                             const std::string& more = "") {
    return fmt::format(R"({{"action":"{}","run":"{}","token":"{}"{}}})", action, run, token, more);
  }

  CampaignSnapshot snapshot_;
  Actor actor_;
  Tokens tokens_{"key"};
  int process_{42};
  std::vector<EndRequest> asked_;
};

TEST_F(PageActions, LetEverybodyStop) {
  for (const auto& actor : {Actor{}, Actor{.user = {}, .session = {}, .knows_users = false},
                            Actor{User{"m", UserRole::kViewer, "h"}, "s"}}) {
    actor_ = actor;
    const ActionAnswer answer = End(Accepted(Request("stop_now", "run 2", Token())));
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body["sentence"], "asked process 42 for: quick stop");
    EXPECT_EQ(answer.body["at_utc"], kNow);
  }
  EXPECT_EQ(asked_, std::vector(3, EndRequest::kQuickStop));
}

TEST_F(PageActions, StopWhateverTheWordsAre) {
  EXPECT_EQ(Accepted(Request("stop_now", "run 2", Token(), R"(,"text":5)")).text, "");
  EXPECT_EQ(
      Accepted(Request("stop_now", "run 2", Token(), ",\"text\":\"" + std::string(3000, 'x') + "\"")).text,
      "");
  EXPECT_EQ(Accepted(Request("stop_now", "run 2", Token(), R"(,"text":"noise")")).text, "noise");
}

TEST_F(PageActions, OtherThanAStopNeedALogin) {
  for (const char* action : {"finish_cycle", "pause", "resume", "note"}) {
    const ActionAnswer answer = Refused(Request(action, "run 2", Token(), R"(,"text":"x")"));
    EXPECT_EQ(answer.status, 401) << action;
    EXPECT_EQ(answer.body["why"], "login") << action;
  }
  EXPECT_EQ(
      Refused(Request("pause", "run 2", Token())).body["error"],
      "'pause' needs a login: nobody is logged in, or the login is over (expected: log in again); quick stop "
      "needs none");
  actor_.knows_users = false;
  EXPECT_EQ(Refused(Request("pause", "run 2", Token())).body["error"],
            "'pause' needs a login, and this page has no users (expected: strainwave serve DIR --users FILE; "
            "strainwave users FILE add NAME makes one); quick stop needs none");
}

TEST_F(PageActions, AreForTheRoleThatTheyNeed) {
  LogIn(UserRole::kViewer);
  const ActionAnswer answer = Refused(Request("acknowledge", "run 2", Token(), R"(,"alarm":3)"));
  EXPECT_EQ(answer.status, 403);
  EXPECT_EQ(answer.body["error"],
            "'acknowledge an alarm' is for operators, and meier is a viewer (expected: somebody who may)");
  EXPECT_EQ(Accepted(Request("comment", "run 2", Token(), R"(,"alarm":3,"text":"seen")")).text, "seen");
  LogIn(UserRole::kOperator);
  const AskedAction asked =
      Accepted(Request("shelve", "run 2", Token(), R"(,"alarm":3,"for_s":600,"text":"why")"));
  EXPECT_EQ(asked.by, "meier");
  EXPECT_EQ(asked.alarm, 3);
  EXPECT_EQ(asked.shelf_length_s, 600.0);
  EXPECT_EQ(asked.text, "why");
}

TEST_F(PageActions, TakeNoTokenOfAnotherLogin) {
  const std::string before = Token();
  LogIn(UserRole::kOperator);
  EXPECT_EQ(Refused(Request("pause", "run 2", before)).body["why"], "token");
  const std::string own = Token();
  actor_.session = "another";
  EXPECT_EQ(Refused(Request("pause", "run 2", own)).body["why"], "token");
}

TEST_F(PageActions, AreTakenOnceAndBringATokenForTheNext) {
  const std::string request = Request("stop_now", "run 2", Token());
  tokens_.Spend(Accepted(request).token, "done already at noon: quick stop");
  const ActionAnswer again = Refused(request);
  EXPECT_EQ(again.status, 409);
  EXPECT_EQ(again.body["why"], "done");
  EXPECT_EQ(again.body["error"], "done already at noon: quick stop");
  Accepted(Request("stop_now", "run 2", again.body["token"]));
}

TEST_F(PageActions, OfAnEarlierRunDoNothing) {
  const ActionAnswer answer = Refused(Request("stop_now", "run 1", TokenOf("run 1")));
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(answer.body["why"], "stale");
  EXPECT_EQ(answer.body["run"], "run 2");
  EXPECT_EQ(answer.body["error"],
            "the page is stale: it shows an earlier run of this campaign; nothing was done, look at the page "
            "again before you act");
  EXPECT_TRUE(asked_.empty());
}

TEST_F(PageActions, WithAForeignTokenDoNothing) {
  EXPECT_EQ(Refused(Request("stop_now", "run 2", TokenOf("run 1"))).body["why"], "token");
  EXPECT_EQ(Refused(Request("stop_now", "run 2", "1.00")).body["why"], "token");
  EXPECT_TRUE(asked_.empty());
}

TEST_F(PageActions, SayThatNobodyRuns) {
  process_ = 0;
  const ActionAnswer answer = End(Accepted(Request("stop_now", "run 2", Token())));
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(answer.body["error"], "nobody runs this campaign: there is nobody to ask for a stop");
}

TEST_F(PageActions, SayWhyTheProcessCannotBeAsked) {
  const ActionAnswer answer = EndRun(
      Accepted(Request("stop_now", "run 2", Token())),
      [](EndRequest) -> int { throw std::system_error(EPERM, std::generic_category(), "process 42"); }, kNow);
  EXPECT_EQ(answer.status, 500);
  EXPECT_EQ(
      answer.body["error"],
      "the program that runs the campaign cannot be asked: process 42: Operation not permitted; use the "
      "bench's own quick-stop key (expected: this page served by the user who runs the campaign)");
}

TEST_F(PageActions, ThatMakeNoSenseAreAnsweredInWords) {
  const std::string token = Token();
  const std::string expected = R"( (expected {"action":"stop_now","run":"...","token":"..."}))";
  EXPECT_EQ(Refused("").body["error"], "the request is no JSON object" + expected);
  EXPECT_EQ(Refused("[1]").body["error"], "the request is no JSON object" + expected);
  EXPECT_EQ(Refused(R"({"action":"stop_now","token":"1"})").body["error"],
            "'run' is missing or no text" + expected);
  EXPECT_EQ(Refused(R"({"action":1,"run":"a","token":"1"})").body["error"],
            "'action' is missing or no text" + expected);
  const ActionAnswer answer = Refused(Request("raise_limit", "run 2", token));
  EXPECT_EQ(answer.status, 400);
  EXPECT_EQ(answer.body["error"],
            "there is no action 'raise_limit' (expected stop_now, finish_cycle, pause, resume, acknowledge, "
            "confirm, shelve, "
            "unshelve, comment or note)");
  LogIn(UserRole::kOperator);
  EXPECT_EQ(Refused(Request("acknowledge", "run 2", Token())).body["error"],
            "'alarm' is missing or no number (expected the number of an alarm)");
  EXPECT_EQ(Refused(Request("acknowledge", "run 2", Token(), R"(,"alarm":"3")")).body["error"],
            "'alarm' is missing or no number (expected the number of an alarm)");
  EXPECT_EQ(Refused(Request("acknowledge", "run 2", Token(), R"(,"alarm":0)")).body["error"],
            "'alarm' is 0 (expected the number of an alarm)");
  EXPECT_EQ(Refused(Request("acknowledge", "run 2", Token(), R"(,"alarm":-1e300)")).body["error"],
            "'alarm' is -1e+300 (expected the number of an alarm)");
  EXPECT_EQ(Refused(Request("confirm", "run 2", Token(), R"(,"alarm":1.5)")).body["error"],
            "'alarm' is 1.5 (expected the number of an alarm)");
  EXPECT_EQ(Refused(Request("shelve", "run 2", Token(), R"(,"alarm":1)")).body["error"],
            "'for_s' is missing or no number (expected for how long, in seconds)");
  EXPECT_EQ(Refused(Request("note", "run 2", Token())).body["error"],
            "text: error: there are no words (expected what is to be kept)");
  EXPECT_TRUE(asked_.empty());
}

}  // namespace
}  // namespace strainwave::bench::page_actions_test
