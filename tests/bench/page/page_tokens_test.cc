// SPDX-License-Identifier: Apache-2.0
#include "bench/page/tokens.h"

#include <gtest/gtest.h>

namespace strainwave::bench::page_tokens_test {
namespace {

using Answer = Tokens::Answer;

TEST(PageTokens, AreGoodOnceAndThenSayWhatWasDone) {
  Tokens tokens("key");
  const std::string token = tokens.Issue("run 1");
  EXPECT_EQ(tokens.Look(token, "run 1").answer, Answer::kGood);
  EXPECT_EQ(tokens.Look(token, "run 1").answer, Answer::kGood) << "looking changes nothing";
  tokens.Spend(token, "done already at noon");
  const Tokens::Use second = tokens.Look(token, "run 1");
  EXPECT_EQ(second.answer, Answer::kUsed);
  EXPECT_EQ(second.done, "done already at noon");
}

TEST(PageTokens, AreForOneRunOfOneServer) {
  Tokens tokens("key");
  const std::string token = tokens.Issue("run 1");
  EXPECT_EQ(tokens.Look(token, "run 2").answer, Answer::kUnknown);
  EXPECT_EQ(Tokens("another key").Look(token, "run 1").answer, Answer::kUnknown);
}

TEST(PageTokens, CannotBeMadeUp) {
  Tokens tokens("key");
  const std::string token = tokens.Issue("run");
  for (std::size_t i = 0; i < token.size(); ++i) {
    std::string changed = token;
    changed[i] = changed[i] == '0' ? '1' : '0';
    EXPECT_EQ(tokens.Look(changed, "run").answer, Answer::kUnknown) << changed;
    EXPECT_EQ(tokens.Look(token.substr(0, i), "run").answer, Answer::kUnknown) << i;
  }
  EXPECT_EQ(tokens.Look("", "run").answer, Answer::kUnknown);
  EXPECT_EQ(tokens.Look(token + "0", "run").answer, Answer::kUnknown) << "or it would be good twice";
  EXPECT_EQ(tokens.Look("0" + token, "run").answer, Answer::kUnknown);
}

TEST(PageTokens, DifferEachTime) {
  Tokens tokens("key");
  EXPECT_NE(tokens.Issue("run"), tokens.Issue("run"));
}

TEST(PageTokens, AreNotGoodTwiceWhenMoreWereUsedThanAreKept) {
  Tokens tokens("key", 2);
  std::vector<std::string> issued;
  for (int i = 0; i < 4; ++i) issued.push_back(tokens.Issue("run"));
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(tokens.Look(issued[i], "run").answer, Answer::kGood) << i;
    tokens.Spend(issued[i], "done");
  }
  for (const std::string& token : issued) EXPECT_NE(tokens.Look(token, "run").answer, Answer::kGood);
  const std::string first = tokens.Issue("run");
  const std::string second = tokens.Issue("run");
  EXPECT_EQ(tokens.Look(first, "run").answer, Answer::kGood) << "a new one is good";
  tokens.Spend(first, "done");
  EXPECT_EQ(tokens.Look(first, "run").answer, Answer::kUsed) << "there is room again";
  EXPECT_EQ(tokens.Look(second, "run").answer, Answer::kGood);
}

}  // namespace
}  // namespace strainwave::bench::page_tokens_test
