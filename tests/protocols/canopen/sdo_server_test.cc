// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/sdo_server.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/protocols/canopen/frames_by_hand.h"

namespace strainwave::protocols::canopen::device::sdo_server_test {
namespace {

using std::chrono::milliseconds;

EdsFile Objects() {
  EdsFile eds;
  eds.objects[{0x1000, 0}] = {"type", DataType::kUnsigned32, AccessType::kConstant, false, "0x00020192", "",
                              ""};
  eds.objects[{0x1008, 0}] = {"name", DataType::kVisibleString, AccessType::kReadOnly, false, "Invented", "",
                              ""};
  eds.objects[{0x1017, 0}] = {"heartbeat", DataType::kUnsigned16, AccessType::kReadWrite, false, "500", "",
                              "1000"};
  eds.objects[{0x2003, 0}] = {"notes", DataType::kDomain, AccessType::kReadWrite, false, "", "", ""};
  eds.objects[{0x2005, 0}] = {"wide", DataType::kUnsigned64, AccessType::kReadWrite, false, "1", "", ""};
  return eds;
}

class SdoServerTest : public testing::Test {
 protected:
  // The frames that answer this one.
  std::string Ask(std::string_view request) {
    server.OnFrame(ByHand(request), now);
    return AllOf(server);
  }
  void SetNotes(const std::string& text) { objects.At({0x2003, 0}).SetText(text); }
  std::string_view Notes() { return objects.At({0x2003, 0}).text(); }

  ObjectDictionary objects{Objects(), 1};
  SdoServer server{objects, 1};
  std::chrono::nanoseconds now{};
};

TEST(BlockChecksum, GivesTheCheckValueOfTheStandard) {
  const std::string digits = "123456789";
  const std::vector<std::uint8_t> bytes(digits.begin(), digits.end());
  EXPECT_EQ(BlockChecksum(bytes), 0x31C3);
}

TEST_F(SdoServerTest, ReadsShortValuesInOneFrame) {
  EXPECT_EQ(Ask("601#40 00 10 00 00 00 00 00"), "581#43 00 10 00 92 01 02 00");
  EXPECT_EQ(Ask("601#40 17 10 00 00 00 00 00"), "581#4B 17 10 00 F4 01 00 00");
}

TEST_F(SdoServerTest, WritesShortValuesInOneFrame) {
  EXPECT_EQ(Ask("601#2B 17 10 00 64 00 00 00"), "581#60 17 10 00 00 00 00 00");
  EXPECT_EQ(objects.Integer({0x1017, 0}), 100);
  // The size is not told: the object's own.
  EXPECT_EQ(Ask("601#22 17 10 00 65 00 00 00"), "581#60 17 10 00 00 00 00 00");
  EXPECT_EQ(objects.Integer({0x1017, 0}), 101);
}

TEST_F(SdoServerTest, AbortsWithTheObjectAndTheReason) {
  EXPECT_EQ(Ask("601#40 99 10 00 00 00 00 00"), "581#80 99 10 00 00 00 02 06");  // no such object
  EXPECT_EQ(Ask("601#40 00 10 05 00 00 00 00"), "581#80 00 10 05 11 00 09 06");  // no such sub-index
  EXPECT_EQ(Ask("601#23 00 10 00 01 00 00 00"), "581#80 00 10 00 02 00 01 06");  // read only
  EXPECT_EQ(Ask("601#23 17 10 00 01 00 00 00"), "581#80 17 10 00 12 00 07 06");  // too long
  EXPECT_EQ(Ask("601#2F 17 10 00 01 00 00 00"), "581#80 17 10 00 13 00 07 06");  // too short
  EXPECT_EQ(Ask("601#2B 17 10 00 E9 03 00 00"), "581#80 17 10 00 31 00 09 06");  // above 1000
  EXPECT_EQ(objects.Integer({0x1017, 0}), 500);
}

TEST_F(SdoServerTest, ReadsSegmentBySegment) {
  EXPECT_EQ(Ask("601#40 08 10 00 00 00 00 00"), "581#41 08 10 00 08 00 00 00");
  EXPECT_EQ(Ask("601#60 00 00 00 00 00 00 00"), "581#00 49 6E 76 65 6E 74 65");  // Invente
  EXPECT_EQ(Ask("601#70 00 00 00 00 00 00 00"), "581#1D 64 00 00 00 00 00 00");  // d, six bytes unused, last
  EXPECT_EQ(Ask("601#60 00 00 00 00 00 00 00"), "581#80 08 10 00 01 00 04 05");
}

TEST_F(SdoServerTest, ReadsAnEmptyText) {
  EXPECT_EQ(Ask("601#40 03 20 00 00 00 00 00"), "581#41 03 20 00 00 00 00 00");
  EXPECT_EQ(Ask("601#60 00 00 00 00 00 00 00"), "581#0F 00 00 00 00 00 00 00");
}

TEST_F(SdoServerTest, WritesSegmentBySegment) {
  EXPECT_EQ(Ask("601#21 03 20 00 09 00 00 00"), "581#60 03 20 00 00 00 00 00");
  EXPECT_EQ(Ask("601#00 31 32 33 34 35 36 37"), "581#20 00 00 00 00 00 00 00");
  EXPECT_EQ(Ask("601#1B 38 39 00 00 00 00 00"), "581#30 00 00 00 00 00 00 00");
  EXPECT_EQ(Notes(), "123456789");
  // Eight bytes of a number come that way, too; this client does not say how many there will be.
  EXPECT_EQ(Ask("601#20 05 20 00 00 00 00 00"), "581#60 05 20 00 00 00 00 00");
  EXPECT_EQ(Ask("601#00 01 02 03 04 05 06 07"), "581#20 00 00 00 00 00 00 00");
  EXPECT_EQ(Ask("601#1D 08 00 00 00 00 00 00"), "581#30 00 00 00 00 00 00 00");
  EXPECT_EQ(objects.Integer({0x2005, 0}), 0x0807060504030201);
}

TEST_F(SdoServerTest, GivesUpWhenTheToggleBitStandsStill) {
  Ask("601#21 03 20 00 0E 00 00 00");
  Ask("601#00 31 32 33 34 35 36 37");
  EXPECT_EQ(Ask("601#00 31 32 33 34 35 36 37"), "581#80 03 20 00 00 00 03 05");
  Ask("601#40 08 10 00 00 00 00 00");
  EXPECT_EQ(Ask("601#70 00 00 00 00 00 00 00"), "581#80 08 10 00 00 00 03 05");
  EXPECT_EQ(Notes(), "");
}

TEST_F(SdoServerTest, TakesNoMoreAndNoLessThanWasAnnounced) {
  Ask("601#21 03 20 00 08 00 00 00");
  EXPECT_EQ(Ask("601#01 31 32 33 34 35 36 37"), "581#80 03 20 00 13 00 07 06");
  Ask("601#21 03 20 00 06 00 00 00");
  EXPECT_EQ(Ask("601#01 31 32 33 34 35 36 37"), "581#80 03 20 00 12 00 07 06");
  EXPECT_EQ(Ask("601#21 03 20 00 00 00 00 7F"), "581#80 03 20 00 05 00 04 05");
}

TEST_F(SdoServerTest, AbortsAClientThatLetsATransferWait) {
  Ask("601#21 03 20 00 09 00 00 00");
  now = milliseconds(1000);
  server.Poll(now);
  EXPECT_EQ(AllOf(server), "");
  now = milliseconds(1001);
  server.Poll(now);
  EXPECT_EQ(AllOf(server), "581#80 03 20 00 00 00 04 05");
  server.Poll(milliseconds(9000));
  EXPECT_EQ(AllOf(server), "");
}

TEST_F(SdoServerTest, EndsATransferThatTheClientAborts) {
  Ask("601#21 03 20 00 09 00 00 00");
  EXPECT_EQ(Ask("601#80 03 20 00 00 00 00 08"), "");
  EXPECT_EQ(Ask("601#00 31 32 33 34 35 36 37"), "581#80 03 20 00 01 00 04 05");
}

TEST_F(SdoServerTest, PassesOverWhatIsNoRequestToIt) {
  EXPECT_EQ(Ask("602#40 00 10 00 00 00 00 00"), "");
  EXPECT_EQ(Ask("601#40 00 10 00"), "");
  CanFrame remote = ByHand("601#40 00 10 00 00 00 00 00");
  remote.remote = true;
  EXPECT_FALSE(server.OnFrame(remote, now));
  EXPECT_EQ(Ask("601#E0 00 10 00 00 00 00 00"), "581#80 00 00 00 01 00 04 05");  // no such command
}

TEST_F(SdoServerTest, TakesABlock) {
  // 9 bytes, with the checksum of the standard's example.
  EXPECT_EQ(Ask("601#C6 03 20 00 09 00 00 00"), "581#A4 03 20 00 7F 00 00 00");
  EXPECT_EQ(Ask("601#01 31 32 33 34 35 36 37"), "");
  EXPECT_EQ(Ask("601#82 38 39 00 00 00 00 00"), "581#A2 02 7F 00 00 00 00 00");
  EXPECT_EQ(Ask("601#D5 C3 31 00 00 00 00 00"), "581#A1 00 00 00 00 00 00 00");
  EXPECT_EQ(Notes(), "123456789");
}

TEST_F(SdoServerTest, RefusesABlockWithAWrongChecksum) {
  Ask("601#C6 03 20 00 09 00 00 00");
  Ask("601#01 31 32 33 34 35 36 37");
  Ask("601#82 38 39 00 00 00 00 00");
  EXPECT_EQ(Ask("601#D5 C3 32 00 00 00 00 00"), "581#80 03 20 00 04 00 04 05");
  EXPECT_EQ(Notes(), "");
}

TEST_F(SdoServerTest, AsksForABlocksSegmentsAgainFromTheFirstThatWasLost) {
  Ask("601#C6 03 20 00 10 00 00 00");
  Ask("601#01 41 41 41 41 41 41 41");
  EXPECT_EQ(Ask("601#83 43 43 00 00 00 00 00"), "581#A2 01 7F 00 00 00 00 00");  // 2 was lost
  EXPECT_EQ(Ask("601#01 42 42 42 42 42 42 42"), "");
  EXPECT_EQ(Ask("601#82 43 43 00 00 00 00 00"), "581#A2 02 7F 00 00 00 00 00");
  const std::string text = "AAAAAAABBBBBBBCC";
  const std::uint16_t checksum = BlockChecksum(std::vector<std::uint8_t>(text.begin(), text.end()));
  CanFrame end = ByHand("601#D5 00 00 00 00 00 00 00");
  end.data[1] = static_cast<std::uint8_t>(checksum & 0xFF);
  end.data[2] = static_cast<std::uint8_t>(checksum >> 8);
  server.OnFrame(end, now);
  EXPECT_EQ(AllOf(server), "581#A1 00 00 00 00 00 00 00");
  EXPECT_EQ(Notes(), text);
}

TEST_F(SdoServerTest, GivesABlockAndItsChecksum) {
  SetNotes("123456789");
  EXPECT_EQ(Ask("601#A4 03 20 00 7F 00 00 00"), "581#C6 03 20 00 09 00 00 00");
  EXPECT_EQ(Ask("601#A3 00 00 00 00 00 00 00"), "581#01 31 32 33 34 35 36 37\n581#82 38 39 00 00 00 00 00");
  EXPECT_EQ(Ask("601#A2 02 7F 00 00 00 00 00"), "581#D5 C3 31 00 00 00 00 00");
  EXPECT_EQ(Ask("601#A1 00 00 00 00 00 00 00"), "");
  EXPECT_EQ(Ask("601#A1 00 00 00 00 00 00 00"), "581#80 03 20 00 01 00 04 05");
}

TEST_F(SdoServerTest, GivesBlocksOfTheSizeAskedForAndAgainWhatWasLost) {
  std::string text;
  for (char c = 1; c <= 7 * 5; ++c) text.push_back(c);
  SetNotes(text);
  Ask("601#A0 03 20 00 02 00 00 00");
  EXPECT_EQ(Ask("601#A3 00 00 00 00 00 00 00"), "581#01 01 02 03 04 05 06 07\n581#02 08 09 0A 0B 0C 0D 0E");
  // The second was lost; four a block from here.
  EXPECT_EQ(Ask("601#A2 01 04 00 00 00 00 00"),
            "581#01 08 09 0A 0B 0C 0D 0E\n581#02 0F 10 11 12 13 14 15\n581#03 16 17 18 19 1A 1B 1C\n"
            "581#84 1D 1E 1F 20 21 22 23");
  EXPECT_EQ(Ask("601#A2 03 04 00 00 00 00 00"), "581#81 1D 1E 1F 20 21 22 23");
  EXPECT_EQ(Ask("601#A2 01 04 00 00 00 00 00"), "581#C1 00 00 00 00 00 00 00");  // no checksum was asked for
}

TEST_F(SdoServerTest, FallsBackToTheOrdinaryTransferWhereTheClientWouldHaveIt) {
  SetNotes("123456789");
  EXPECT_EQ(Ask("601#A4 03 20 00 7F 09 00 00"), "581#41 03 20 00 09 00 00 00");
  EXPECT_EQ(Ask("601#A4 03 20 00 7F 08 00 00"), "581#C6 03 20 00 09 00 00 00");
  EXPECT_EQ(Ask("601#A4 00 10 00 7F 04 00 00"), "581#43 00 10 00 92 01 02 00");
}

TEST_F(SdoServerTest, RefusesBlocksThatCannotBe) {
  EXPECT_EQ(Ask("601#A4 03 20 00 00 00 00 00"), "581#80 03 20 00 02 00 04 05");
  EXPECT_EQ(Ask("601#A4 03 20 00 80 00 00 00"), "581#80 03 20 00 02 00 04 05");
  EXPECT_EQ(Ask("601#A4 99 20 00 7F 00 00 00"), "581#80 99 20 00 00 00 02 06");
  EXPECT_EQ(Ask("601#C6 00 10 00 04 00 00 00"), "581#80 00 10 00 02 00 01 06");
  EXPECT_EQ(Ask("601#D5 C3 31 00 00 00 00 00"), "581#80 00 10 00 01 00 04 05");
  EXPECT_EQ(Ask("601#A3 00 00 00 00 00 00 00"), "581#80 00 10 00 01 00 04 05");
  SetNotes("123456789");
  Ask("601#A4 03 20 00 7F 00 00 00");
  Ask("601#A3 00 00 00 00 00 00 00");
  EXPECT_EQ(Ask("601#A2 03 7F 00 00 00 00 00"), "581#80 03 20 00 03 00 04 05");
  Ask("601#C6 03 20 00 09 00 00 00");
  EXPECT_EQ(Ask("601#00 31 32 33 34 35 36 37"), "581#80 03 20 00 03 00 04 05");
}

TEST_F(SdoServerTest, MovesLongDomainsBitForBit) {
  std::vector<std::uint8_t> bytes(ObjectDictionary::kMostBytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i >> 5U & 0xFFU);
  ASSERT_EQ(objects.Write({0x2003, 0}, bytes), std::nullopt);
  std::vector<std::uint8_t> received;
  Ask("601#A4 03 20 00 7F 00 00 00");
  server.OnFrame(ByHand("601#A3 00 00 00 00 00 00 00"), now);
  CanFrame frame;
  int left = 9363 + 1;  // segments and the end
  while (server.Next(frame) && --left > 0) {
    received.insert(received.end(), frame.data.begin() + 1, frame.data.end());
    if ((frame.data[0] & 0x7FU) != 127 && frame.data[0] < 0x80) continue;
    CanFrame receipt = ByHand("601#A2 00 7F 00 00 00 00 00");
    receipt.data[1] = frame.data[0] & 0x7FU;
    server.OnFrame(receipt, now);
  }
  // 65536 = 7 * 9362 + 2: five bytes of the last segment are unused.
  ASSERT_EQ(frame.data[0], 0xC1 | 5 << 2);
  ASSERT_EQ(received.size(), bytes.size() + 5);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), received.begin()));
}

}  // namespace
}  // namespace strainwave::protocols::canopen::device::sdo_server_test
