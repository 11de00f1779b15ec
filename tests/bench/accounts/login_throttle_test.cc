// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/login_throttle.h"

#include <string>

#include <gtest/gtest.h>

namespace strainwave::bench::login_throttle_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr const char* kDesk = "192.0.2.7";
constexpr const char* kElsewhere = "192.0.2.8";

class LoginThrottles : public testing::Test {
 protected:
  void Fail(const std::string& name, const std::string& address, int times = 1) {
    for (int i = 0; i < times; ++i) throttle_.Failed(name, address, now_);
  }
  milliseconds Wait(const std::string& name, const std::string& address) const {
    return throttle_.Wait(name, address, now_);
  }
  // As a page does: counted before it is known.
  void LogIn(const std::string& name, const std::string& address) {
    Fail(name, address);
    throttle_.Succeeded(name, address, now_);
  }

  LoginThrottle throttle_;
  LoginThrottle::Time now_{std::chrono::hours(1)};
};

TEST_F(LoginThrottles, DoubleTheWaitWithEachWrongPassword) {
  EXPECT_EQ(Wait("meier", kDesk), milliseconds(0));
  for (const int expected_s : {1, 2, 4, 8, 16, 32, 60, 60}) {
    Fail("meier", kDesk);
    EXPECT_EQ(Wait("meier", kDesk), seconds(expected_s));
    EXPECT_EQ(throttle_.Wait("meier", kDesk, now_ + seconds(expected_s) - milliseconds(1)), milliseconds(1));
    EXPECT_EQ(throttle_.Wait("meier", kDesk, now_ + seconds(expected_s)), milliseconds(0));
    EXPECT_EQ(throttle_.Wait("meier", kDesk, now_ + seconds(300)), milliseconds(0));
  }
}

TEST_F(LoginThrottles, HoldNobodyElseUp) {
  Fail("meier", kDesk, 5);
  EXPECT_EQ(Wait("schulz", kDesk), milliseconds(0));
  EXPECT_EQ(Wait("meier", kElsewhere), milliseconds(0));
}

TEST_F(LoginThrottles, SlowAnAddressThatTriesManyNames) {
  for (int i = 0; i < LoginThrottle::kFree; ++i) Fail("name " + std::to_string(i), kElsewhere);
  EXPECT_EQ(Wait("meier", kElsewhere), milliseconds(0));
  Fail("one more", kElsewhere);
  EXPECT_EQ(Wait("meier", kElsewhere), seconds(1));
  Fail("and one more", kElsewhere);
  EXPECT_EQ(Wait("meier", kElsewhere), seconds(2));
  EXPECT_EQ(Wait("meier", kDesk), milliseconds(0));
}

TEST_F(LoginThrottles, SlowManyAddressesThatTryOneName) {
  for (int i = 0; i < LoginThrottle::kFree + 2; ++i) Fail("meier", "192.0.2." + std::to_string(100 + i));
  EXPECT_EQ(Wait("meier", kDesk), seconds(2));
  EXPECT_EQ(Wait("schulz", kDesk), milliseconds(0));
}

TEST_F(LoginThrottles, KeepNobodyOutWhereThatNameHasLoggedInBefore) {
  LogIn("meier", kDesk);
  for (int i = 0; i < 100; ++i) Fail("meier", "192.0.2." + std::to_string(100 + i));
  Fail("schulz", kDesk, 100);
  EXPECT_EQ(Wait("meier", kDesk), milliseconds(0));
  EXPECT_EQ(Wait("meier", kElsewhere), seconds(60));
  Fail("meier", kDesk);
  EXPECT_EQ(Wait("meier", kDesk), seconds(1)) << "its own wrong passwords count all the same";
  now_ += LoginThrottle::kKnownFor;
  Fail("schulz", kDesk, 100);
  EXPECT_EQ(Wait("meier", kDesk), seconds(60)) << "known a week ago";
}

TEST_F(LoginThrottles, ForgetWithTheRightPasswordAndWithTime) {
  Fail("meier", kDesk, 5);
  LogIn("meier", kDesk);
  EXPECT_EQ(Wait("meier", kDesk), milliseconds(0));
  Fail("meier", kDesk, 5);
  now_ += LoginThrottle::kForgottenAfter;
  Fail("meier", kDesk);
  EXPECT_EQ(Wait("meier", kDesk), seconds(1));
}

TEST_F(LoginThrottles, DoNotForgetAnAddressForOneRightPassword) {
  Fail("schulz", kDesk, LoginThrottle::kFree);
  for (int i = 0; i < 20; ++i) LogIn("accomplice", kDesk);
  Fail("schulz", kDesk);
  EXPECT_EQ(Wait("meier", kDesk), seconds(1));
}

TEST_F(LoginThrottles, CountNoRightPasswordAgainstItsAddressOrName) {
  for (int i = 0; i < 100; ++i) LogIn("meier", kDesk);
  EXPECT_EQ(Wait("schulz", kDesk), milliseconds(0));
  EXPECT_EQ(Wait("meier", kElsewhere), milliseconds(0));
}

TEST_F(LoginThrottles, KnowTheNewestOfManyWhoHaveLoggedIn) {
  LogIn("first", kDesk);
  for (std::size_t i = 1; i <= LoginThrottle::kMostKept; ++i) {
    now_ += milliseconds(1);
    LogIn("name " + std::to_string(i), kDesk);
  }
  Fail("somebody", kDesk, LoginThrottle::kFree + 1);
  EXPECT_EQ(Wait("first", kDesk), seconds(1));
  EXPECT_EQ(Wait("name 1", kDesk), milliseconds(0));
}

TEST_F(LoginThrottles, KeepTheNewestOfMany) {
  Fail("first", "first");
  now_ += milliseconds(1);
  for (std::size_t i = 1; i < LoginThrottle::kMostKept; ++i) {
    Fail("name " + std::to_string(i), "address " + std::to_string(i));
  }
  now_ += milliseconds(1);
  Fail("one more", "one more");
  EXPECT_EQ(Wait("first", "first"), milliseconds(0));
  EXPECT_GT(Wait("name 1", "address 1"), milliseconds(0));
  EXPECT_GT(Wait("one more", "one more"), milliseconds(0));
}

}  // namespace
}  // namespace strainwave::bench::login_throttle_test
