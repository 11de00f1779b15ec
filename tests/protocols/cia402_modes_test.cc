// SPDX-License-Identifier: Apache-2.0
#include "protocols/cia402_modes.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <set>

#include "protocols/cia402.h"

namespace strainwave::protocols::cia402_modes_test {
namespace {

using enum OperationMode;

constexpr OperationMode kAllModes[] = {
    kNone,   kProfilePosition,      kVelocity,       kProfileVelocity, kProfileTorque,
    kHoming, kInterpolatedPosition, kCyclicPosition, kCyclicVelocity,  kCyclicTorque};

TEST(OperationModeOf, KnowsTheNumbersOf6060hAndNoOthers) {
  const std::map<int, OperationMode> printed{{0, kNone},
                                             {1, kProfilePosition},
                                             {2, kVelocity},
                                             {3, kProfileVelocity},
                                             {4, kProfileTorque},
                                             {6, kHoming},
                                             {7, kInterpolatedPosition},
                                             {8, kCyclicPosition},
                                             {9, kCyclicVelocity},
                                             {10, kCyclicTorque}};
  for (int number = -128; number <= 127; ++number) {
    const auto found = printed.find(number);
    EXPECT_EQ(OperationModeOf(static_cast<std::int8_t>(number)),
              found == printed.end() ? std::nullopt : std::optional(found->second))
        << number;
  }
}

TEST(SupportedModeBit, IsTheBitOf6502h) {
  EXPECT_EQ(SupportedModeBit(kNone), 0U);
  EXPECT_EQ(SupportedModeBit(kProfilePosition), 0x001U);
  EXPECT_EQ(SupportedModeBit(kProfileVelocity), 0x004U);
  EXPECT_EQ(SupportedModeBit(kProfileTorque), 0x008U);
  EXPECT_EQ(SupportedModeBit(kHoming), 0x020U);
  EXPECT_EQ(SupportedModeBit(kCyclicPosition), 0x080U);
  EXPECT_EQ(SupportedModeBit(kCyclicVelocity), 0x100U);
  EXPECT_EQ(SupportedModeBit(kCyclicTorque), 0x200U);
}

// The standard's tables of bits 12 and 13, a row each mode: what they are called, or nothing.
struct Row {
  bool StatusBits::*bit_12;
  bool StatusBits::*bit_13;
};
const std::map<OperationMode, Row> kRows{
    {kNone, {nullptr, nullptr}},
    {kProfilePosition, {&StatusBits::set_point_acknowledged, &StatusBits::following_error}},
    {kVelocity, {nullptr, nullptr}},
    {kProfileVelocity, {&StatusBits::speed_is_zero, &StatusBits::slippage_too_high}},
    {kProfileTorque, {nullptr, nullptr}},
    {kHoming, {&StatusBits::homing_attained, &StatusBits::homing_error}},
    {kInterpolatedPosition, {&StatusBits::follows_command, nullptr}},
    {kCyclicPosition, {&StatusBits::follows_command, &StatusBits::following_error}},
    {kCyclicVelocity, {&StatusBits::follows_command, nullptr}},
    {kCyclicTorque, {&StatusBits::follows_command, nullptr}},
};

// Point 4: masked, never compared whole.
TEST(StatusBitsOf, FollowsThePrintedTableInEveryModeForAll65536Statuswords) {
  for (const OperationMode mode : kAllModes) {
    const Row& row = kRows.at(mode);
    for (unsigned word = 0; word <= 0xFFFF; ++word) {
      StatusBits expected;
      expected.voltage_enabled = word / 16 % 2 == 1;
      expected.warning = word / 128 % 2 == 1;
      expected.remote = word / 512 % 2 == 1;
      expected.target_reached = word / 1024 % 2 == 1;
      expected.internal_limit = word / 2048 % 2 == 1;
      if (row.bit_12 != nullptr) expected.*row.bit_12 = word / 4096 % 2 == 1;
      if (row.bit_13 != nullptr) expected.*row.bit_13 = word / 8192 % 2 == 1;
      ASSERT_EQ(StatusBitsOf(mode, static_cast<std::uint16_t>(word)), expected)
          << Name(mode) << " " << std::hex << word;
    }
  }
}

TEST(StatusBitsOf, AndThePowerStateReadDifferentBits) {
  constexpr unsigned kOfThePowerState = 0x006F;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const auto without = static_cast<std::uint16_t>(word & kOfThePowerState);
    ASSERT_EQ(PowerStateOf(static_cast<std::uint16_t>(word)), PowerStateOf(without)) << word;
    ASSERT_EQ(StatusBitsOf(kHoming, static_cast<std::uint16_t>(word)),
              StatusBitsOf(kHoming, static_cast<std::uint16_t>(word & ~kOfThePowerState)))
        << word;
  }
}

TEST(ModeName, IsDifferentForEachMode) {
  std::set<std::string_view> names;
  for (const OperationMode mode : kAllModes) names.insert(Name(mode));
  EXPECT_EQ(names.size(), std::size(kAllModes));
}

}  // namespace
}  // namespace strainwave::protocols::cia402_modes_test
