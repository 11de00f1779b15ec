// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/emergency.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/protocols/canopen/frames.h"

namespace strainwave::protocols::canopen::emergency_test {
namespace {

// Point 9: the five bytes of the maker are kept.
TEST(EmergencyOf, KeepsCodeRegisterAndTheMakersFiveBytes) {
  const auto emergency = EmergencyOf(Frame("083#1186210102030405"));
  ASSERT_TRUE(emergency.has_value());
  EXPECT_EQ(*emergency, (Emergency{3, 0x8611, 0x21, {1, 2, 3, 4, 5}}));
  EXPECT_EQ(
      Words(*emergency),
      "node 3 reports 8611h: following error too large (error register 21h, maker's bytes 01 02 03 04 05)");
  EXPECT_FALSE(emergency->is_reset());
  EXPECT_TRUE(EmergencyOf(Frame("083#0000000000000000"))->is_reset());
  EXPECT_TRUE(EmergencyOf(Frame("083#1200000000000000"))->is_reset());  // 00xxh
}

TEST(EmergencyOf, TakesNothingElseForAnEmergency) {
  for (const char* text : {"080#1186210102030405", "100#1186210102030405", "083#11862101020304", "083#",
                           "183#1186210102030405"}) {
    EXPECT_FALSE(EmergencyOf(Frame(text)).has_value()) << text;
  }
  EXPECT_EQ(EmergencyOf(Frame("0FF#1186210102030405"))->node_id, 127);
  CanFrame frame = Frame("083#1186210102030405");
  frame.remote = true;
  EXPECT_FALSE(EmergencyOf(frame).has_value());
}

TEST(ErrorCodeWords, TellsApartWhatTheBusAndTheDriveReport) {
  std::set<std::string_view> words;
  const std::uint16_t codes[] = {0x8110, 0x8120, 0x8130, 0x8140, 0x8150, 0x8210, 0x8220, 0x8240,
                                 0x8250, 0x2310, 0x2320, 0x3210, 0x3220, 0x4210, 0x4310, 0x5400,
                                 0x5441, 0x7121, 0x7122, 0x7305, 0x8611, 0x9000, 0xFF00};
  for (const std::uint16_t code : codes) words.insert(ErrorCodeWords(code));
  EXPECT_EQ(words.size(), std::size(codes));
  EXPECT_EQ(ErrorCodeWords(0x3210), "DC link over-voltage");
  EXPECT_EQ(ErrorCodeWords(0x8140), "recovered from bus-off");
}

TEST(ErrorCodeWords, SpeaksOfTheGroupAndTheClassWhereACodeIsNotListed) {
  EXPECT_EQ(ErrorCodeWords(0x2312), ErrorCodeWords(0x2310));
  EXPECT_EQ(ErrorCodeWords(0x2390), "current on the motor side");
  EXPECT_EQ(ErrorCodeWords(0x2A00), "current");
  EXPECT_EQ(ErrorCodeWords(0xFF17), "maker's own error");
  EXPECT_EQ(ErrorCodeWords(0xA000), "a code that neither CiA 301 nor CiA 402 knows");
  for (unsigned code = 0; code <= 0xFFFF; ++code) {
    ASSERT_FALSE(ErrorCodeWords(static_cast<std::uint16_t>(code)).empty());
  }
}

}  // namespace
}  // namespace strainwave::protocols::canopen::emergency_test
