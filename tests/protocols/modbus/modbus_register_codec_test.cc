// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/register_codec.h"

#include <gtest/gtest.h>
#include <modbus.h>

#include <cmath>
#include <limits>
#include <vector>

namespace strainwave::protocols::modbus::modbus_register_codec_test {
namespace {

using Words = std::vector<std::uint16_t>;
constexpr WordOrder kWordOrders[] = {WordOrder::kHighFirst, WordOrder::kLowFirst};
constexpr ByteOrder kByteOrders[] = {ByteOrder::kHighFirst, ByteOrder::kLowFirst};

Register Of(ValueType type, WordOrder words = WordOrder::kHighFirst,
            ByteOrder bytes = ByteOrder::kHighFirst) {
  Register value;
  value.type = type;
  value.word_order = words;
  value.byte_order = bytes;
  return value;
}

Words WordsOf(const Encoded& encoded) { return {encoded.span().begin(), encoded.span().end()}; }

// The bytes A B C D of a value, A the highest, as devices are said to send them.
struct Case {
  ValueType type;
  double value;
  WordOrder word_order;
  ByteOrder byte_order;
  Words words;
};
constexpr auto kHigh = WordOrder::kHighFirst;
constexpr auto kLow = WordOrder::kLowFirst;
constexpr auto kBig = ByteOrder::kHighFirst;
constexpr auto kLittle = ByteOrder::kLowFirst;
const Case kCases[] = {
    {ValueType::kInt16, -2, kHigh, kBig, {0xFFFE}},
    {ValueType::kInt16, -2, kHigh, kLittle, {0xFEFF}},
    {ValueType::kUint16, 0x1234, kHigh, kBig, {0x1234}},
    {ValueType::kUint16, 0x1234, kLow, kLittle, {0x3412}},
    {ValueType::kInt32, -2, kHigh, kBig, {0xFFFF, 0xFFFE}},
    {ValueType::kInt32, -2, kLow, kBig, {0xFFFE, 0xFFFF}},
    {ValueType::kInt32, -2, kHigh, kLittle, {0xFFFF, 0xFEFF}},
    {ValueType::kInt32, -2, kLow, kLittle, {0xFEFF, 0xFFFF}},
    {ValueType::kUint32, 0x89ABCDEF, kHigh, kBig, {0x89AB, 0xCDEF}},     // ABCD
    {ValueType::kUint32, 0x89ABCDEF, kLow, kBig, {0xCDEF, 0x89AB}},      // CDAB
    {ValueType::kUint32, 0x89ABCDEF, kHigh, kLittle, {0xAB89, 0xEFCD}},  // BADC
    {ValueType::kUint32, 0x89ABCDEF, kLow, kLittle, {0xEFCD, 0xAB89}},   // DCBA
    {ValueType::kFloat32, -12.5, kHigh, kBig, {0xC148, 0x0000}},         // sign, 2^3, 1.5625
    {ValueType::kFloat32, -12.5, kLow, kBig, {0x0000, 0xC148}},
    {ValueType::kFloat32, -12.5, kHigh, kLittle, {0x48C1, 0x0000}},
    {ValueType::kFloat32, -12.5, kLow, kLittle, {0x0000, 0x48C1}},
    {ValueType::kBit, 1, kHigh, kLittle, {1}},
};

TEST(RegisterCodec, KnowsEveryTypeInEveryOrderBothWays) {
  for (const Case& wanted : kCases) {
    const Register value = Of(wanted.type, wanted.word_order, wanted.byte_order);
    const Decoded decoded = Decode(value, wanted.words);
    EXPECT_EQ(decoded.problem, CodecProblem::kNone);
    EXPECT_EQ(decoded.value, wanted.value);
    EXPECT_EQ(WordsOf(Encode(value, wanted.value)), wanted.words) << wanted.value;
  }
}

TEST(RegisterCodec, ReadsFloatsAsLibmodbusDoes) {
  for (unsigned seed = 0; seed < 10'000; ++seed) {
    const std::uint16_t words[] = {static_cast<std::uint16_t>(seed * 40503U >> 3),
                                   static_cast<std::uint16_t>(seed * 31337U)};
    const std::pair<Register, float> pairs[] = {
        {Of(ValueType::kFloat32, kHigh, kBig), modbus_get_float_abcd(words)},
        {Of(ValueType::kFloat32, kLow, kBig), modbus_get_float_cdab(words)},
        {Of(ValueType::kFloat32, kHigh, kLittle), modbus_get_float_badc(words)},
        {Of(ValueType::kFloat32, kLow, kLittle), modbus_get_float_dcba(words)}};
    for (const auto& [value, theirs] : pairs) {
      const Decoded ours = Decode(value, words);
      if (std::isfinite(theirs)) {
        EXPECT_EQ(ours.value, static_cast<double>(theirs));
      } else {
        EXPECT_EQ(ours.problem, CodecProblem::kNotFinite);
      }
    }
  }
}

TEST(RegisterCodec, ScalesAndShifts) {
  Register value = Of(ValueType::kInt16);
  value.scale = 0.1;
  value.offset = -40.0;
  const std::uint16_t words[] = {655};
  EXPECT_DOUBLE_EQ(Decode(value, words).value, 25.5);
  EXPECT_EQ(WordsOf(Encode(value, 25.5)), Words{655});
  EXPECT_EQ(WordsOf(Encode(value, 25.54)), Words{655}) << "the nearest";
  EXPECT_EQ(WordsOf(Encode(value, 25.56)), Words{656});
}

TEST(RegisterCodec, TakesTheWholeRangeOfATypeAndNothingBeyond) {
  const std::tuple<ValueType, double, double> ranges[] = {{ValueType::kInt16, -32768, 32767},
                                                          {ValueType::kUint16, 0, 65535},
                                                          {ValueType::kInt32, -2147483648.0, 2147483647},
                                                          {ValueType::kUint32, 0, 4294967295.0},
                                                          {ValueType::kBit, 0, 1}};
  for (const auto& [type, least, most] : ranges) {
    for (const WordOrder words : kWordOrders) {
      for (const ByteOrder bytes : kByteOrders) {
        const Register value = Of(type, words, bytes);
        for (const double number : {least, most}) {
          EXPECT_EQ(Decode(value, Encode(value, number).span()).value, number);
        }
        for (const double number : {least - 1, most + 1}) {
          EXPECT_EQ(Encode(value, number).problem, CodecProblem::kOutOfRange) << number;
          EXPECT_EQ(Encode(value, number).length, 0U);
        }
      }
    }
  }
  EXPECT_EQ(Encode(Of(ValueType::kFloat32), 1e39).problem, CodecProblem::kOutOfRange);
  EXPECT_EQ(Encode(Of(ValueType::kBit), 0.5).problem, CodecProblem::kOutOfRange);
}

TEST(RegisterCodec, GivesNoValueForWhatIsNotFinite) {
  const std::uint16_t nan[] = {0x7FC0, 0x0000};
  const std::uint16_t infinity[] = {0xFF80, 0x0000};
  EXPECT_EQ(Decode(Of(ValueType::kFloat32), nan).problem, CodecProblem::kNotFinite);
  EXPECT_EQ(Decode(Of(ValueType::kFloat32), infinity).problem, CodecProblem::kNotFinite);
  for (const ValueType type : {ValueType::kInt16, ValueType::kFloat32, ValueType::kBit}) {
    EXPECT_EQ(Encode(Of(type), std::numeric_limits<double>::quiet_NaN()).problem, CodecProblem::kNotFinite);
    EXPECT_EQ(Encode(Of(type), -std::numeric_limits<double>::infinity()).problem, CodecProblem::kNotFinite);
  }
}

TEST(RegisterCodec, ABrokenSensorIsOutOfItsRangeAndNoValue) {
  Register value = Of(ValueType::kInt16);
  value.scale = 0.1;
  value.least = -200.0;
  value.most = 850.0;
  const std::uint16_t broken[] = {0x7FFF};
  EXPECT_EQ(Decode(value, broken).problem, CodecProblem::kOutOfRange);
  EXPECT_EQ(Encode(value, 850.1).problem, CodecProblem::kOutOfRange);
  EXPECT_EQ(Encode(value, -200.1).problem, CodecProblem::kOutOfRange);
}

TEST(RegisterCodec, RefusesAnotherNumberOfRegisters) {
  const std::uint16_t words[3] = {};
  const std::span<const std::uint16_t> all(words);
  EXPECT_EQ(Decode(Of(ValueType::kInt16), all.first(0)).problem, CodecProblem::kWrongLength);
  EXPECT_EQ(Decode(Of(ValueType::kInt16), all.first(2)).problem, CodecProblem::kWrongLength);
  EXPECT_EQ(Decode(Of(ValueType::kFloat32), all.first(1)).problem, CodecProblem::kWrongLength);
  EXPECT_EQ(Decode(Of(ValueType::kUint32), all).problem, CodecProblem::kWrongLength);
}

}  // namespace
}  // namespace strainwave::protocols::modbus::modbus_register_codec_test
