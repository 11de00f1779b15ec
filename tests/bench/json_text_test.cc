// SPDX-License-Identifier: Apache-2.0
#include "bench/json_text.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench::json_text_test {
namespace {

std::string Repeated(std::string_view text, std::size_t times) {
  std::string result;
  for (std::size_t i = 0; i < times; ++i) result += text;
  return result;
}

std::string RefusalOf(const std::string& text) {
  try {
    ParseJson(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

std::string Keys(int count) {
  std::string text = "{";
  for (int i = 0; i < count; ++i) text += (i == 0 ? "\"k" : ",\"k") + std::to_string(i) + "\":1";
  return text + "}";
}

TEST(JsonText, ReadsWhatIsThere) {
  EXPECT_EQ(ParseJson(R"({"b": [1, {"c": null}], "a": "x"})").dump(), R"({"b":[1,{"c":null}],"a":"x"})");
  EXPECT_EQ(ParseUnorderedJson(R"({"b": 1, "a": 2})").dump(), R"({"a":2,"b":1})");
  EXPECT_THROW(ParseJson("{"), nlohmann::json::parse_error);
}

TEST(JsonText, RefusesWhatIsNestedTooDeeply) {
  EXPECT_EQ(RefusalOf(Repeated("[", 100) + Repeated("]", 100)), "accepted");
  EXPECT_EQ(RefusalOf(Repeated("[", 101) + Repeated("]", 101)), "it is nested more than 100 levels deep");
  EXPECT_EQ(RefusalOf(Repeated(R"({"a":)", 50'000'000 / 5)), "it is nested more than 100 levels deep");
}

TEST(JsonText, RefusesObjectsOfTooManyKeys) {
  EXPECT_EQ(RefusalOf("[" + Keys(10'000) + "," + Keys(1) + "]"), "accepted");
  EXPECT_EQ(RefusalOf(Keys(10'001)), "an object has more than 10000 keys");
  EXPECT_EQ(RefusalOf("[" + Repeated(R"({"a":1},)", 1'000'000) + "1]"), "accepted");
  EXPECT_EQ(RefusalOf("[" + Repeated(R"({"a":1},)", 1'000'001) + "1]"), "it has more than 1000000 keys");
}

TEST(JsonText, ShortensAValueForAMessage) {
  EXPECT_EQ(ShortText({{"a", {1, "x"}}}), R"({"a":[1,"x"]})");
  EXPECT_EQ(ShortText(std::string(58, 'x')), '"' + std::string(58, 'x') + '"');
  EXPECT_EQ(ShortText(std::string(59, 'x')), '"' + std::string(59, 'x') + "...");
}

TEST(JsonText, RefusesTextsThatAreTooLong) {
  EXPECT_EQ(RefusalOf("[" + std::string(std::size_t{64} << 20U, ' ')),
            "67108865 bytes of JSON are too many, at most 64 MiB are read");
}

}  // namespace
}  // namespace strainwave::bench::json_text_test
