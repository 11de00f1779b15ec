// SPDX-License-Identifier: Apache-2.0
#include "protocols/cia402.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

namespace strainwave::protocols::cia402_test {
namespace {

using enum PowerState;

constexpr PowerState kAllStates[] = {
    kNotReadyToSwitchOn, kSwitchOnDisabled, kReadyToSwitchOn,     kSwitchedOn,
    kOperationEnabled,   kQuickStopActive,  kFaultReactionActive, kFault};

// The table of the standard as it is printed: bits 6 5 | 3 2 1 0, x for any. The code under test has masks.
struct Printed {
  const char* bits;
  PowerState state;
};
constexpr Printed kPrinted[] = {
    {"0x0000", kNotReadyToSwitchOn},  {"1x0000", kSwitchOnDisabled},
    {"010001", kReadyToSwitchOn},     {"010011", kSwitchedOn},
    {"010111", kOperationEnabled},    {"000111", kQuickStopActive},
    {"0x1111", kFaultReactionActive}, {"0x1000", kFault},
};
constexpr int kBitNumbers[] = {6, 5, 3, 2, 1, 0};

std::optional<PowerState> ByThePrintedTable(unsigned statusword) {
  for (const Printed& row : kPrinted) {
    bool fits = true;
    for (std::size_t i = 0; i < std::size(kBitNumbers); ++i) {
      const char bit = (statusword >> kBitNumbers[i]) % 2 == 1 ? '1' : '0';
      fits = fits && (row.bits[i] == 'x' || row.bits[i] == bit);
    }
    if (fits) return row.state;
  }
  return std::nullopt;
}

TEST(PowerStateOf, FollowsThePrintedTableForAll65536Statuswords) {
  std::map<PowerState, int> seen;
  int unknown = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    const std::optional<PowerState> state = PowerStateOf(static_cast<std::uint16_t>(word));
    ASSERT_EQ(state, ByThePrintedTable(word)) << std::hex << word;
    if (state) {
      ++seen[*state];
    } else {
      ++unknown;
    }
  }
  // A pattern of m fixed bits fits 2^(16-m) words: 6 fixed bits 1024, 5 fixed bits 2048.
  const std::map<PowerState, int> expected{{kNotReadyToSwitchOn, 2048},  {kSwitchOnDisabled, 2048},
                                           {kReadyToSwitchOn, 1024},     {kSwitchedOn, 1024},
                                           {kOperationEnabled, 1024},    {kQuickStopActive, 1024},
                                           {kFaultReactionActive, 2048}, {kFault, 2048}};
  EXPECT_EQ(seen, expected);
  EXPECT_EQ(unknown, 65536 - 4 * 2048 - 4 * 1024);
}

TEST(PowerStateOf, ReadsWordsThatDrivesReport) {
  EXPECT_EQ(PowerStateOf(0x0250), kSwitchOnDisabled);
  EXPECT_EQ(PowerStateOf(0x0231), kReadyToSwitchOn);
  EXPECT_EQ(PowerStateOf(0x0233), kSwitchedOn);
  EXPECT_EQ(PowerStateOf(0x1637), kOperationEnabled);
  EXPECT_EQ(PowerStateOf(0x0217), kQuickStopActive);
  EXPECT_EQ(PowerStateOf(0x0218), kFault);
}

TEST(PowerStateOf, SaysNothingForAWordThatFitsNoState) {
  EXPECT_EQ(PowerStateOf(0x0067), std::nullopt);  // operation enabled and switch on disabled at once
  EXPECT_EQ(PowerStateOf(0x0002), std::nullopt);  // switched on without ready to switch on
  EXPECT_EQ(PowerStateOf(0xFFFF), std::nullopt);
}

TEST(Name, IsDifferentForEachState) {
  std::set<std::string_view> names;
  for (const PowerState state : kAllStates) names.insert(Name(state));
  EXPECT_EQ(names.size(), std::size(kAllStates));
  EXPECT_EQ(Name(kQuickStopActive), "quick stop active");
}

// Every transition by command, with the words that the standard gives for it; between two calls the word
// before is another one, so that nothing rests on an edge.
struct Step {
  PowerState from;
  std::uint16_t controlword;
  PowerState to;
};
constexpr Step kSteps[] = {
    {kSwitchOnDisabled, 0x0006, kReadyToSwitchOn},   // 2
    {kReadyToSwitchOn, 0x0007, kSwitchedOn},         // 3
    {kReadyToSwitchOn, 0x000F, kSwitchedOn},         // 3, with 4 to follow
    {kSwitchedOn, 0x000F, kOperationEnabled},        // 4
    {kOperationEnabled, 0x0007, kSwitchedOn},        // 5
    {kSwitchedOn, 0x0006, kReadyToSwitchOn},         // 6
    {kReadyToSwitchOn, 0x0000, kSwitchOnDisabled},   // 7
    {kReadyToSwitchOn, 0x0002, kSwitchOnDisabled},   // 7
    {kOperationEnabled, 0x0006, kReadyToSwitchOn},   // 8
    {kOperationEnabled, 0x0000, kSwitchOnDisabled},  // 9
    {kSwitchedOn, 0x0000, kSwitchOnDisabled},        // 10
    {kSwitchedOn, 0x0002, kSwitchOnDisabled},        // 10
    {kOperationEnabled, 0x0002, kQuickStopActive},   // 11
    {kQuickStopActive, 0x0000, kSwitchOnDisabled},   // 12
    {kFault, 0x0080, kSwitchOnDisabled},             // 15
    {kQuickStopActive, 0x000F, kOperationEnabled},   // 16
};

TEST(NextPowerState, TakesEachTransitionOfTheStandard) {
  for (const Step& step : kSteps) {
    EXPECT_EQ(NextPowerState(step.from, 0x0000, step.controlword), step.to)
        << Name(step.from) << " by " << step.controlword;
  }
}

TEST(NextPowerState, LooksAtTheModeBitsOfNoCommand) {
  constexpr std::uint16_t kModeAndMakerBits = 0xFF70;  // bits 4 to 6, halt, reserved, maker's own
  for (const Step& step : kSteps) {
    const auto word = static_cast<std::uint16_t>(step.controlword | kModeAndMakerBits);
    EXPECT_EQ(NextPowerState(step.from, 0x0000, word), step.to) << Name(step.from) << " by " << word;
  }
}

TEST(NextPowerState, ReachesOperationEnabledOnlyFromSwitchedOnOrQuickStop) {
  for (const PowerState state : kAllStates) {
    for (unsigned word = 0; word <= 0xFF; ++word) {
      const PowerState next = NextPowerState(state, 0x0000, static_cast<std::uint16_t>(word));
      if (next != kOperationEnabled) continue;
      EXPECT_TRUE(state == kOperationEnabled || state == kSwitchedOn || state == kQuickStopActive)
          << Name(state) << " by " << word;
      EXPECT_EQ(word & 0x8F, state == kOperationEnabled ? word & 0x8F : 0x0FU);
    }
  }
}

TEST(NextPowerState, ResetsAFaultOnTheRisingEdgeOnly) {
  EXPECT_EQ(NextPowerState(kFault, 0x0000, kControlwordFaultReset), kSwitchOnDisabled);
  EXPECT_EQ(NextPowerState(kFault, kControlwordFaultReset, kControlwordFaultReset), kFault);
  EXPECT_EQ(NextPowerState(kFault, kControlwordFaultReset, 0x0000), kFault);
  // The edge counts, whatever the other bits do.
  EXPECT_EQ(NextPowerState(kFault, 0x000F, 0x008F), kSwitchOnDisabled);
  EXPECT_EQ(NextPowerState(kFault, 0x0080, 0x008F), kFault);
}

TEST(NextPowerState, LeavesAFaultByNothingElse) {
  for (unsigned word = 0; word <= 0x7F; ++word) {
    EXPECT_EQ(NextPowerState(kFault, 0x0000, static_cast<std::uint16_t>(word)), kFault);
    EXPECT_EQ(NextPowerState(kFaultReactionActive, 0x0000, static_cast<std::uint16_t>(word | 0x80)),
              kFaultReactionActive);
  }
}

TEST(NextPowerState, StopsQuicklyWithBitTwoLowWhateverTheEnableBitsSay) {
  for (const std::uint16_t word : {kControlwordQuickStop, std::uint16_t{0x0003}, std::uint16_t{0x000B}}) {
    EXPECT_EQ(NextPowerState(kOperationEnabled, 0x000F, word), kQuickStopActive) << word;
  }
}

TEST(NextPowerState, TakesNoCommandWhileAResetBitIsHeld) {
  for (const Step& step : kSteps) {
    if (step.from == kFault) continue;
    const auto held = static_cast<std::uint16_t>(step.controlword | 0x80);
    EXPECT_EQ(NextPowerState(step.from, 0x0080, held), step.from) << Name(step.from) << " by " << held;
  }
}

TEST(ControlwordTowardsEnabled, WalksADriveUpAndKeepsItThere) {
  std::vector<PowerState> walked;
  PowerState state = kSwitchOnDisabled;
  std::uint16_t previous = 0x0000;
  for (int i = 0; i < 5; ++i) {
    const std::optional<std::uint16_t> word = ControlwordTowardsEnabled(state);
    ASSERT_TRUE(word.has_value());
    state = NextPowerState(state, previous, *word);
    previous = *word;
    walked.push_back(state);
  }
  EXPECT_EQ(walked, (std::vector{kReadyToSwitchOn, kSwitchedOn, kOperationEnabled, kOperationEnabled,
                                 kOperationEnabled}));
}

TEST(ControlwordTowardsEnabled, LeadsOutOfAQuickStopThroughSwitchOnDisabled) {
  EXPECT_EQ(NextPowerState(kQuickStopActive, 0x0002, *ControlwordTowardsEnabled(kQuickStopActive)),
            kSwitchOnDisabled);
}

TEST(ControlwordTowardsEnabled, HasNoWordWhereNoCommandLeadsOn) {
  EXPECT_EQ(ControlwordTowardsEnabled(kNotReadyToSwitchOn), std::nullopt);
  EXPECT_EQ(ControlwordTowardsEnabled(kFaultReactionActive), std::nullopt);
  EXPECT_EQ(ControlwordTowardsEnabled(kFault), std::nullopt);
}

}  // namespace
}  // namespace strainwave::protocols::cia402_test
