// SPDX-License-Identifier: Apache-2.0
// Every frame here is written by hand from CiA 301, 7.2.4.3.
#include "protocols/canopen/sdo_client.h"

#include <gtest/gtest.h>

#include <numeric>
#include <stdexcept>

#include "tests/protocols/canopen/frames.h"

namespace strainwave::protocols::canopen::sdo_client_test {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using State = SdoClient::State;
using Texts = std::vector<std::string>;
using Bytes = std::vector<std::uint8_t>;

constexpr auto kPlain = SdoTransfer::kExpeditedOrSegmented;
constexpr ObjectAddress kStatusword{0x6041, 0};
constexpr ObjectAddress kDeviceName{0x1008, 0};

Bytes Read(const SdoClient& client) { return {client.data().begin(), client.data().end()}; }

class SdoClientTest : public ::testing::Test {
 protected:
  Texts Answer(const std::string& frame) {
    client_.OnFrame(Frame(frame), now_);
    return Sent(client_, now_);
  }
  void ExpectFailure(SdoAbort code, bool by_node) {
    ASSERT_EQ(client_.state(), State::kFailed);
    EXPECT_EQ(client_.failure().code, code) << Words(client_.failure());
    EXPECT_EQ(client_.failure().by_node, by_node);
    EXPECT_TRUE(client_.data().empty());
  }
  Texts StartReading(ObjectAddress address, std::size_t expected_bytes = 0) {
    EXPECT_TRUE(client_.StartUpload(address, expected_bytes, kPlain, now_));
    return Sent(client_, now_);
  }

  nanoseconds now_{10s};
  SdoClient client_{3, 100ms};
};

TEST_F(SdoClientTest, ReadsAnExpeditedValueOfEachLength) {
  EXPECT_EQ(StartReading(kStatusword), (Texts{"603#4041600000000000"}));
  EXPECT_EQ(client_.state(), State::kBusy);
  EXPECT_EQ(Answer("583#4B41600037020000"), Texts{});
  ASSERT_EQ(client_.state(), State::kDone);
  EXPECT_EQ(Read(client_), (Bytes{0x37, 0x02}));

  StartReading({0x6061, 0});
  Answer("583#4F61600003000000");
  EXPECT_EQ(Read(client_), (Bytes{3}));
  StartReading({0x1018, 1});
  Answer("583#43181001040302FF");
  EXPECT_EQ(Read(client_), (Bytes{0x04, 0x03, 0x02, 0xFF}));
  StartReading({0x2000, 5});
  Answer("583#4700200501020300");
  EXPECT_EQ(Read(client_), (Bytes{1, 2, 3}));
}

TEST_F(SdoClientTest, TakesAnExpeditedValueWithoutSizeByTheLengthThatIsExpected) {
  StartReading(kStatusword, 2);
  Answer("583#4241600037020000");
  EXPECT_EQ(Read(client_), (Bytes{0x37, 0x02}));
  StartReading(kStatusword);
  Answer("583#4241600037020000");
  EXPECT_EQ(Read(client_), (Bytes{0x37, 0x02, 0x00, 0x00}));
}

TEST_F(SdoClientTest, WritesAnExpeditedValueOfEachLength) {
  const auto written = [this](Bytes bytes) {
    EXPECT_TRUE(client_.StartDownload({0x6040, 0}, bytes, kPlain, now_));
    const Texts sent = Sent(client_, now_);
    Answer("583#6040600000000000");
    EXPECT_EQ(client_.state(), State::kDone);
    return sent;
  };
  EXPECT_EQ(written({0x0F}), (Texts{"603#2F4060000F000000"}));
  EXPECT_EQ(written({0x0F, 0x01}), (Texts{"603#2B4060000F010000"}));
  EXPECT_EQ(written({1, 2, 3}), (Texts{"603#2740600001020300"}));
  EXPECT_EQ(written({1, 2, 3, 4}), (Texts{"603#2340600001020304"}));
}

TEST_F(SdoClientTest, ReadsASegmentedTextWithAlternatingToggleBit) {
  StartReading(kDeviceName);
  EXPECT_EQ(Answer("583#410810000A000000"), (Texts{"603#6000000000000000"}));
  EXPECT_EQ(Answer("583#0053747261696E77"), (Texts{"603#7000000000000000"}));
  EXPECT_EQ(Answer("583#1961766500000000"), Texts{});  // toggle 1, four bytes unused, last
  ASSERT_EQ(client_.state(), State::kDone);
  const Bytes read = Read(client_);
  EXPECT_EQ(std::string(read.begin(), read.end()), "Strainwave");
}

TEST_F(SdoClientTest, WritesSegmentsWithAlternatingToggleBit) {
  const std::string text = "Strainwave bench";  // 16 bytes: 7 + 7 + 2
  const Bytes bytes(text.begin(), text.end());
  ASSERT_TRUE(client_.StartDownload({0x2001, 2}, bytes, kPlain, now_));
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#2101200210000000"}));
  EXPECT_EQ(Answer("583#6001200200000000"), (Texts{"603#00"
                                                   "53747261696E77"}));
  EXPECT_EQ(Answer("583#2000000000000000"), (Texts{"603#10"
                                                   "6176652062656E"}));
  EXPECT_EQ(Answer("583#3000000000000000"), (Texts{"603#0B"
                                                   "63680000000000"}));
  EXPECT_EQ(client_.state(), State::kBusy);
  Answer("583#2000000000000000");
  EXPECT_EQ(client_.state(), State::kDone);
}

TEST_F(SdoClientTest, WritesNothingAsOneEmptySegment) {
  ASSERT_TRUE(client_.StartDownload({0x2001, 2}, {}, kPlain, now_));
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#2101200200000000"}));
  EXPECT_EQ(Answer("583#6001200200000000"), (Texts{"603#0F00000000000000"}));
  Answer("583#2000000000000000");
  EXPECT_EQ(client_.state(), State::kDone);
}

TEST_F(SdoClientTest, GivesTheNodesAbortInWordsWithNodeAndObject) {
  StartReading({0x6502, 0});
  EXPECT_EQ(Answer("583#8002650000000206"), Texts{});
  ExpectFailure(SdoAbort::kNoSuchObject, true);
  EXPECT_EQ(Words(client_.failure()), "node 3, 6502h:00: there is no such object (06020000h from the node)");
}

TEST_F(SdoClientTest, KeepsAMakersOwnAbortCode) {
  StartReading({0x6502, 0});
  Answer("583#8002650078563412");
  EXPECT_EQ(Words(client_.failure()),
            "node 3, 6502h:00: a code that CiA 301 does not know (12345678h from the node)");
}

TEST_F(SdoClientTest, TimesOutAndTellsTheNode) {
  StartReading(kStatusword);
  now_ += 99ms;
  EXPECT_EQ(Sent(client_, now_), Texts{});
  now_ += 1ms;
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#8041600000000405"}));
  ExpectFailure(SdoAbort::kTimedOut, false);
  EXPECT_EQ(Words(client_.failure()),
            "node 3, 6041h:00: the answer did not come in time (05040000h from this side)");
}

// A late answer never becomes the value of a later question.
TEST_F(SdoClientTest, AsksNothingForATimeAfterATimeOutSoThatALateAnswerIsNotTaken) {
  StartReading(kStatusword);
  now_ += 100ms;
  Sent(client_, now_);
  EXPECT_EQ(StartReading(kStatusword), Texts{});
  now_ += 50ms;
  EXPECT_EQ(Answer("583#4B41600037020000"), Texts{});  // to the first question
  EXPECT_EQ(client_.state(), State::kBusy);
  EXPECT_EQ(client_.unsolicited(), 1U);
  now_ += 50ms;
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#4041600000000000"}));
  Answer("583#4B41600050020000");
  EXPECT_EQ(Read(client_), (Bytes{0x50, 0x02}));
}

TEST_F(SdoClientTest, CountsAnswersThatNobodyAskedForAndChangesNothing) {
  EXPECT_EQ(Answer("583#4B41600037020000"), Texts{});
  EXPECT_EQ(client_.state(), State::kIdle);
  StartReading(kStatusword);
  Answer("583#4B41600037020000");
  Answer("583#4B41600099990000");
  EXPECT_EQ(Read(client_), (Bytes{0x37, 0x02}));
  EXPECT_EQ(client_.unsolicited(), 2U);
}

TEST_F(SdoClientTest, GivesUpOnAnAnswerForAnotherObject) {
  StartReading(kStatusword);
  EXPECT_EQ(Answer("583#4B64600037020000"), (Texts{"603#8041600000000008"}));
  ExpectFailure(SdoAbort::kGeneralError, false);
  EXPECT_EQ(Words(client_.failure()),
            "node 3, 6041h:00: general error: the answer is for another object (08000000h from this side)");
  StartReading({0x1018, 1});
  Answer("583#4318100204030201");  // another sub-index
  ExpectFailure(SdoAbort::kGeneralError, false);
}

TEST_F(SdoClientTest, GivesUpOnAWrongToggleBit) {
  StartReading(kDeviceName);
  Answer("583#410810000A000000");
  EXPECT_EQ(Answer("583#1053747261696E77"), (Texts{"603#8008100000000305"}));
  ExpectFailure(SdoAbort::kToggleBitNotAlternated, false);
}

TEST_F(SdoClientTest, GivesUpOnASegmentThatCameTwice) {
  StartReading(kDeviceName);
  Answer("583#410810000A000000");
  Answer("583#0053747261696E77");
  Answer("583#0053747261696E77");
  ExpectFailure(SdoAbort::kToggleBitNotAlternated, false);
}

TEST_F(SdoClientTest, GivesUpOnAWrongToggleBitWhenWriting) {
  ASSERT_TRUE(client_.StartDownload({0x2001, 2}, Bytes(9), kPlain, now_));
  Sent(client_, now_);
  Answer("583#6001200200000000");
  Answer("583#3000000000000000");
  ExpectFailure(SdoAbort::kToggleBitNotAlternated, false);
}

TEST_F(SdoClientTest, GivesUpOnAnotherCommandThanAsked) {
  for (const char* answer : {"583#6041600000000000", "583#0041600000000000", "583#C041600000000000",
                             "583#A041600000000000", "583#E041600000000000", "583#2041600000000000"}) {
    StartReading(kStatusword);
    Answer(answer);
    ExpectFailure(SdoAbort::kUnknownCommand, false);
  }
}

TEST_F(SdoClientTest, GivesUpOnALengthThatIsNotTheExpectedOne) {
  StartReading(kStatusword, 2);
  Answer("583#4341600037020000");
  ExpectFailure(SdoAbort::kLengthMismatch, false);
  StartReading(kStatusword, 2);
  EXPECT_EQ(Answer("583#4141600007000000"), (Texts{"603#8041600010000706"}));
  ExpectFailure(SdoAbort::kLengthMismatch, false);
}

TEST_F(SdoClientTest, GivesUpOnFewerOrMoreBytesThanAnnounced) {
  StartReading(kDeviceName);
  Answer("583#410810000A000000");
  Answer("583#0153747261696E77");  // seven bytes, said to be the last
  ExpectFailure(SdoAbort::kLengthMismatch, false);
  StartReading(kDeviceName);
  Answer("583#4108100006000000");
  Answer("583#0153747261696E77");
  ExpectFailure(SdoAbort::kLengthTooHigh, false);
}

TEST_F(SdoClientTest, GivesUpOnSegmentsThatNeverEnd) {
  StartReading(kDeviceName);
  Answer("583#4008100000000000");  // no size
  Answer("583#0E00000000000000");  // no data, not the last
  ExpectFailure(SdoAbort::kLengthMismatch, false);

  StartReading(kDeviceName);
  Answer("583#4008100000000000");
  for (int i = 0; client_.state() == State::kBusy; ++i) {
    ASSERT_LT(i, 8192);
    Answer(i % 2 == 0 ? "583#0001020304050607" : "583#1001020304050607");
  }
  ExpectFailure(SdoAbort::kOutOfMemory, false);
}

TEST_F(SdoClientTest, GivesUpOnAnObjectTooLongToHold) {
  StartReading(kDeviceName);
  EXPECT_EQ(Answer("583#41081000FFFFFFFF"), (Texts{"603#8008100005000405"}));
  ExpectFailure(SdoAbort::kOutOfMemory, false);
}

TEST_F(SdoClientTest, GivesUpOnAShortAnswer) {
  StartReading(kStatusword);
  Answer("583#4B41600037");
  ExpectFailure(SdoAbort::kGeneralError, false);
  EXPECT_EQ(client_.failure().detail, "an answer is not eight bytes long");
}

TEST_F(SdoClientTest, LooksAtNoFrameOfAnotherKindOrNode) {
  StartReading(kStatusword);
  Answer("584#4B41600037020000");
  CanFrame frame = Frame("583#4B41600037020000");
  frame.extended = true;
  client_.OnFrame(frame, now_);
  frame.extended = false;
  frame.remote = true;
  client_.OnFrame(frame, now_);
  frame.remote = false;
  frame.error = true;
  client_.OnFrame(frame, now_);
  EXPECT_EQ(client_.state(), State::kBusy);
  EXPECT_EQ(client_.unsolicited(), 0U);
}

TEST_F(SdoClientTest, DoesOneTransferAtATime) {
  StartReading(kStatusword);
  EXPECT_FALSE(client_.StartUpload(kStatusword, 0, kPlain, now_));
  EXPECT_FALSE(client_.StartDownload(kStatusword, Bytes{1}, kPlain, now_));
  client_.Reset();
  EXPECT_EQ(client_.state(), State::kIdle);
  EXPECT_FALSE(client_.StartDownload(kStatusword, Bytes(SdoClient::kMostBytes + 1), kPlain, now_));
  EXPECT_TRUE(client_.StartDownload(kStatusword, Bytes(SdoClient::kMostBytes), kPlain, now_));
}

TEST_F(SdoClientTest, DropsWhatIsYetToBeSentWhenItIsReset) {
  ASSERT_TRUE(client_.StartUpload(kStatusword, 0, kPlain, now_));
  client_.Reset();
  EXPECT_EQ(Sent(client_, now_), Texts{});
}

TEST(SdoClient, RefusesANodeThatIsNone) {
  for (const std::uint8_t node : {std::uint8_t{0}, std::uint8_t{128}}) {
    try {
      SdoClient client(node);
      FAIL();
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(error.what(), "node_id = " + std::to_string(node) + " is not 1 to 127");
    }
  }
  EXPECT_THROW(SdoClient(1, 0ns), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::sdo_client_test
