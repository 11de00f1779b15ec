// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/sessions.h"

#include <gtest/gtest.h>

namespace strainwave::bench::sessions_test {
namespace {

using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const User kMeier{"meier", UserRole::kOperator, "hash"};

class SessionsOfAPage : public testing::Test {
 protected:
  SessionsOfAPage() { sessions_.Open("secret", kMeier, now_); }

  bool Holds(std::string_view secret = "secret") const { return sessions_.Find(secret, now_).has_value(); }

  Sessions::Time now_{hours(1000)};
  Sessions sessions_{{.without_action = hours(1), .in_all = hours(12), .most = 3}};
};

TEST_F(SessionsOfAPage, AreFoundByTheirSecretAlone) {
  EXPECT_EQ(sessions_.Find("secret", now_)->name, "meier");
  EXPECT_FALSE(Holds("secreT"));
  EXPECT_FALSE(Holds(""));
}

TEST_F(SessionsOfAPage, EndWithoutAnAction) {
  now_ += hours(1) - seconds(1);
  EXPECT_TRUE(Holds());
  sessions_.Touch("secret", now_);
  now_ += hours(1) - seconds(1);
  EXPECT_TRUE(Holds());
  now_ += seconds(1);
  EXPECT_FALSE(Holds());
  sessions_.Touch("secret", now_);
  EXPECT_FALSE(Holds()) << "what is over does not come back";
}

TEST_F(SessionsOfAPage, EndAfterAWorkingDayWhateverIsDone) {
  for (int half = 0; half < 24; ++half) {
    EXPECT_TRUE(Holds()) << half;
    sessions_.Touch("secret", now_);
    now_ += minutes(30);
  }
  EXPECT_FALSE(Holds());
}

TEST_F(SessionsOfAPage, EndWhenTheirUserIsAnother) {
  sessions_.KeepOnly({kMeier});
  EXPECT_TRUE(Holds());
  for (const User& changed :
       {User{"meier", UserRole::kViewer, "hash"}, User{"meier", UserRole::kOperator, "new"},
        User{"schulz", UserRole::kOperator, "hash"}}) {
    sessions_.Open("secret", kMeier, now_);
    sessions_.KeepOnly({changed});
    EXPECT_FALSE(Holds());
  }
  sessions_.Open("secret", kMeier, now_);
  sessions_.KeepOnly({});
  EXPECT_FALSE(Holds());
}

TEST_F(SessionsOfAPage, ThatAreOverTakeNoRoom) {
  for (int half = 1; half < 24; ++half) sessions_.Touch("secret", now_ += minutes(30));
  sessions_.Open("second", kMeier, now_);
  sessions_.Open("third", kMeier, now_);
  now_ += minutes(29);
  sessions_.Touch("secret", now_);
  now_ += minutes(1);
  EXPECT_FALSE(Holds("secret")) << "after a working day";
  sessions_.Open("fourth", kMeier, now_);
  EXPECT_TRUE(Holds("second")) << "though it is idle for longer than the one that is over";
  EXPECT_TRUE(Holds("third"));
  EXPECT_TRUE(Holds("fourth"));
}

TEST_F(SessionsOfAPage, OfOneUserEndNobodyElses) {
  const User other{"schulz", UserRole::kViewer, "hash"};
  Sessions sessions({.without_action = hours(1), .in_all = hours(12), .most = 100, .most_of_one = 2});
  sessions.Open("meier", kMeier, now_);
  for (const char* secret : {"first", "second", "third"}) sessions.Open(secret, other, now_ += seconds(1));
  EXPECT_TRUE(sessions.Find("meier", now_)) << "though it is idle for the longest";
  EXPECT_FALSE(sessions.Find("first", now_));
  EXPECT_TRUE(sessions.Find("second", now_));
  EXPECT_TRUE(sessions.Find("third", now_));
}

TEST_F(SessionsOfAPage, MakeRoomForOneMore) {
  now_ += minutes(1);
  sessions_.Open("second", kMeier, now_);
  sessions_.Open("third", kMeier, now_);
  sessions_.Open("fourth", kMeier, now_);
  EXPECT_FALSE(Holds("secret"));
  EXPECT_TRUE(Holds("second"));
  EXPECT_TRUE(Holds("fourth"));
  sessions_.Close("fourth");
  EXPECT_FALSE(Holds("fourth"));
}

}  // namespace
}  // namespace strainwave::bench::sessions_test
