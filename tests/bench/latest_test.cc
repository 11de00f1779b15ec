// SPDX-License-Identifier: Apache-2.0
#include "bench/realtime/latest.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace strainwave::bench::latest_test {
namespace {

struct Three {
  std::uint64_t number{}, twice{};
  double half{};
};

TEST(Latest, IsTheDefaultUntilThereIsAValue) {
  const Latest<Three> latest;
  EXPECT_EQ(latest.Get().number, 0U);
}

TEST(Latest, IsWhatWasSetLast) {
  Latest<Three> latest;
  for (std::uint64_t i = 1; i < 20; ++i) {
    latest.Set({i, 2 * i, static_cast<double>(i) / 2});
    EXPECT_EQ(latest.Get().number, i);
    EXPECT_EQ(latest.Get().half, static_cast<double>(i) / 2);
  }
}

TEST(Latest, IsNeverHalfOfOneAndHalfOfAnother) {
  constexpr std::uint64_t kLast = 300'000;
  Latest<Three> latest;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kLast; ++i) latest.Set({i, 2 * i, static_cast<double>(i) / 2});
  });
  std::uint64_t before = 0;
  int torn = 0, backwards = 0;
  while (before < kLast) {
    const Three three = latest.Get();
    torn += three.twice != 2 * three.number || three.half != static_cast<double>(three.number) / 2;
    backwards += three.number < before;
    before = three.number;
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_EQ(backwards, 0);
}

}  // namespace
}  // namespace strainwave::bench::latest_test
