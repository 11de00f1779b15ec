// SPDX-License-Identifier: Apache-2.0
#include "bench/escaped.h"

#include <gtest/gtest.h>

namespace strainwave::bench::escaped_test {
namespace {

TEST(Escaped, LeavesWhatPeopleWriteAsItIs) {
  EXPECT_EQ(Escaped("Grüße, 5 µm <b> \\ \"x\" 𝄞 –"), "Grüße, 5 µm <b> \\ \"x\" 𝄞 –");
}

TEST(Escaped, ShowsWhatATerminalWouldObey) {
  EXPECT_EQ(Escaped("a\nb\tc\rd"), "a\\nb\\tc\\x0dd");
  EXPECT_EQ(Escaped("\x1b[2J\x07\x7f"), "\\x1b[2J\\x07\\x7f");
  EXPECT_EQ(Escaped("\xc2\x9b"
                    "31m"),
            "\\x9b31m");  // CSI in one character
  EXPECT_EQ(Escaped("\xe2\x80\xae"
                    "cba"),
            "\\u202ecba");  // right to left from here
}

TEST(Escaped, ShowsBytesThatAreNoUtf8) {
  EXPECT_EQ(Escaped("\xff"
                    "a"),
            "\\xffa");
  EXPECT_EQ(Escaped("\xc3"), "\\xc3");           // cut
  EXPECT_EQ(Escaped("\xc0\x8a"), "\\xc0\\x8a");  // a newline the long way
  EXPECT_EQ(Escaped("\xe0\x80\x8a"), "\\xe0\\x80\\x8a");
  EXPECT_EQ(Escaped("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // half of a pair
}

}  // namespace
}  // namespace strainwave::bench::escaped_test
