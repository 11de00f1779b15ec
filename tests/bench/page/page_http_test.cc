// SPDX-License-Identifier: Apache-2.0
#include "bench/page/http_text.h"

#include <gtest/gtest.h>

#include "bench/page/event_stream.h"
#include "bench/page/static_files.h"
#include "bench/page/time_zone.h"

namespace strainwave::bench::page_http_test {
namespace {

TEST(PageRequestHead, IsWholeWithItsEmptyLine) {
  const std::string head = "POST / HTTP/1.1\r\nHost: a\r\ncontent-LENGTH:  12 \r\n\r\n";
  for (std::size_t i = 0; i < head.size(); ++i) EXPECT_FALSE(HeadOf(head.substr(0, i))) << i;
  const auto whole = HeadOf(head + "body");
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->bytes, head.size());
  EXPECT_EQ(whole->body_bytes, 12u);
  EXPECT_FALSE(whole->is_chunked);
  EXPECT_FALSE(whole->is_ambiguous);
}

TEST(PageRequestHead, SaysWhereTheLengthIsNotOneNumber) {
  const auto head = [](const std::string& lines) { return *HeadOf("GET / HTTP/1.1\r\n" + lines + "\r\n"); };
  EXPECT_TRUE(head("Transfer-Encoding: chunked\r\n").is_chunked);
  EXPECT_TRUE(head("Content-Length: 3\r\nContent-Length: 4\r\n").is_ambiguous);
  EXPECT_FALSE(head("Content-Length: 3\r\nContent-Length: 3\r\n").is_ambiguous);
  for (const char* length : {"-1", "3x", "", "1e3", "99999999999999999999999"}) {
    EXPECT_TRUE(head(std::string("Content-Length: ") + length + "\r\n").is_ambiguous) << length;
  }
}

TEST(PageOrigin, IsThePagesOwnWhereThereIsOne) {
  EXPECT_TRUE(IsOwnOrigin("", "http://", "localhost:8080"));
  EXPECT_TRUE(IsOwnOrigin("http://localhost:8080", "http://", "localhost:8080"));
  EXPECT_FALSE(IsOwnOrigin("http://localhost:8081", "http://", "localhost:8080"));
  EXPECT_FALSE(IsOwnOrigin("null", "http://", "localhost:8080"));
  EXPECT_TRUE(IsOwnOrigin("https://localhost:8080", "https://", "localhost:8080"));
  EXPECT_FALSE(IsOwnOrigin("http://localhost:8080", "https://", "localhost:8080"));
}

TEST(PageFiles, AreFoundByTheirWholePathAlone) {
  ASSERT_NE(FindStaticFile("/"), nullptr);
  EXPECT_EQ(FindStaticFile("/")->type, "text/html; charset=utf-8");
  EXPECT_TRUE(FindStaticFile("/")->bytes.starts_with("<!doctype html>"));
  EXPECT_EQ(FindStaticFile("/page.mjs")->type, "text/javascript; charset=utf-8");
  for (const char* path : {"", "/..", "/../page.css", "/page.css/", "//page.css", "/index.html"}) {
    EXPECT_EQ(FindStaticFile(path), nullptr) << path;
  }
}

// The content policy allows neither, and nothing is fetched from elsewhere.
TEST(PageFiles, HaveNoInlineScriptAndNameNoOtherHost) {
  for (const StaticFile& file : StaticFiles()) {
    if (file.path == "/uplot.mjs") continue;  // of others: comments with addresses
    EXPECT_EQ(file.bytes.find("<script>"), file.bytes.npos) << file.path;
    EXPECT_EQ(file.bytes.find("innerHTML"), file.bytes.npos) << file.path;
    EXPECT_EQ(file.bytes.find("https:"), file.bytes.npos) << file.path;
    EXPECT_EQ(file.bytes.find(" style=\""), file.bytes.npos) << file.path;
  }
}

Event Line(std::int64_t id) {
  return {3600.0, "2026-11-29T12:00:00.000Z", 7, "", "info", "code", "<b>a\nb</b>", id};
}

TEST(PageEvents, CarryTheNumberOfTheirLine) {
  const std::vector<Event> lines{Line(4), Line(5), Line(6)};
  const std::string frames = JournalFrames(lines, 4);
  EXPECT_TRUE(frames.starts_with("id: 5\nevent: journal\ndata: {")) << frames;
  EXPECT_NE(frames.find("}\n\nid: 6\nevent: journal\ndata: {"), frames.npos) << frames;
  EXPECT_NE(frames.find(R"("text":"<b>a\nb</b>")"), frames.npos) << frames;
  EXPECT_EQ(JournalFrames(lines, 6), "");
  EXPECT_EQ(EventFrame("alive", "{}"), "event: alive\ndata: {}\n\n");
}

TEST(PageEvents, GoOnAfterTheLineThatABrowserHasSeen) {
  EXPECT_EQ(LastEventId("12"), 12);
  for (const char* header : {"", "x", "-3", "12x", "99999999999999999999"}) EXPECT_EQ(LastEventId(header), 0);
}

TEST(PageTimeZone, IsTheNameThatBrowsersKnow) {
  EXPECT_EQ(TimeZoneIn("/usr/share/zoneinfo/Europe/Berlin"), "Europe/Berlin");
  EXPECT_EQ(TimeZoneIn("America/Argentina/Buenos_Aires"), "America/Argentina/Buenos_Aires");
  EXPECT_EQ(TimeZoneIn(":Etc/GMT+3"), "Etc/GMT+3");
  EXPECT_EQ(TimeZoneIn("/etc/localtime"), "");
  EXPECT_EQ(TimeZoneIn("CET-1CEST,M3.5.0"), "");
  EXPECT_EQ(TimeZoneIn(""), "");
}

}  // namespace
}  // namespace strainwave::bench::page_http_test
