// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/login_throttle.h"

#include <string>

#include <gtest/gtest.h>

namespace strainwave::bench::login_throttle_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

class LoginThrottles : public testing::Test {
 protected:
  LoginThrottle throttle_;
  LoginThrottle::Time now_{std::chrono::hours(1)};
};

TEST_F(LoginThrottles, DoubleTheWaitWithEachWrongPassword) {
  EXPECT_EQ(throttle_.Wait("meier", now_), milliseconds(0));
  for (const int expected_s : {1, 2, 4, 8, 16, 32, 60, 60}) {
    throttle_.Failed("meier", now_);
    EXPECT_EQ(throttle_.Wait("meier", now_), seconds(expected_s));
    EXPECT_EQ(throttle_.Wait("meier", now_ + seconds(expected_s)), milliseconds(0));
  }
}

TEST_F(LoginThrottles, HoldNobodyElseUp) {
  throttle_.Failed("meier", now_);
  EXPECT_EQ(throttle_.Wait("schulz", now_), milliseconds(0));
}

TEST_F(LoginThrottles, ForgetWithTheRightPasswordAndWithTime) {
  for (int i = 0; i < 5; ++i) throttle_.Failed("meier", now_);
  throttle_.Succeeded("meier");
  EXPECT_EQ(throttle_.Wait("meier", now_), milliseconds(0));
  for (int i = 0; i < 5; ++i) throttle_.Failed("meier", now_);
  now_ += LoginThrottle::kForgottenAfter;
  throttle_.Failed("meier", now_);
  EXPECT_EQ(throttle_.Wait("meier", now_), seconds(1));
}

TEST_F(LoginThrottles, KeepTheNewestOfManyNames) {
  throttle_.Failed("first", now_);
  for (std::size_t i = 1; i < LoginThrottle::kMostNames; ++i) {
    throttle_.Failed("name " + std::to_string(i), now_ + milliseconds(1));
  }
  throttle_.Failed("one more", now_ + milliseconds(2));
  EXPECT_EQ(throttle_.Wait("first", now_), milliseconds(0));
  EXPECT_GT(throttle_.Wait("name 1", now_), milliseconds(0));
  EXPECT_GT(throttle_.Wait("one more", now_), milliseconds(0));
}

}  // namespace
}  // namespace strainwave::bench::login_throttle_test
