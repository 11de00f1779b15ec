// SPDX-License-Identifier: Apache-2.0
// NMT, heartbeats and SYNC: all that a node is watched by.
#include "protocols/canopen/nmt.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "protocols/canopen/heartbeat.h"
#include "protocols/canopen/sync.h"
#include "tests/protocols/canopen/frames.h"

namespace strainwave::protocols::canopen::nmt_test {
namespace {

using namespace std::chrono_literals;
using Event = std::optional<HeartbeatEvent>;

TEST(NmtFrame, IsTheCommandAndTheNodeUnderIdentifierZero) {
  EXPECT_EQ(NmtFrame(NmtCommand::kStart, 3), Frame("000#0103"));
  EXPECT_EQ(NmtFrame(NmtCommand::kStop, 3), Frame("000#0203"));
  EXPECT_EQ(NmtFrame(NmtCommand::kEnterPreOperational, 127), Frame("000#807F"));
  EXPECT_EQ(NmtFrame(NmtCommand::kResetNode, 0), Frame("000#8100"));
  EXPECT_EQ(NmtFrame(NmtCommand::kResetCommunication, 1), Frame("000#8201"));
}

// Point 10.
TEST(NmtStateOf, MasksTheToggleBitForAllBytes) {
  for (int byte = 0; byte < 128; ++byte) {
    EXPECT_EQ(NmtStateOf(static_cast<std::uint8_t>(byte)), NmtStateOf(static_cast<std::uint8_t>(byte + 128)));
    const bool is_state = byte == 0 || byte == 4 || byte == 5 || byte == 127;
    EXPECT_EQ(NmtStateOf(static_cast<std::uint8_t>(byte)).has_value(), is_state) << byte;
  }
  EXPECT_EQ(NmtStateOf(0x85), NmtState::kOperational);
}

TEST(HeartbeatProducer, SendsAtItsPeriodAndMakesUpForNoPause) {
  HeartbeatProducer producer(127, 50ms);
  EXPECT_EQ(producer.Poll(1000ms), Frame("77F#05"));
  EXPECT_EQ(producer.Poll(1049ms), std::nullopt);
  EXPECT_TRUE(producer.Poll(1051ms).has_value());
  EXPECT_FALSE(producer.Poll(1099ms).has_value());
  EXPECT_TRUE(producer.Poll(1100ms).has_value());  // on its grid
  EXPECT_TRUE(producer.Poll(2000ms).has_value());
  EXPECT_FALSE(producer.Poll(2001ms).has_value());
}

TEST(HeartbeatConsumer, TellsOnceThatAHeartbeatIsLostAndThatItIsBack) {
  HeartbeatConsumer consumer(3, 150ms);
  consumer.Start(0ms);
  EXPECT_EQ(consumer.OnFrame(Frame("703#7F"), 10ms), Event(HeartbeatEvent::kStateChanged));
  EXPECT_EQ(consumer.OnFrame(Frame("703#FF"), 60ms), Event());
  EXPECT_EQ(consumer.Poll(209ms), Event());
  EXPECT_EQ(consumer.Poll(210ms), Event(HeartbeatEvent::kLost));
  EXPECT_EQ(consumer.Poll(500ms), Event());
  EXPECT_TRUE(consumer.is_lost());
  EXPECT_EQ(consumer.OnFrame(Frame("703#7F"), 510ms), Event(HeartbeatEvent::kReturned));
  EXPECT_FALSE(consumer.is_lost());
}

TEST(HeartbeatConsumer, MissesAHeartbeatThatNeverCame) {
  HeartbeatConsumer consumer(3, 150ms);
  EXPECT_EQ(consumer.Poll(1s), Event());
  consumer.Start(1s);
  EXPECT_EQ(consumer.Poll(1150ms), Event(HeartbeatEvent::kLost));
}

TEST(HeartbeatConsumer, TellsABootUpFromAChangeOfState) {
  HeartbeatConsumer consumer(3, 150ms);
  consumer.Start(0ms);
  consumer.OnFrame(Frame("703#05"), 10ms);
  EXPECT_EQ(consumer.OnFrame(Frame("703#7F"), 20ms), Event(HeartbeatEvent::kStateChanged));
  EXPECT_EQ(consumer.state(), NmtState::kPreOperational);
  EXPECT_EQ(consumer.OnFrame(Frame("703#00"), 30ms), Event(HeartbeatEvent::kBootUp));
  EXPECT_EQ(consumer.OnFrame(Frame("703#00"), 40ms), Event(HeartbeatEvent::kBootUp));
  consumer.Poll(1s);
  EXPECT_EQ(consumer.OnFrame(Frame("703#00"), 1s), Event(HeartbeatEvent::kBootUp));
}

TEST(HeartbeatConsumer, TakesNothingElseForAHeartbeat) {
  HeartbeatConsumer consumer(3, 150ms);
  consumer.Start(0ms);
  for (const char* text : {"704#05", "703#", "703#0500", "703#33", "583#05"}) {
    EXPECT_EQ(consumer.OnFrame(Frame(text), 100ms), Event()) << text;
  }
  CanFrame remote = Frame("703#05");  // node guarding's question
  remote.remote = true;
  EXPECT_EQ(consumer.OnFrame(remote, 100ms), Event());
  EXPECT_EQ(consumer.Poll(150ms), Event(HeartbeatEvent::kLost));
}

TEST(Heartbeat, RefusesANodeThatIsNoneAndNoTime) {
  EXPECT_THROW(HeartbeatConsumer(0, 1ms), std::invalid_argument);
  EXPECT_THROW(HeartbeatProducer(128, 1ms), std::invalid_argument);
  try {
    HeartbeatConsumer consumer(3, 0ms);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "timeout = 0 ns is not above zero");
  }
}

TEST(SyncProducer, CountsFromOneToTheOverflowOrNotAtAll) {
  SyncProducer plain;
  EXPECT_EQ(plain.Next(), Frame("080#"));
  SyncProducer counting(3);
  for (const char* text : {"080#01", "080#02", "080#03", "080#01"}) EXPECT_EQ(counting.Next(), Frame(text));
  EXPECT_THROW(SyncProducer(1), std::invalid_argument);
  EXPECT_THROW(SyncProducer(241), std::invalid_argument);
}

// Point 8.
TEST(SyncMeter, GivesShortestLongestAndMeanIntervalSinceLastAsked) {
  SyncMeter meter;
  EXPECT_EQ(meter.Take().count, 0U);
  for (const auto time : {0us, 1000us, 1900us, 3100us}) meter.OnSync(time);
  const SyncIntervals first = meter.Take();
  EXPECT_EQ(first.count, 3U);
  EXPECT_EQ(first.min, 900us);
  EXPECT_EQ(first.max, 1200us);
  EXPECT_EQ(first.mean, std::chrono::nanoseconds(3100us) / 3);
  meter.OnSync(4100us);
  const SyncIntervals second = meter.Take();
  EXPECT_EQ(second.count, 1U);
  EXPECT_EQ(second.min, 1000us);
  EXPECT_EQ(second.max, 1000us);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::nmt_test
