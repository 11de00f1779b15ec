// SPDX-License-Identifier: Apache-2.0
#include "bench/text.h"

#include <limits>

#include <gtest/gtest.h>

namespace strainwave::bench::text_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Text, ShowsADashForANumberThatIsNotThereInItsWidth) {
  EXPECT_EQ(Text("{}", kNaN), "–");
  EXPECT_EQ(Text("{:.2f} {:+.1f}", -kNaN, -kInfinity), "– –");
  EXPECT_EQ(Text("[{:8.3f}][{:>8.3g}][{:<8.3g}][{:^7}]", kNaN, kInfinity, kNaN, kNaN),
            "[       –][       –][–       ][   –   ]");
  EXPECT_EQ(Text("[{:>{}.{}f}]", kNaN, 6, 2), "[     –]");
}

TEST(Text, IsThatOfFmtForEverythingElse) {
  const int width = 6;
  const std::string word = "word";
  EXPECT_EQ(Text("{:>{}.{}f}|{:5}|{}|{:.2f}|{:d}", 2.5, width, 2, "a", word, 1.0f, 4),
            fmt::format("{:>{}.{}f}|{:5}|{}|{:.2f}|{:d}", 2.5, width, 2, "a", word, 1.0f, 4));
}

TEST(LowerCase, IsOfTheLettersOfAsciiAlone) {
  EXPECT_EQ(LowerCase("Hall-3 AZaz@[`{ ÄÉ"), "hall-3 azaz@[`{ ÄÉ");
  EXPECT_EQ(LowerCase(std::string_view("\xff\0Z", 3)), std::string_view("\xff\0z", 3));
}

}  // namespace
}  // namespace strainwave::bench::text_test
