// SPDX-License-Identifier: Apache-2.0
// What no schedule is made of: refused with one message and a place, whatever it is.
#include "schedules/reader/yaml_node.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/schedules/schedule_text.h"

namespace strainwave::schedules::yaml_node_test {
namespace {

std::string MessageOfFile(const std::filesystem::path& path) {
  try {
    ReadSchedule(path);
    return {};
  } catch (const ScheduleError& error) {
    return error.what();
  }
}

TEST(ParseYaml, NamesTabsInTheIndentation) {
  const std::string text = With(With(GoodSchedule(), "  ratio", "\tratio"), "  t3", "  \tt3");
  EXPECT_EQ(MessageOf(text),
            "small.yaml:6:1: error: tab in the indentation (expected spaces)\n"
            "small.yaml:9:3: error: tab in the indentation (expected spaces)");
}

TEST(ParseYaml, TakesTabsThatIndentNothing) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3", "cycles: 3\t# tab\n\t# a comment\n\t")), "");
}

TEST(ParseYaml, TakesTheSpacesOfWebPagesForSpaces) {
  std::string text = GoodSchedule();
  for (std::size_t at = 0; (at = text.find(' ', at)) != text.npos; at += 2) text.replace(at, 1, "\u00A0");
  EXPECT_EQ(MessageOf(text), "");
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "cycles: 3", "\uFEFFcycles:\u20093\u202F")), "");
}

TEST(ParseYaml, SaysWhereItIsNotYaml) {
  EXPECT_EQ(MessageOf("a: b: c\n"),
            "small.yaml:1:5: error: not YAML: illegal map value (expected 'key: value' lines)");
  EXPECT_EQ(MessageOf("schedule: 1\nname: [a, b\n"),
            "small.yaml:3:1: error: not YAML: end of sequence flow not found (expected 'key: value' lines)");
}

TEST(ParseYaml, SaysThatAFileIsEmpty) {
  const std::string expected =
      "small.yaml:1:1: error: the file is empty (expected a schedule that begins with 'schedule: 1')";
  EXPECT_EQ(MessageOf(""), expected);
  EXPECT_EQ(MessageOf("\n  \n# only a comment\n\r\n"), expected);
  EXPECT_EQ(MessageOf("\xef\xbb\xbf"), expected);
}

TEST(ParseYaml, SaysThatAFileIsSomethingElse) {
  const std::string expected =
      "small.yaml:1:1: error: not a schedule (expected 'key: value' lines that begin with 'schedule: 1')";
  EXPECT_EQ(MessageOf("just words"), expected);
  EXPECT_EQ(MessageOf("[1, 2]"), expected);
  EXPECT_EQ(MessageOf("---\n").substr(0, 32), "small.yaml:2:1: error: not a sch");
}

TEST(ParseYaml, RefusesBytesThatAreNotText) {
  EXPECT_EQ(MessageOf("a: \x04 b\n"), "small.yaml:1:4: error: byte 0x04 is not text (expected UTF-8)");
  EXPECT_EQ(MessageOf("a: 1\nb: \xff\n"), "small.yaml:2:4: error: byte 0xff is not text (expected UTF-8)");
  EXPECT_EQ(MessageOf(std::string("\0", 1)), "small.yaml:1:1: error: byte 0x00 is not text (expected UTF-8)");
  // Overlong '/', half a surrogate pair, beyond U+10FFFF, cut off.
  for (const char* bytes : {"\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"}) {
    EXPECT_NE(MessageOf(bytes).find("is not text (expected UTF-8)"), std::string::npos);
  }
}

TEST(ParseYaml, TakesUtf8WithOrWithoutAMark) {
  EXPECT_EQ(MessageOf(With(GoodSchedule(), "size 20", "größe 20 – ø 🙂")), "");
  EXPECT_EQ(MessageOf("\xef\xbb\xbf" + GoodSchedule()), "");
}

TEST(ParseYaml, TakesLinesThatEndAsOnWindows) {
  std::string text;
  for (const char c : GoodSchedule()) {
    if (c == '\n') text += '\r';
    text += c;
  }
  EXPECT_EQ(MessageOf(text), "");
}

TEST(ParseYaml, RefusesAliasesSoThatNothingMultiplies) {
  EXPECT_EQ(MessageOf("a: &x [1, 1]\nb: &y [*x, *x]\nc: [*y, *y]\n"),
            "small.yaml:1:4: error: anchor (expected plain values)\n"
            "small.yaml:2:4: error: anchor (expected plain values)\n"
            "small.yaml:2:8: error: alias (expected the value itself)\n"
            "small.yaml:2:12: error: alias (expected the value itself)\n"
            "small.yaml:3:5: error: alias (expected the value itself)\n"
            "small.yaml:3:9: error: alias (expected the value itself)");
}

TEST(ParseYaml, RefusesTagsAndSecondDocuments) {
  EXPECT_EQ(
      MessageOf("schedule: !version 1\n"),
      "small.yaml:1:11: error: tag (expected plain values; a text that begins with '!' stands in quotes)");
  EXPECT_EQ(MessageOf("schedule: 1\n---\nname: b\n"),
            "small.yaml:2:1: error: a second document begins (expected one in a file)");
}

TEST(ParseYaml, RefusesWhatIsNestedWithoutEnd) {
  std::string brackets, items, keys, indented;
  for (int i = 0; i < 1000; ++i) {
    brackets += "[\n";
    items += "- ";
    keys += "? ";
    indented += std::string(static_cast<std::size_t>(i), ' ') + "a:\n";
  }
  for (const std::string& text : {brackets, items, keys, indented}) {
    const std::string message = MessageOf(text);
    EXPECT_TRUE(message.ends_with(": error: nested too deeply (expected at most 16 levels)")) << message;
  }
  EXPECT_EQ(MessageOf(indented), "small.yaml:17:17: error: nested too deeply (expected at most 16 levels)");
}

TEST(ParseYaml, RefusesMoreValuesThanAnyScheduleHas) {
  std::string text = "a:\n";
  for (int i = 0; i < 200'000; ++i) text += "-\n";
  EXPECT_EQ(MessageOf(text), "small.yaml:100000:1: error: more than 100000 values (expected a few hundred)");
}

TEST(ReadInputFile, RefusesAHundredMegabytesUnread) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / "strainwave_hundred_megabytes.yaml";
  { std::ofstream(path) << GoodSchedule(); }
  std::filesystem::resize_file(path, 100'000'000);  // a hole: no byte of it is ever on the disk
  const std::string message = MessageOfFile(path);
  std::filesystem::remove(path);
  EXPECT_EQ(message,
            path.string() + ":1:1: error: 100.0 MB is too much for a schedule (expected at most 1 MiB)");
}

TEST(ParseYaml, RefusesATextThatIsTooLarge) {
  EXPECT_EQ(MessageOf(std::string(std::size_t{2} << 20U, ' ')),
            "small.yaml:1:1: error: 2.1 MB is too much for a schedule (expected at most 1 MiB)");
}

TEST(ReadInputFile, SaysThatAFileIsMissingOrAFolder) {
  EXPECT_EQ(MessageOfFile("no/such.yaml"),
            "no/such.yaml: error: cannot be read: No such file or directory (expected a schedule file)");
  EXPECT_EQ(MessageOfFile("/"), "/: error: cannot be read: it is a folder (expected a schedule file)");
}

TEST(ReadInputFile, StopsReadingWhatNeverEnds) {
  if (!std::filesystem::exists("/dev/zero")) GTEST_SKIP() << "skipped, because there is no /dev/zero here";
  EXPECT_TRUE(MessageOfFile("/dev/zero").ends_with("is too much for a schedule (expected at most 1 MiB)"));
}

// Damage at any place is either taken or refused with a place; nothing else gets out.
TEST(ParseYaml, EndsInAResultOrFindingsForAnyDamage) {
  const std::string good = GoodSchedule();
  const std::string bits = "\t\n :-[]{}&*!|>'\"%@`#?,~\x7f\x80\xc3 09";
  std::uint32_t state = 12345;
  const auto next = [&](std::size_t below) {
    state = state * 1664525U + 1013904223U;
    return static_cast<std::size_t>(state >> 8U) % below;
  };
  int refused = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    std::string text = good;
    for (std::size_t edits = next(4) + 1; edits > 0; --edits) {
      const std::size_t place = next(text.size());
      switch (next(3)) {
        case 0:
          text[place] = bits[next(bits.size())];
          break;
        case 1:
          text.erase(place, next(40));
          break;
        default:
          text.insert(text.begin() + static_cast<std::ptrdiff_t>(place), bits[next(bits.size())]);
      }
    }
    const std::string message = MessageOf(text);
    refused += message.empty() ? 0 : 1;
    EXPECT_TRUE(message.empty() || message.starts_with("small.yaml:")) << text;
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace strainwave::schedules::yaml_node_test
