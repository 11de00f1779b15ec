// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/hid/pendant_state.h"

#include <gtest/gtest.h>

#include <vector>

namespace strainwave::bench::pendant_state_test {
namespace {

PendantKeys Keys(unsigned bits) { return {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0}; }

// What must have happened for the bench to be released, told of the whole sequence at once: after the last
// time that the quick-stop key was down, reset went down alone, and after that start went down alone.
PendantState Told(const std::vector<unsigned>& sequence) {
  std::vector<unsigned> all{7};  // at the start every key counts as down
  all.insert(all.end(), sequence.begin(), sequence.end());
  std::size_t last_stop = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if ((all[i] & 1) != 0) last_stop = i;
  }
  const auto goes_down_alone = [&](std::size_t i, unsigned key) {
    return (all[i] & 6) == key && (all[i - 1] & key) == 0;
  };
  bool reset = false, start = false;
  for (std::size_t i = last_stop + 2; i < all.size(); ++i) {  // one report with all stop keys up comes first
    if (reset && goes_down_alone(i, 4)) start = true;
    if (goes_down_alone(i, 2)) reset = true;
  }
  return start ? PendantState::kReleased : reset ? PendantState::kReset : PendantState::kStopped;
}

TEST(NextPendantState, IsAsToldForEverySequenceOfSixReports) {
  constexpr int kReports = 6;
  int counts[3] = {};
  for (unsigned code = 0; code < 1U << (3 * kReports); ++code) {
    std::vector<unsigned> sequence;
    PendantState state = PendantState::kStopped;
    PendantKeys before;
    for (int i = 0; i < kReports; ++i) {
      sequence.push_back(code >> (3 * i) & 7);
      const PendantKeys now = Keys(sequence.back());
      state = NextPendantState(state, before, now);
      before = now;
      ASSERT_TRUE(!now.quick_stop || state == PendantState::kStopped);
    }
    ASSERT_EQ(state, Told(sequence)) << std::oct << code;
    ++counts[static_cast<int>(state)];
  }
  EXPECT_GT(counts[1], 1000);
  EXPECT_GT(counts[2], 100);
}

TEST(NextPendantState, ALostPendantIsAsOneWhoseKeyIsPressed) {
  for (const PendantState state : {PendantState::kStopped, PendantState::kReset, PendantState::kReleased}) {
    EXPECT_EQ(NextPendantState(state, Keys(0), PendantKeys{}), PendantState::kStopped);
  }
}

TEST(NextPendantState, ResetAndStartTogetherAreNoDeliberateActs) {
  EXPECT_EQ(NextPendantState(PendantState::kStopped, Keys(0), Keys(6)), PendantState::kStopped);
  EXPECT_EQ(NextPendantState(PendantState::kReset, Keys(0), Keys(6)), PendantState::kReset);
  EXPECT_EQ(NextPendantState(PendantState::kReset, Keys(4), Keys(4)), PendantState::kReset)
      << "held, not pressed";
}

}  // namespace
}  // namespace strainwave::bench::pendant_state_test
