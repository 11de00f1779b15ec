// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/request_text.h"

#include <gtest/gtest.h>

namespace strainwave::bench::request_text_test {
namespace {

std::string Head(const std::string& lines) { return "GET / HTTP/1.1\r\n" + lines + "\r\n"; }

TEST(RequestText, HasNoRangesHoweverTheyAreWritten) {
  const std::string host = "Host: a\r\n";
  for (const char* range : {"Range: bytes=0-\r\n", "RANGE:bytes=0-\r\n", " Range : bytes=0-\r\n",
                            "\tRange\t: x\r\n", "If-Range: \"a\"\r\n"}) {
    EXPECT_EQ(WithoutRanges(Head(range + host)), Head(host)) << range;
    EXPECT_EQ(WithoutRanges(Head(host + range)), Head(host)) << range;
  }
  EXPECT_EQ(WithoutRanges(Head("X: a\nRange: bytes=0-\r\n")), Head("X: a\n"));
}

TEST(RequestText, KeepsAllElse) {
  const std::string other = Head("Accept-Ranges: x\r\nX-Range: y\r\nHost: range\r\nRanges: z\r\n");
  EXPECT_EQ(WithoutRanges(other), other);
  const std::string with_body = Head("Content-Length: 9\r\n") + "Range: a\nb";
  EXPECT_EQ(WithoutRanges(with_body), with_body);
  for (const char* text : {"", "GET", "\n\n\n", "a\r\n\r"}) EXPECT_EQ(WithoutRanges(text), text);
}

}  // namespace
}  // namespace strainwave::bench::request_text_test
