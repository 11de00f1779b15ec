// SPDX-License-Identifier: Apache-2.0
#include "bench/alarms/alarm_list.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::alarm_list_test {
namespace {

class Alarms : public testing::Test {
 protected:
  RaiseResult RaiseAt(double time_s, const std::string& code = "twist_limit", bool latching = false) {
    AlarmRaise raise;
    raise.code = code;
    raise.text = "at " + std::to_string(time_s);
    raise.latching = latching;
    raise.time_s = time_s;
    raise.utc = "2026-11-02T10:00:00.000Z";
    return Raise(all_, raise, limits_);
  }
  void ReturnAt(double time_s, std::size_t index) {
    ASSERT_TRUE(Return(all_[index], time_s, "2026-11-02T10:00:01.000Z"));
  }
  void Acknowledge(std::size_t index) {
    ASSERT_TRUE(Act(all_[index], AlarmEvent::kAcknowledge, "A. Meier", "2026-11-02T11:00:00.000Z"));
  }
  std::vector<std::string> FirstOuts() const {
    std::vector<std::string> codes;
    for (const AlarmInstance& instance : all_) {
      if (instance.first_out) codes.push_back(instance.code);
    }
    return codes;
  }
  int RaisesCounted() const {
    int count = 0;
    for (const AlarmInstance& instance : all_) count += instance.count;
    return count;
  }

  std::vector<AlarmInstance> all_;
  ChatterLimits limits_{.again_within_s = 60.0, .most_of_a_kind = 3, .period_s = 600.0, .most_of_all = 10};
};

TEST_F(Alarms, OfOneInterlockAreTwoInstancesWhereTheFirstHasReturnedLongAgo) {
  EXPECT_EQ(RaiseAt(0.0).effect, RaiseEffect::kNew);
  ReturnAt(10.0, 0);
  EXPECT_EQ(RaiseAt(71.0).effect, RaiseEffect::kNew);
  ASSERT_EQ(all_.size(), 2U);
  Acknowledge(0);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kCleared);
  EXPECT_EQ(all_[0].acknowledged_by, "A. Meier");
  EXPECT_EQ(all_[1].state, AlarmInstanceState::kRaised) << "acknowledging one hides no other";
  EXPECT_EQ(all_[1].acknowledged_by, "");
}

TEST_F(Alarms, ThatAreActiveCountARaise) {
  RaiseAt(0.0);
  Acknowledge(0);
  EXPECT_EQ(RaiseAt(1000.0).effect, RaiseEffect::kStillActive);
  ASSERT_EQ(all_.size(), 1U);
  EXPECT_EQ(all_[0].count, 2);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kAcknowledged);
  EXPECT_EQ(all_[0].raised_s, 0.0);
  EXPECT_EQ(all_[0].last_raised_s, 1000.0);
}

TEST_F(Alarms, ThatChatterAreCountedOnTheInstance) {
  double time_s = 0.0;
  for (int i = 0; i < 500; ++i, time_s += 2.0) {
    RaiseAt(time_s);
    ReturnAt(time_s + 1.0, 0);
  }
  ASSERT_EQ(all_.size(), 1U);
  EXPECT_EQ(all_[0].count, 500);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kReturned);
  EXPECT_EQ(all_[0].returned_s, time_s - 1.0);
}

// 61 s after each return: never within the minute, and still too often.
TEST_F(Alarms, ThatComeTooOftenInAPeriodAreCountedOnTheNewest) {
  for (int i = 0; i < 6; ++i) {
    RaiseAt(62.0 * i);
    ReturnAt(62.0 * i + 1.0, std::min<std::size_t>(static_cast<std::size_t>(i), 2));
  }
  ASSERT_EQ(all_.size(), 3U);
  EXPECT_EQ(all_[0].count, 1);
  EXPECT_EQ(all_[2].count, 4);
  // Ten minutes after the first of the three one more may come.
  EXPECT_EQ(RaiseAt(601.0).effect, RaiseEffect::kNew);
}

TEST_F(Alarms, ThatWereClearedAskAgainWhenTheyChatter) {
  RaiseAt(0.0);
  Acknowledge(0);
  ReturnAt(1.0, 0);
  ASSERT_EQ(all_[0].state, AlarmInstanceState::kCleared);
  EXPECT_EQ(RaiseAt(2.0).effect, RaiseEffect::kChatter);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kRaised);
  EXPECT_EQ(all_[0].acknowledged_by, "");
  EXPECT_EQ(all_[0].returned_utc, "");
}

TEST_F(Alarms, OfAFloodAreLimitedAndCountedAndNoKindIsHidden) {
  // Ten kinds raise and return, seven times over, an hour's worth of trouble in 2 minutes.
  limits_.again_within_s = 0.0;
  limits_.most_of_a_kind = 1000;
  double time_s = 0.0;
  for (int round = 0; round < 7; ++round) {
    for (int kind = 0; kind < 10; ++kind, time_s += 1.7) {
      const RaiseResult raised = RaiseAt(time_s, "kind_" + std::to_string(kind));
      EXPECT_EQ(raised.effect, round == 0 ? RaiseEffect::kNew : RaiseEffect::kFlood);
      ReturnAt(time_s + 0.5, raised.index);
    }
  }
  EXPECT_EQ(all_.size(), 10U);
  EXPECT_EQ(RaisesCounted(), 70);
  EXPECT_EQ(all_[4].count_in_floods, 6);
  // One that nobody has seen yet is no part of the flood.
  EXPECT_EQ(RaiseAt(time_s, "drive_fault").effect, RaiseEffect::kNew);
  // Nor one whose instances are all cleared.
  Acknowledge(3);
  ASSERT_EQ(all_[3].state, AlarmInstanceState::kCleared);
  EXPECT_EQ(RaiseAt(time_s + 1.0, "kind_3").effect, RaiseEffect::kNew);
}

TEST_F(Alarms, OfARunThatIsOverTakeNoRaise) {
  RaiseAt(0.0);
  ReturnAt(1.0, 0);
  all_[0].of_earlier_run = true;
  EXPECT_EQ(RaiseAt(2.0).effect, RaiseEffect::kNew);
}

TEST_F(Alarms, FirstOutIsTheEarliestOfAnUpset) {
  RaiseAt(100.0, "twist_limit");
  RaiseAt(100.9, "output_torque_limit");
  RaiseAt(101.0, "drive_fault");  // a second after the first still belongs to it
  EXPECT_EQ(FirstOuts(), std::vector<std::string>{"twist_limit"});
  RaiseAt(101.1, "torque_away");
  EXPECT_EQ(FirstOuts(), (std::vector<std::string>{"twist_limit", "torque_away"}));
}

TEST_F(Alarms, FirstOutGoesToAnEarlierOneThatIsToldLater) {
  RaiseAt(100.5, "drive_fault");
  RaiseAt(100.1, "brake_engaged");
  RaiseAt(100.4, "twist_limit");
  EXPECT_EQ(FirstOuts(), std::vector<std::string>{"brake_engaged"});
}

TEST_F(Alarms, FirstOutGoesToOneThatChattersWhereItBeganTheUpset) {
  RaiseAt(0.0, "drive_fault");
  RaiseAt(0.5, "twist_limit");
  ReturnAt(1.0, 0);
  ReturnAt(1.0, 1);
  RaiseAt(30.0, "twist_limit");
  RaiseAt(30.2, "drive_fault");
  EXPECT_EQ(FirstOuts(), std::vector<std::string>{"twist_limit"});
}

TEST_F(Alarms, ThatLatchStayOpenUntilConfirmed) {
  RaiseAt(0.0, "twist_limit", true);
  EXPECT_FALSE(Act(all_[0], AlarmEvent::kConfirm, "B. Kurz", "")) << "its condition is still there";
  Acknowledge(0);
  ReturnAt(5.0, 0);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kLatched);
  ASSERT_TRUE(Act(all_[0], AlarmEvent::kConfirm, "B. Kurz", "2026-11-02T12:00:00.000Z"));
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kCleared);
  EXPECT_EQ(all_[0].confirmed_by, "B. Kurz");
  EXPECT_EQ(all_[0].acknowledged_by, "A. Meier");
}

TEST_F(Alarms, OnAShelfTakeTheRaisesOfTheirKind) {
  RaiseAt(0.0);
  Acknowledge(0);
  ASSERT_TRUE(Act(all_[0], AlarmEvent::kShelve, "A. Meier", "", {.by = "", .utc_ms = 5, .length_s = 1800.0}));
  ReturnAt(1.0, 0);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kShelvedCleared);
  EXPECT_EQ(RaiseAt(900.0).effect, RaiseEffect::kShelved);
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kShelvedRaised)
      << "what comes under the shelf was seen by nobody";
  EXPECT_EQ(all_[0].shelf.by, "A. Meier");
  ASSERT_TRUE(Act(all_[0], AlarmEvent::kShelfOver, "", ""));
  EXPECT_EQ(all_[0].state, AlarmInstanceState::kRaised);
  EXPECT_EQ(all_[0].shelf.by, "");
}

TEST_F(Alarms, ComeOffTheShelfWhenItsTimeIsOverOrNotKnown) {
  RaiseAt(0.0);
  EXPECT_FALSE(IsShelfOver(all_[0], 1e9)) << "it is on none";
  ASSERT_TRUE(Act(all_[0], AlarmEvent::kShelve, "A. Meier", "", {.by = "", .utc_ms = 5, .length_s = 1800.0}));
  EXPECT_FALSE(IsShelfOver(all_[0], 0.0));
  EXPECT_FALSE(IsShelfOver(all_[0], 1799.9));
  EXPECT_TRUE(IsShelfOver(all_[0], 1800.0));
  // A clock set back across a restart: nobody knows how long it has lain there.
  EXPECT_TRUE(IsShelfOver(all_[0], std::nullopt));
}

TEST_F(Alarms, LeaveEverythingAsItWasWhereAnActIsNotAllowed) {
  RaiseAt(0.0);
  Acknowledge(0);
  EXPECT_FALSE(Act(all_[0], AlarmEvent::kAcknowledge, "B. Kurz", "later"));
  EXPECT_EQ(all_[0].acknowledged_by, "A. Meier");
  EXPECT_FALSE(Act(all_[0], AlarmEvent::kUnshelve, "B. Kurz", "later"));
  EXPECT_FALSE(Return(all_[0], 1.0, "") && Return(all_[0], 2.0, ""));
  EXPECT_EQ(all_[0].returned_s, 1.0);
}

}  // namespace
}  // namespace strainwave::bench::alarm_list_test
