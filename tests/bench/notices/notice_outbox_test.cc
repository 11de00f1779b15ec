// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_outbox.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::bench::notice_outbox_test {
namespace {

Moment At(double time_s) {
  const auto later_ms = static_cast<std::int64_t>(1e3 * time_s);
  return {1'793'613'600'000 + later_ms, 3'600'000 + later_ms, 7};
}

Notice Made(const std::string& id, AlarmPriority priority = AlarmPriority::kMedium) {
  Notice notice;
  notice.id = id;
  notice.subject = "of " + id;
  notice.priority = priority;
  return notice;
}

class NoticesThatWait : public testing::Test {
 protected:
  NoticesThatWait() { UseChannels(outbox_, {"mail", "mqtt"}); }
  std::string Next(const std::string& channel, double time_s) const {
    const Notice* const next = NextFor(outbox_, channel, At(time_s));
    return next == nullptr ? "none" : next->id;
  }
  NoticeOutbox outbox_;
};

TEST_F(NoticesThatWait, GoOverEveryChannel) {
  Put(outbox_, {Made("a")}, At(0));
  EXPECT_EQ(Next("mail", 0), "a");
  Delivered(outbox_, "mail", "a");
  EXPECT_EQ(Next("mail", 0), "none");
  EXPECT_EQ(Next("mqtt", 0), "a");
  Delivered(outbox_, "mqtt", "a");
  EXPECT_TRUE(outbox_.waiting.empty());
}

TEST_F(NoticesThatWait, GoUrgentOnesFirstThenInOrder) {
  Put(outbox_, {Made("a"), Made("b"), Made("c", AlarmPriority::kHigh)}, At(0));
  for (const char* id : {"c", "a", "b"}) {
    EXPECT_EQ(Next("mail", 0), id);
    Delivered(outbox_, "mail", id);
  }
}

TEST_F(NoticesThatWait, AreTriedAgainAfterAPauseThatGrows) {
  Put(outbox_, {Made("a")}, At(0));
  EXPECT_TRUE(Failed(outbox_, "mail", "a", "no server", At(0)));
  EXPECT_EQ(Next("mail", 9.9), "none");
  EXPECT_EQ(Next("mqtt", 0), "a") << "one dead channel holds up no other";
  EXPECT_EQ(Next("mail", 10), "a");
  EXPECT_FALSE(Failed(outbox_, "mail", "a", "no server", At(10))) << "no news";
  EXPECT_EQ(Next("mail", 29.9), "none");
  EXPECT_EQ(Next("mail", 30), "a");
  EXPECT_EQ(outbox_.channels[0].trouble, "no server");
  Delivered(outbox_, "mail", "a");
  EXPECT_EQ(outbox_.channels[0].trouble, "");
  EXPECT_EQ(PauseAfter_s(7), 600.0);
  EXPECT_EQ(PauseAfter_s(2000), 600.0);
}

TEST_F(NoticesThatWait, HoldUpNoOtherWhenOneIsRefused) {
  Put(outbox_, {Made("refused", AlarmPriority::kHigh), Made("b")}, At(0));
  Failed(outbox_, "mail", "refused", "550", At(0));
  EXPECT_EQ(Next("mail", 10), "b");
}

TEST_F(NoticesThatWait, AreGivenUpAfterADay) {
  Put(outbox_, {Made("a")}, At(0));
  Delivered(outbox_, "mqtt", "a");
  EXPECT_TRUE(GiveUpOld(outbox_, At(86'399)).empty());
  EXPECT_EQ(GiveUpOld(outbox_, At(86'400)), std::vector<std::string>{"given up after a day on mail: of a"});
  EXPECT_TRUE(outbox_.waiting.empty());
}

TEST_F(NoticesThatWait, ForAChannelThatIsNoMoreAreLetGo) {
  Put(outbox_, {Made("a")}, At(0));
  Failed(outbox_, "mail", "a", "no server", At(0));
  UseChannels(outbox_, {"webhook", "mail"});
  EXPECT_EQ(Next("mqtt", 0), "none");
  EXPECT_EQ(Next("webhook", 0), "none") << "what was before it is not for it";
  EXPECT_EQ(outbox_.channels[1].failures, 1);
  UseChannels(outbox_, {"webhook"});
  EXPECT_TRUE(outbox_.waiting.empty());
}

}  // namespace
}  // namespace strainwave::bench::notice_outbox_test
