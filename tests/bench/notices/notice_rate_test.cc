// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_rate.h"

#include <gtest/gtest.h>

namespace strainwave::bench::notice_rate_test {
namespace {

// Of 20 an hour 5 are kept for what is urgent.
constexpr int kPerHour = 20;

void ExpectRoom(const NoticeRoom& room, std::size_t by_themselves, bool summary) {
  EXPECT_EQ(room.by_themselves, by_themselves);
  EXPECT_EQ(room.summary, summary);
}

TEST(NoticeRate, LeavesRoomForAllThatFits) {
  ExpectRoom(RoomFor(0, 0, 0, kPerHour), 0, false);
  ExpectRoom(RoomFor(3, 12, 0, kPerHour), 15, false);
  ExpectRoom(RoomFor(20, 0, 0, kPerHour), 20, false);
}

TEST(NoticeRate, PutsTheRestIntoOne) {
  ExpectRoom(RoomFor(0, 16, 0, kPerHour), 14, true);
  ExpectRoom(RoomFor(21, 4, 0, kPerHour), 19, true);
}

TEST(NoticeRate, KeepsAQuarterForWhatIsUrgent) {
  ExpectRoom(RoomFor(0, 1, 15, kPerHour), 0, false);
  ExpectRoom(RoomFor(5, 1, 15, kPerHour), 5, false);
  ExpectRoom(RoomFor(6, 0, 15, kPerHour), 4, true);
  ExpectRoom(RoomFor(1, 1, 20, kPerHour), 0, false);
  ExpectRoom(RoomFor(0, 2, 0, 2), 0, true);
}

TEST(NoticeRate, NeverSendsMoreThanItMay) {
  for (std::size_t urgent = 0; urgent < 30; ++urgent) {
    for (std::size_t others = 0; others < 30; ++others) {
      for (std::size_t sent = 0; sent <= 20; ++sent) {
        const NoticeRoom room = RoomFor(urgent, others, sent, kPerHour);
        EXPECT_LE(room.by_themselves + (room.summary ? 1 : 0) + sent, 20U)
            << urgent << " " << others << " " << sent;
        EXPECT_LE(room.by_themselves, urgent + others);
      }
    }
  }
}

TEST(NoticeRate, CountsTheLastHourAlone) {
  constexpr Moment kNow{10'000'000, 9'000'000, 7};
  std::vector<Moment> sent{{6'400'000, 5'400'000, 7}, {6'400'001, 5'400'001, 7}, {20'000'000, 0, 3}};
  ForgetSent(sent, kNow);
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].utc_ms, 6'400'001);
}

}  // namespace
}  // namespace strainwave::bench::notice_rate_test
