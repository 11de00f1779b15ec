// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/pdo.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/protocols/canopen/frames.h"

namespace strainwave::protocols::canopen::pdo_test {
namespace {

const std::vector<PdoEntry> kStatus{{{0x6041, 0}, 16}, {{0x6061, 0}, 8}, {{0x6064, 0}, 32}};

TEST(MappingValue, IsIndexSubindexAndBits) {
  EXPECT_EQ(MappingValue({{0x6041, 0x00}, 16}), 0x60410010U);
  EXPECT_EQ(MappingValue({{0x60FE, 0x01}, 32}), 0x60FE0120U);
  EXPECT_EQ(EntryOfMappingValue(0x60FE0120), (PdoEntry{{0x60FE, 0x01}, 32}));
}

TEST(PackPdo, LaysValuesOneAfterAnotherLowestByteFirst) {
  const std::int64_t values[] = {0x0237, -1, -2};
  EXPECT_EQ(PackPdo(0x183, kStatus, values), Frame("183#3702FFFEFFFFFF"));
}

TEST(PackPdo, PacksBitsAcrossBytes) {
  const std::vector<PdoEntry> entries{{{1, 0}, 3}, {{2, 0}, 7}, {{3, 0}, 1}};
  const std::int64_t values[] = {0b101, 0b1000001, 1};
  // From bit 0 on: 101, then 1000001, then 1: 1 1000001 101 = 60Dh.
  EXPECT_EQ(PackPdo(0x200, entries, values), Frame("200#0D06"));
}

TEST(PdoValue, ReadsBackWhatWasPackedForEveryWidth) {
  for (std::uint8_t bits = 1; bits <= 58; ++bits) {
    const std::vector<PdoEntry> entries{{{1, 0}, 5}, {{2, 0}, bits}, {{3, 0}, 1}};
    for (const std::int64_t value : {std::int64_t{-1}, std::int64_t{0}, std::int64_t{1} << (bits - 1)}) {
      const std::int64_t values[] = {0, value, 0};
      const auto frame = PackPdo(0x200, entries, values);
      ASSERT_TRUE(frame.has_value());
      const std::uint64_t expected =
          bits == 64 ? static_cast<std::uint64_t>(value) : static_cast<std::uint64_t>(value) % (1ULL << bits);
      EXPECT_EQ(PdoValue(*frame, entries, 1), expected);
      EXPECT_EQ(PdoValue(*frame, entries, 0), 0U);
      EXPECT_EQ(PdoValue(*frame, entries, 2), 0U);
    }
  }
}

TEST(PdoValue, ReadsNothingFromAFrameOfAnotherLength) {
  EXPECT_EQ(PdoValue(Frame("183#370203FEFFFFFF"), kStatus, 0), 0x0237U);
  EXPECT_EQ(PdoValue(Frame("183#370203FEFFFF"), kStatus, 0), std::nullopt);
  EXPECT_EQ(PdoValue(Frame("183#370203FEFFFFFF00"), kStatus, 0), std::nullopt);
  EXPECT_EQ(PdoValue(Frame("183#370203FEFFFFFF"), kStatus, 3), std::nullopt);
}

TEST(SignExtended, ReadsTwosComplement) {
  EXPECT_EQ(SignExtended(0xFFFFFFFE, 32), -2);
  EXPECT_EQ(SignExtended(0x7F, 8), 127);
  EXPECT_EQ(SignExtended(0x80, 8), -128);
  EXPECT_EQ(SignExtended(0xFFFFFFFFFFFFFFFF, 64), -1);
}

PdoSetting SomeRpdo() {
  return {.flow = PdoFlow::kToDrive,
          .number = 2,
          .cob_id = 0x303,
          .transmission_type = 255,
          .inhibit_time_100us = {},
          .event_timer_ms = 50,
          .entries = {{{0x6040, 0}, 16}, {{0x60FF, 0}, 32}}};
}

// Point 3.
TEST(RemapWrites, KeepTheOnlyOrderThatTheStandardAllowsAndBit30) {
  const std::vector<PdoWrite> expected{
      {{0x1401, 1}, 4, 0x80000000, 0x7FFFFFFF},  // not valid, all else as it is
      {{0x1601, 0}, 1, 0, 0},
      {{0x1601, 1}, 4, 0x60400010, 0},
      {{0x1601, 2}, 4, 0x60FF0020, 0},
      {{0x1601, 0}, 1, 2, 0},
      {{0x1401, 2}, 1, 255, 0},
      {{0x1401, 5}, 2, 50, 0},
      {{0x1401, 1}, 4, 0x00000303, 0x40000000},  // valid, bit 30 as it is
  };
  EXPECT_EQ(RemapWrites(SomeRpdo()), expected);
}

TEST(RemapReadBack, CoversEverythingThatWasWritten) {
  const std::vector<PdoWrite> expected{{{0x1601, 0}, 1, 2, 0},          {{0x1601, 1}, 4, 0x60400010, 0},
                                       {{0x1601, 2}, 4, 0x60FF0020, 0}, {{0x1401, 2}, 1, 255, 0},
                                       {{0x1401, 5}, 2, 50, 0},         {{0x1401, 1}, 4, 0x303, 0x40000000}};
  EXPECT_EQ(RemapReadBack(SomeRpdo()), expected);
}

TEST(RemapWrites, AddressTheDrivesTransmitPdosAt1800h) {
  PdoSetting pdo = SomeRpdo();
  pdo.flow = PdoFlow::kFromDrive;
  pdo.number = 4;
  pdo.inhibit_time_100us = 10;
  const std::vector<PdoWrite> writes = RemapWrites(pdo);
  EXPECT_EQ(writes.front().address, (ObjectAddress{0x1803, 1}));
  EXPECT_EQ(writes[1].address, (ObjectAddress{0x1A03, 0}));
  EXPECT_EQ(writes[6], (PdoWrite{{0x1803, 3}, 2, 10, 0}));
}

TEST(RemapWrites, RefuseAPdoThatCannotBe) {
  const auto message = [](PdoSetting pdo) -> std::string {
    try {
      RemapWrites(pdo);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  PdoSetting pdo = SomeRpdo();
  pdo.entries.push_back({{0x607A, 0}, 32});
  EXPECT_EQ(message(pdo), "PDO 303h maps 80 bits, above 64");
  pdo = SomeRpdo();
  pdo.number = 0;
  EXPECT_EQ(message(pdo), "number = 0 of a PDO is not 1 to 512");
  pdo = SomeRpdo();
  pdo.cob_id = 0x603;
  EXPECT_EQ(message(pdo), "cob_id = 603h of a PDO is not 181h to 57Fh");
  pdo = SomeRpdo();
  pdo.entries.clear();
  EXPECT_EQ(message(pdo), "entries = 0 of PDO 303h are not 1 to 64");
  pdo = SomeRpdo();
  pdo.entries[0].bits = 0;
  EXPECT_EQ(message(pdo), "bits = 0 of 6040h:00 are not 1 to 64");
}

}  // namespace
}  // namespace strainwave::protocols::canopen::pdo_test
