// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/texts_apart.h"

#include <gtest/gtest.h>

namespace strainwave::bench::texts_apart_test {
namespace {

using Texts = std::vector<std::string>;

TEST(TextsApart, HasAsManyDecimalsAsItTakes) {
  EXPECT_EQ(TextsApart(25.04, {25.0}, 1), (Texts{"25.04", "25.00"}));
  EXPECT_EQ(TextsApart(31.7, {25.0}, 1), (Texts{"31.7", "25.0"}));
  EXPECT_EQ(TextsApart(15803.4, {15200.0, 15803.0}, 0), (Texts{"15803.4", "15200.0", "15803.0"}));
}

TEST(TextsApart, EndsWhereTheTwoAreOne) { EXPECT_EQ(TextsApart(1.5, {1.5}, 2).front(), "1.500000000"); }

}  // namespace
}  // namespace strainwave::bench::texts_apart_test
