// SPDX-License-Identifier: Apache-2.0
#include "protocols/hid_report.h"

#include <gtest/gtest.h>

#include <vector>

namespace strainwave::protocols::hid_report_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

HidField Field(unsigned first_bit, unsigned bits, bool is_signed, std::size_t length = 4) {
  HidField field;
  field.report_length = length;
  field.first_bit = first_bit;
  field.bits = bits;
  field.is_signed = is_signed;
  return field;
}

TEST(TakeField, CountsBitsFromTheLowestOfTheFirstByte) {
  const Bytes report{0x21, 0x43, 0x65, 0x87};  // 0x87654321, lowest byte first
  EXPECT_EQ(TakeField(Field(0, 32, false), report).value, 0x87654321);
  EXPECT_EQ(TakeField(Field(0, 32, true), report).value, -2023406815);
  EXPECT_EQ(TakeField(Field(0, 1, false), report).value, 1);
  EXPECT_EQ(TakeField(Field(5, 1, false), report).value, 1);
  EXPECT_EQ(TakeField(Field(4, 12, false), report).value, 0x432);
  EXPECT_EQ(TakeField(Field(20, 12, false), report).value, 0x876);
  EXPECT_EQ(TakeField(Field(20, 12, true), report).value, 0x876 - 0x1000);
  EXPECT_EQ(TakeField(Field(31, 1, true), report).value, -1);
}

TEST(TakeField, TakesTheThermometersNumberHighByteFirst) {
  HidField field = Field(16, 16, true, 8);
  field.high_byte_first = true;
  field.scale = 1.0 / 256;
  EXPECT_EQ(TakeField(field, Bytes{0x80, 0x02, 0x17, 0x80, 0, 0, 0, 0}).value, 23.5);
  EXPECT_EQ(TakeField(field, Bytes{0x80, 0x02, 0xFF, 0x40, 0, 0, 0, 0}).value, -0.75);
}

TEST(TakeField, RefusesOtherReportsAndLengths) {
  HidField field = Field(8, 8, false, 3);
  field.report_id = 7;
  EXPECT_EQ(TakeField(field, Bytes{7, 5, 0}).value, 5);
  EXPECT_EQ(TakeField(field, Bytes{8, 5, 0}).problem, HidProblem::kOtherReport);
  EXPECT_EQ(TakeField(field, Bytes{}).problem, HidProblem::kOtherReport);
  EXPECT_EQ(TakeField(field, Bytes{7, 5}).problem, HidProblem::kWrongLength);
  EXPECT_EQ(TakeField(field, Bytes{7, 5, 0, 0}).problem, HidProblem::kWrongLength);
  EXPECT_EQ(TakeField(Field(0, 8, false), Bytes{}).problem, HidProblem::kWrongLength);
  field.most = 4;
  EXPECT_EQ(TakeField(field, Bytes{7, 5, 0}).problem, HidProblem::kOutOfRange);
}

TEST(CheckField, SaysWhatCannotBe) {
  EXPECT_EQ(CheckField(Field(0, 32, false)), "");
  EXPECT_EQ(CheckField(Field(0, 33, false)), "bits is out of range (expected 1 to 32)");
  EXPECT_EQ(CheckField(Field(0, 0, false)), "bits is out of range (expected 1 to 32)");
  EXPECT_EQ(CheckField(Field(25, 8, false)),
            "the number ends beyond the report (expected bits within report_length)");
  HidField numbered = Field(7, 8, false);
  numbered.report_id = 1;
  EXPECT_EQ(CheckField(numbered), "the number lies over the report's id (expected first_bit of 8 or more)");
  HidField swapped = Field(4, 16, false);
  swapped.high_byte_first = true;
  EXPECT_EQ(CheckField(swapped),
            "the high byte comes first in a number that is not whole bytes (expected multiples of 8 bits)");
  HidField scale = Field(0, 8, false);
  scale.scale = 0;
  EXPECT_EQ(CheckField(scale), "scale or offset is not usable (expected finite numbers, the scale not zero)");
}

TEST(ChangesOf, TellsKeysThatGoDownFromThoseThatComeUp) {
  EXPECT_EQ(ChangesOf(0b0011, 0b0110).pressed, 0b0100U);
  EXPECT_EQ(ChangesOf(0b0011, 0b0110).released, 0b0001U);
}

}  // namespace
}  // namespace strainwave::protocols::hid_report_test
