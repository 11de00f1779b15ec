// SPDX-License-Identifier: Apache-2.0
#include "daq/direction_words.h"

#include <gtest/gtest.h>

namespace strainwave::daq::direction_words_test {
namespace {

TEST(DirectionWords, AreThoseOfEitherDirectionInAnyWriting) {
  for (const char* word : {"cw", "CW", " Cw ", "forward", "FORWARD", "positive", "1", "+1", "1.0", "1e0"}) {
    EXPECT_EQ(DirectionOf(std::string_view(word)), Direction::kClockwise) << word;
  }
  for (const char* word :
       {"ccw", "CCW", "\tccw", "backward", "Backward", "reverse", "negative", "-1", "-1.0"}) {
    EXPECT_EQ(DirectionOf(std::string_view(word)), Direction::kCounterClockwise) << word;
  }
}

TEST(DirectionWords, AreNoOthers) {
  for (const char* word :
       {"", "c", "cww", "clockwise", "0", "2", "-2", "1.5", "nan", "+-1", "++1", "1 1", "cw,"}) {
    EXPECT_EQ(DirectionOf(std::string_view(word)), std::nullopt) << word;
  }
}

}  // namespace
}  // namespace strainwave::daq::direction_words_test
