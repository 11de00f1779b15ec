// SPDX-License-Identifier: Apache-2.0
#include "protocols/modbus/pdu.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace strainwave::protocols::modbus::modbus_pdu_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Words = std::vector<std::uint16_t>;

Bytes BytesOf(const Pdu& pdu) { return {pdu.span().begin(), pdu.span().end()}; }

std::string MessageOf(auto&& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

// The frames are the worked examples' layout of the application protocol, chapters 6.1 to 6.12, by hand.
TEST(Pdu, AsksAsTheStandardPrintsIt) {
  EXPECT_EQ(BytesOf(ReadPdu(Table::kCoil, 0x0013, 19)), (Bytes{1, 0x00, 0x13, 0x00, 0x13}));
  EXPECT_EQ(BytesOf(ReadPdu(Table::kDiscrete, 0x00C4, 22)), (Bytes{2, 0x00, 0xC4, 0x00, 0x16}));
  EXPECT_EQ(BytesOf(ReadPdu(Table::kHolding, 0x006B, 3)), (Bytes{3, 0x00, 0x6B, 0x00, 0x03}));
  EXPECT_EQ(BytesOf(ReadPdu(Table::kInput, 8, 1)), (Bytes{4, 0x00, 0x08, 0x00, 0x01}));
  EXPECT_EQ(BytesOf(WritePdu(Table::kCoil, 0x00AC, Words{1})), (Bytes{5, 0x00, 0xAC, 0xFF, 0x00}));
  EXPECT_EQ(BytesOf(WritePdu(Table::kCoil, 0x00AC, Words{0})), (Bytes{5, 0x00, 0xAC, 0x00, 0x00}));
  EXPECT_EQ(BytesOf(WritePdu(Table::kHolding, 1, Words{3})), (Bytes{6, 0x00, 0x01, 0x00, 0x03}));
  EXPECT_EQ(BytesOf(WritePdu(Table::kCoil, 0x0013, Words{1, 0, 1, 1, 0, 0, 1, 1, 1, 0})),
            (Bytes{15, 0x00, 0x13, 0x00, 0x0A, 2, 0xCD, 0x01}));
  EXPECT_EQ(BytesOf(WritePdu(Table::kHolding, 1, Words{0x000A, 0x0102})),
            (Bytes{16, 0x00, 0x01, 0x00, 0x02, 4, 0x00, 0x0A, 0x01, 0x02}));
}

TEST(Pdu, RefusesMoreThanOneFrameHolds) {
  EXPECT_EQ(MessageOf([] { ReadPdu(Table::kHolding, 0, 126); }),
            "count = 126 at address 0 is out of range (expected 1 to 125, up to address 65535)");
  EXPECT_EQ(MessageOf([] { ReadPdu(Table::kCoil, 10, 0); }),
            "count = 0 at address 10 is out of range (expected 1 to 2000, up to address 65535)");
  EXPECT_EQ(MessageOf([] { ReadPdu(Table::kInput, 65535, 2); }),
            "count = 2 at address 65535 is out of range (expected 1 to 125, up to address 65535)");
  EXPECT_EQ(MessageOf([] { WritePdu(Table::kHolding, 0, Words(124)); }),
            "count = 124 at address 0 is out of range (expected 1 to 123, up to address 65535)");
  EXPECT_EQ(MessageOf([] { WritePdu(Table::kInput, 0, Words(1)); }),
            "table is read-only (expected the coil or holding table)");
  EXPECT_EQ(WritePdu(Table::kHolding, 0, Words(123)).size, 252U);
  EXPECT_EQ(WritePdu(Table::kCoil, 0, Words(1968)).size, 252U);
}

TEST(TakeAnswer, TakesRegistersAndBits) {
  Words words(3);
  EXPECT_EQ(TakeAnswer(ReadPdu(Table::kHolding, 0x6B, 3), Bytes{3, 6, 0x02, 0x2B, 0, 0, 0, 0x64}, words).kind,
            AnswerKind::kGood);
  EXPECT_EQ(words, (Words{0x022B, 0, 0x0064}));
  Words bits(10);
  EXPECT_EQ(TakeAnswer(ReadPdu(Table::kCoil, 0x13, 10), Bytes{1, 2, 0xCD, 0x01}, bits).kind,
            AnswerKind::kGood);
  EXPECT_EQ(bits, (Words{1, 0, 1, 1, 0, 0, 1, 1, 1, 0}));
}

TEST(TakeAnswer, TakesTheEchoOfAWriteOnly) {
  const Pdu one = WritePdu(Table::kHolding, 1, Words{3});
  EXPECT_EQ(TakeAnswer(one, Bytes{6, 0, 1, 0, 3}, {}).kind, AnswerKind::kGood);
  EXPECT_EQ(TakeAnswer(one, Bytes{6, 0, 2, 0, 3}, {}).kind, AnswerKind::kOtherAddress);
  EXPECT_EQ(TakeAnswer(one, Bytes{6, 0, 1, 0, 4}, {}).kind, AnswerKind::kOtherAddress);
  const Pdu two = WritePdu(Table::kHolding, 1, Words{10, 258});
  EXPECT_EQ(TakeAnswer(two, Bytes{16, 0, 1, 0, 2}, {}).kind, AnswerKind::kGood);
  EXPECT_EQ(TakeAnswer(two, Bytes{16, 0, 1, 0, 1}, {}).kind, AnswerKind::kOtherAddress);
  EXPECT_EQ(TakeAnswer(two, Bytes{16, 0, 1, 0}, {}).kind, AnswerKind::kWrongLength);
}

TEST(TakeAnswer, TellsExceptionsFromOtherFunctions) {
  const Pdu request = ReadPdu(Table::kHolding, 0, 1);
  Words words(1, 77);
  const Answer refused = TakeAnswer(request, Bytes{0x83, 2}, words);
  EXPECT_EQ(refused.kind, AnswerKind::kException);
  EXPECT_EQ(refused.exception, 2);
  EXPECT_EQ(TakeAnswer(request, Bytes{0x84, 2}, words).kind, AnswerKind::kOtherFunction);
  EXPECT_EQ(TakeAnswer(request, Bytes{4, 2, 0, 1}, words).kind, AnswerKind::kOtherFunction);
  EXPECT_EQ(words, Words{77});
}

TEST(TakeAnswer, RefusesEveryOtherLength) {
  const Pdu request = ReadPdu(Table::kHolding, 0, 2);
  const Bytes good{3, 4, 0, 1, 0, 2};
  Words words(2);
  ASSERT_EQ(TakeAnswer(request, good, words).kind, AnswerKind::kGood);
  for (std::size_t length = 0; length < good.size(); ++length) {
    EXPECT_EQ(TakeAnswer(request, std::span(good).first(length), words).kind, AnswerKind::kWrongLength)
        << length;
  }
  EXPECT_EQ(TakeAnswer(request, Bytes{3, 4, 0, 1, 0, 2, 0}, words).kind, AnswerKind::kWrongLength);
  EXPECT_EQ(TakeAnswer(request, Bytes{3, 2, 0, 1, 0, 2}, words).kind, AnswerKind::kWrongLength);
  EXPECT_EQ(TakeAnswer(request, Bytes{3, 2, 0, 1}, words).kind, AnswerKind::kWrongLength);
  EXPECT_EQ(TakeAnswer(request, Bytes{0x83}, words).kind, AnswerKind::kWrongLength);
  EXPECT_EQ(TakeAnswer(request, Bytes{0x83, 2, 0}, words).kind, AnswerKind::kWrongLength);
  Words too_few(1);
  EXPECT_EQ(TakeAnswer(request, good, too_few).kind, AnswerKind::kWrongLength);
}

// The example of the standard, 6.4, and its order of refusals.
TEST(AnswerFromInputRegisters, GivesTheWordsOrTheExceptionOfTheStandard) {
  const std::vector<std::uint16_t> registers{7, 8, 0x000A};
  const auto answer = [&](const Bytes& request) {
    const Pdu pdu = AnswerFromInputRegisters(request, registers);
    return Bytes(pdu.span().begin(), pdu.span().end());
  };
  EXPECT_EQ(answer({4, 0, 2, 0, 1}), (Bytes{4, 2, 0, 0x0A}));
  EXPECT_EQ(answer({4, 0, 0, 0, 3}), (Bytes{4, 6, 0, 7, 0, 8, 0, 0x0A}));
  EXPECT_EQ(answer({3, 0, 2, 0, 1}), (Bytes{0x83, 1}));
  EXPECT_EQ(answer({4, 0, 2, 0, 2}), (Bytes{0x84, 2}));
  EXPECT_EQ(answer({4, 0xFF, 0xFF, 0, 1}), (Bytes{0x84, 2}));
  EXPECT_EQ(answer({4, 0, 2, 0, 0}), (Bytes{0x84, 3}));
  EXPECT_EQ(answer({4, 0, 0, 0, 126}), (Bytes{0x84, 3}));
  for (const Bytes& short_or_long : {Bytes{4}, Bytes{4, 0, 2, 0}, Bytes{4, 0, 2, 0, 1, 0}}) {
    EXPECT_EQ(answer(short_or_long), (Bytes{0x84, 3}));
  }
  EXPECT_EQ(answer({}), (Bytes{0x80, 1}));
}

TEST(ExceptionText, SaysWhatTheDeviceMeans) {
  EXPECT_EQ(ExceptionText(2), "2, illegal data address: the device has no such register");
  EXPECT_EQ(ExceptionText(6), "6, device busy: ask again later");
  EXPECT_EQ(ExceptionText(11), "11, no answer from the device behind the gateway");
  EXPECT_EQ(ExceptionText(99), "99, a code that the standard does not have");
}

TEST(Mbap, StandsBeforeEachFrame) {
  const auto bytes = MbapBytes({0x1501, 0, 6, 0xFF});
  EXPECT_EQ(Bytes(bytes.begin(), bytes.end()), (Bytes{0x15, 0x01, 0, 0, 0, 6, 0xFF}));
  const auto mbap = TakeMbap(bytes);
  ASSERT_TRUE(mbap);
  EXPECT_EQ(mbap->transaction, 0x1501);
  EXPECT_EQ(mbap->length, 6);
  EXPECT_EQ(mbap->unit, 0xFF);
  EXPECT_FALSE(TakeMbap(std::span(bytes).first(6)));
}

}  // namespace
}  // namespace strainwave::protocols::modbus::modbus_pdu_test
