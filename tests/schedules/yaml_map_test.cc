// SPDX-License-Identifier: Apache-2.0
// Values that only the files of devices have.
#include "schedules/reader/yaml_map.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace strainwave::schedules::yaml_map_test {
namespace {

struct Answer {
  std::int64_t value{};
  std::vector<std::string> names;
  std::string messages;
};

Answer Read(const std::string& text) {
  ReadContext context;
  const auto root = ParseYaml(text, {"drive", "drive: 1"}, context.findings);
  Answer answer;
  if (root) {
    YamlMap map(*root, context);
    answer.value = map.Integer("index", 0, 0xFFFFFFFF, "7");
    answer.names = map.TextList("names");
    map.Finish();
  }
  for (const Finding& finding : context.findings.items()) {
    answer.messages += FormatFinding("f", finding) + "\n";
  }
  return answer;
}

TEST(YamlMapInteger, TakesDecimalAndHexadecimal) {
  EXPECT_EQ(Read("index: 4120\n").value, 4120);
  EXPECT_EQ(Read("index: 0x1018\n").value, 4120);
  EXPECT_EQ(Read("index: 0xFFFFFFFF\n").value, 4294967295);
  EXPECT_EQ(Read("names: a\n").value, 7);
}

TEST(YamlMapInteger, RefusesWhatIsNoWholeNumberInRange) {
  const std::string expected =
      " (expected a whole number from 0 to 4294967295, decimal or 0x and hexadecimal digits)\n";
  for (const char* text : {"0x", "1.5", "0x10g", "ten"}) {
    EXPECT_EQ(Read("index: " + std::string(text) + "\n").messages,
              "f:1:8: error: index = " + std::string(text) + ": not whole" + expected);
  }
  for (const char* text : {"-1", "0x100000000", "99999999999999999999"}) {
    EXPECT_EQ(Read("index: " + std::string(text) + "\n").messages,
              "f:1:8: error: index = " + std::string(text) + ": out of range" + expected);
  }
}

TEST(YamlMapTextList, TakesAListOneTextAndNone) {
  EXPECT_EQ(Read("names: [a, b c]\n").names, (std::vector<std::string>{"a", "b c"}));
  EXPECT_EQ(Read("names: a\n").names, (std::vector<std::string>{"a"}));
  EXPECT_EQ(Read("index: 1\n").names, std::vector<std::string>());
  EXPECT_EQ(Read("names: [a, {b: c}]\n").messages,
            "f:1:12: error: names[1] is a map (expected one line of text)\n");
}

}  // namespace
}  // namespace strainwave::schedules::yaml_map_test
