// SPDX-License-Identifier: Apache-2.0
// Block transfers, by hand from CiA 301, 7.2.4.3.9 to 7.2.4.3.16.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "protocols/canopen/sdo_client.h"
#include "tests/protocols/canopen/frames.h"

namespace strainwave::protocols::canopen::sdo_block_test {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;
using State = SdoClient::State;
using Texts = std::vector<std::string>;
using Bytes = std::vector<std::uint8_t>;

constexpr ObjectAddress kObject{0x2001, 2};

// The nine bytes whose checksum the standard gives: 31C3h.
const Bytes kDigits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};

Bytes Counting(std::size_t count) {
  Bytes bytes(count);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

class SdoBlockTest : public ::testing::Test {
 protected:
  Texts Answer(const std::string& frame) {
    client_.OnFrame(Frame(frame), now_);
    return Sent(client_, now_);
  }
  Texts StartWriting(const Bytes& bytes) {
    EXPECT_TRUE(client_.StartDownload(kObject, bytes, SdoTransfer::kBlock, now_));
    return Sent(client_, now_);
  }
  Texts StartReading() {
    EXPECT_TRUE(client_.StartUpload(kObject, 0, SdoTransfer::kBlock, now_));
    return Sent(client_, now_);
  }
  void ExpectFailure(SdoAbort code) {
    ASSERT_EQ(client_.state(), State::kFailed);
    EXPECT_EQ(client_.failure().code, code) << Words(client_.failure());
    EXPECT_TRUE(client_.data().empty());
  }
  Bytes Read() const { return {client_.data().begin(), client_.data().end()}; }

  nanoseconds now_{10s};
  SdoClient client_{3, 100ms};
};

TEST_F(SdoBlockTest, WritesABlockWithTheChecksumOfTheStandard) {
  EXPECT_EQ(StartWriting(kDigits), (Texts{"603#C601200209000000"}));
  EXPECT_EQ(Answer("583#A40120020A000000"), (Texts{"603#0131323334353637", "603#8238390000000000"}));
  // Five of the last seven bytes are unused; C3 31 is the checksum.
  EXPECT_EQ(Answer("583#A2020A0000000000"), (Texts{"603#D5C3310000000000"}));
  EXPECT_EQ(client_.state(), State::kBusy);
  Answer("583#A100000000000000");
  EXPECT_EQ(client_.state(), State::kDone);
}

TEST_F(SdoBlockTest, SendsNoChecksumToANodeThatHasNone) {
  StartWriting(kDigits);
  Answer("583#A00120020A000000");
  EXPECT_EQ(Answer("583#A2020A0000000000"), (Texts{"603#D500000000000000"}));
}

TEST_F(SdoBlockTest, WritesInBlocksOfTheSizeThatTheNodeAsksForEachTime) {
  StartWriting(Counting(28));  // four full segments
  EXPECT_EQ(Answer("583#A401200201000000"), (Texts{"603#0101020304050607"}));
  EXPECT_EQ(Answer("583#A201020000000000"), (Texts{"603#0108090A0B0C0D0E", "603#020F101112131415"}));
  EXPECT_EQ(Answer("583#A2027F0000000000"), (Texts{"603#81161718191A1B1C"}));
  const Texts end = Answer("583#A2017F0000000000");
  ASSERT_EQ(end.size(), 1U);
  EXPECT_EQ(end[0].substr(0, 6), "603#C1");  // no byte unused
}

TEST_F(SdoBlockTest, SendsAgainFromTheFirstSegmentThatWasLost) {
  StartWriting(Counting(28));
  EXPECT_EQ(Answer("583#A401200204000000").size(), 4U);
  EXPECT_EQ(Answer("583#A201030000000000"),
            (Texts{"603#0108090A0B0C0D0E", "603#020F101112131415", "603#83161718191A1B1C"}));
  EXPECT_EQ(Answer("583#A203030000000000").size(), 1U);
  Answer("583#A100000000000000");
  EXPECT_EQ(client_.state(), State::kDone);
}

TEST_F(SdoBlockTest, GivesUpWhenNoSegmentComesThrough) {
  StartWriting(Counting(28));
  Answer("583#A401200204000000");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(Answer("583#A200040000000000").size(), 4U);
  EXPECT_EQ(Answer("583#A200040000000000"), (Texts{"603#8001200203000405"}));
  ExpectFailure(SdoAbort::kInvalidSequenceNumber);
}

TEST_F(SdoBlockTest, GivesUpOnASequenceNumberThatWasNotSent) {
  StartWriting(Counting(28));
  Answer("583#A401200202000000");
  Answer("583#A203020000000000");
  ExpectFailure(SdoAbort::kInvalidSequenceNumber);
}

TEST_F(SdoBlockTest, GivesUpOnABlockSizeThatIsNone) {
  for (const char* size : {"00", "80", "FF"}) {
    StartWriting(kDigits);
    Answer(std::string("583#A4012002") + size + "000000");
    ExpectFailure(SdoAbort::kInvalidBlockSize);
  }
  StartWriting(kDigits);
  Answer("583#A40120020A000000");
  Answer("583#A202000000000000");
  ExpectFailure(SdoAbort::kInvalidBlockSize);
}

TEST_F(SdoBlockTest, ReportsTheNodesChecksumError) {
  StartWriting(kDigits);
  Answer("583#A40120020A000000");
  Answer("583#A2020A0000000000");
  Answer("583#8001200204000405");
  ExpectFailure(SdoAbort::kCrcError);
  EXPECT_TRUE(client_.failure().by_node);
}

TEST_F(SdoBlockTest, TimesOutWaitingForAnAcknowledgement) {
  StartWriting(kDigits);
  Answer("583#A40120020A000000");
  now_ += 100ms;
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#8001200200000405"}));
  ExpectFailure(SdoAbort::kTimedOut);
}

TEST_F(SdoBlockTest, GoesOnSegmentedWhereTheNodeRefusesBlocks) {
  StartWriting(kDigits);
  EXPECT_EQ(Answer("583#8001200201000405"), (Texts{"603#2101200209000000"}));
  EXPECT_EQ(Answer("583#6001200200000000"), (Texts{"603#0031323334353637"}));
  EXPECT_EQ(Answer("583#2000000000000000"), (Texts{"603#1B38390000000000"}));
  Answer("583#3000000000000000");
  EXPECT_EQ(client_.state(), State::kDone);

  StartReading();
  EXPECT_EQ(Answer("583#8001200201000405"), (Texts{"603#4001200200000000"}));
  Answer("583#4F01200207000000");
  EXPECT_EQ(Read(), Bytes{7});
}

TEST_F(SdoBlockTest, GivesTheReasonOfThePlainTransferWhereThatFailsToo) {
  StartReading();
  Answer("583#8001200201000405");
  Answer("583#8001200200000206");
  ExpectFailure(SdoAbort::kNoSuchObject);
}

TEST_F(SdoBlockTest, ReadsABlockAndChecksItsChecksum) {
  EXPECT_EQ(StartReading(), (Texts{"603#A40120027F000000"}));
  EXPECT_EQ(Answer("583#C601200209000000"), (Texts{"603#A300000000000000"}));
  EXPECT_EQ(Answer("583#0131323334353637"), Texts{});
  EXPECT_EQ(Answer("583#8238390000000000"), (Texts{"603#A2027F0000000000"}));
  EXPECT_EQ(Answer("583#D5C3310000000000"), (Texts{"603#A100000000000000"}));
  ASSERT_EQ(client_.state(), State::kDone);
  EXPECT_EQ(Read(), kDigits);
}

TEST_F(SdoBlockTest, TakesNoBlockWithAWrongChecksum) {
  StartReading();
  Answer("583#C601200209000000");
  Answer("583#0131323334353637");
  Answer("583#8238390000000000");
  EXPECT_EQ(Answer("583#D5C2310000000000"), (Texts{"603#8001200204000405"}));
  ExpectFailure(SdoAbort::kCrcError);
}

TEST_F(SdoBlockTest, TakesNoBlockOfAnotherLengthThanAnnounced) {
  StartReading();
  Answer("583#C60120020A000000");
  Answer("583#0131323334353637");
  Answer("583#8238390000000000");
  Answer("583#D5C3310000000000");
  ExpectFailure(SdoAbort::kLengthMismatch);
}

TEST_F(SdoBlockTest, AsksAgainForASegmentThatWasLostInShorterBlocks) {
  StartReading();
  Answer("583#C20120021C000000");  // 28 bytes, no checksum
  Answer("583#0101020304050607");
  Answer("583#030F101112131415");  // the second is lost
  EXPECT_EQ(Answer("583#84161718191A1B1C"), (Texts{"603#A201400000000000"}));
  Answer("583#0108090A0B0C0D0E");
  Answer("583#020F101112131415");
  EXPECT_EQ(Answer("583#83161718191A1B1C"), (Texts{"603#A203400000000000"}));
  Answer("583#C100000000000000");
  EXPECT_EQ(Read(), Counting(28));
}

TEST_F(SdoBlockTest, RemindsTheNodeOnceWhenTheLastSegmentIsLost) {
  StartReading();
  Answer("583#C601200209000000");
  Answer("583#0131323334353637");
  now_ += 100ms;
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#A201400000000000"}));
  EXPECT_EQ(Answer("583#8138390000000000"), (Texts{"603#A201400000000000"}));
  Answer("583#D5C3310000000000");
  EXPECT_EQ(Read(), kDigits);

  StartReading();
  Answer("583#C601200209000000");
  now_ += 100ms;
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#A200400000000000"}));
  now_ += 100ms;
  EXPECT_EQ(Sent(client_, now_), (Texts{"603#8001200200000405"}));
  ExpectFailure(SdoAbort::kTimedOut);
}

TEST_F(SdoBlockTest, GivesUpOnASegmentNumberThatIsNone) {
  StartReading();
  Answer("583#C601200209000000");
  Answer("583#0031323334353637");
  ExpectFailure(SdoAbort::kInvalidSequenceNumber);
}

TEST_F(SdoBlockTest, TakesAnAbortInTheMiddleOfABlock) {
  StartReading();
  Answer("583#C601200209000000");
  Answer("583#0131323334353637");
  Answer("583#8001200200000606");
  ExpectFailure(SdoAbort::kHardwareError);
  EXPECT_TRUE(client_.failure().by_node);
}

// Round trip through a slave of a few lines that loses the segments it is told to.
TEST_F(SdoBlockTest, ReadsMuchOverABusThatLosesSegments) {
  const Bytes all = Counting(3000);
  StartReading();
  std::size_t acknowledged = 0;
  Texts answer = Answer("583#C2012002B80B0000");
  int sent = 0;
  for (int block = 0; acknowledged < all.size() && block < 200; ++block) {
    const std::size_t size =
        block == 0 ? 127 : static_cast<std::size_t>(std::stoul(answer.at(0).substr(8, 2), nullptr, 16));
    answer.clear();
    for (std::size_t i = 0; i < size && acknowledged + 7 * i < all.size(); ++i) {
      CanFrame frame{.id = 0x583, .length = 8};
      const std::size_t at = acknowledged + 7 * i;
      const bool is_last = at + 7 >= all.size();
      frame.data[0] = static_cast<std::uint8_t>((i + 1) | (is_last ? 0x80 : 0));
      for (std::size_t k = 0; k < 7 && at + k < all.size(); ++k) frame.data[k + 1] = all[at + k];
      const bool ends_block = is_last || i + 1 == size;
      if (++sent % 10 == 0 && !ends_block) continue;  // lost
      client_.OnFrame(frame, now_);
    }
    answer = Sent(client_, now_);
    ASSERT_EQ(answer.size(), 1U);
    acknowledged += 7 * std::stoul(answer[0].substr(6, 2), nullptr, 16);
  }
  Answer("583#CD00000000000000");  // 3000 = 428 * 7 + 4, so that three of the last bytes are unused
  EXPECT_EQ(Read(), all);
  EXPECT_GT(sent, 440);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::sdo_block_test
