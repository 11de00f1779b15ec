// SPDX-License-Identifier: Apache-2.0
#include "protocols/candump.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace strainwave::protocols::candump_test {
namespace {

using std::chrono::microseconds;

// Lines that candump of can-utils 2020.11 printed with -L (the ids, lengths and flags of frames sent to it
// by cansend), and what they mean.
struct Line {
  const char* text;
  LoggedFrame logged;
};
const Line kLines[] = {
    {"(1436509052.249713) vcan0 123#DEADBEEF",
     {microseconds(1436509052249713), "vcan0", {0x123, false, false, false, 4, {0xDE, 0xAD, 0xBE, 0xEF}}}},
    {"(1436509052.000001) can1 000#", {microseconds(1436509052000001), "can1", {}}},
    {"(0000000007.000000) vcan0 7FF#R", {microseconds(7000000), "vcan0", {0x7FF, false, true}}},
    {"(0000000007.999999) vcan0 1F334455#R8",
     {microseconds(7999999), "vcan0", {0x1F334455, true, true, false, 8}}},
    {"(0000000007.000000) vcan0 00000123#1122334455667788",
     {microseconds(7000000),
      "vcan0",
      {0x123, true, false, false, 8, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x88}}}},
    {"(0000000007.000000) vcan0 20000004#000C000000000000",
     {microseconds(7000000), "vcan0", {0x4, false, false, true, 8, {0x00, 0x0C}}}},
};

TEST(CandumpLine, PrintsWhatCandumpPrints) {
  for (const Line& line : kLines) EXPECT_EQ(CandumpLine(line.logged), line.text);
}

TEST(ParseCandump, ReadsWhatCandumpPrints) {
  for (const Line& line : kLines) {
    const std::vector<LoggedFrame> read = ParseCandump(line.text, "bus.log");
    ASSERT_EQ(read.size(), 1U) << line.text;
    EXPECT_EQ(read[0], line.logged) << line.text;
  }
}

TEST(ParseCandump, ReadsLinesOfEitherEndAndPassesOverEmptyOnes) {
  const auto read =
      ParseCandump("(0000000001.000000) vcan0 001#aB\r\n\n(0000000002.000000) vcan0 002#\n", "x");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].frame.data[0], 0xAB);
  EXPECT_EQ(read[1].time, std::chrono::seconds(2));
}

std::string Findings(const std::string& text) {
  try {
    ParseCandump(text, "bus.log");
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(ParseCandump, SaysWhereALineIsWrongAndWhatWasExpected) {
  const std::string time = "(1436509052.249713) ";
  EXPECT_EQ(Findings("vcan0 123#00"),
            "bus.log:1:1: error: not a time (expected '(SECONDS.MICROSECONDS)' with six decimals)");
  EXPECT_EQ(Findings("(1436509052.2497) vcan0 123#00"),
            "bus.log:1:1: error: not a time (expected '(SECONDS.MICROSECONDS)' with six decimals)");
  EXPECT_EQ(Findings("(99999999999999999999.000000) vcan0 123#00"),
            "bus.log:1:1: error: not a time (expected '(SECONDS.MICROSECONDS)' with six decimals)");
  EXPECT_EQ(Findings("(1436509052.249713)vcan0 123#00"), "bus.log:1:20: error: no space after the time");
  EXPECT_EQ(Findings(time + "123#00"),
            "bus.log:1:21: error: no name of an interface (expected 1 to 15 characters and a space)");
  EXPECT_EQ(
      Findings(time + "vcan0 1234#00"),
      "bus.log:1:27: error: an id of 4 hexadecimal digits (expected 3, or 8 of an extended or error frame)");
  EXPECT_EQ(Findings(time + "vcan0 800#00"),
            "bus.log:1:27: error: id 800 has more than 11 bits (expected up to 7FF)");
  EXPECT_EQ(Findings(time + "vcan0 40000000#00"),
            "bus.log:1:27: error: id 40000000 has more than 29 bits (expected up to 1FFFFFFF)");
  EXPECT_EQ(Findings(time + "vcan0 E0000000#00"),
            "bus.log:1:27: error: id E0000000 of an error frame (expected 20000000 to 3FFFFFFF)");
  EXPECT_EQ(Findings(time + "vcan0 123"), "bus.log:1:30: error: no '#' after the id");
  EXPECT_EQ(Findings(time + "vcan0 123##1AABB"),
            "bus.log:1:31: error: a CAN FD frame (expected a classical one: a single '#')");
  EXPECT_EQ(Findings(time + "vcan0 123#ABC"),
            "bus.log:1:31: error: 3 digits of data (expected two a byte, up to 8 bytes)");
  EXPECT_EQ(Findings(time + "vcan0 123#112233445566778899"),
            "bus.log:1:31: error: 18 digits of data (expected two a byte, up to 8 bytes)");
  EXPECT_EQ(Findings(time + "vcan0 123#11 T"),
            "bus.log:1:33: error: text after the frame (expected the end of the line)");
  EXPECT_EQ(Findings(time + "vcan0 123#R9"),
            "bus.log:1:32: error: text after the frame (expected the end of the line)");
  EXPECT_EQ(Findings(time + "vcan0 20000004#R"),
            "bus.log:1:36: error: an error frame cannot be a remote one (expected data)");
}

TEST(ParseCandump, TellsOfEveryBadLineAtOnce) {
  EXPECT_EQ(Findings("x\n(0000000001.000000) vcan0 001#\n(0000000001.000000) vcan0 001\n"),
            "bus.log:1:1: error: not a time (expected '(SECONDS.MICROSECONDS)' with six decimals)\n"
            "bus.log:3:30: error: no '#' after the id");
}

}  // namespace
}  // namespace strainwave::protocols::candump_test
