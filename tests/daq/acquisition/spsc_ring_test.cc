// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/spsc_ring.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <random>
#include <thread>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::spsc_ring_test {
namespace {

TEST(SpscRing, GivesWhatWasWrittenInOrderAndCountsWhatFoundNoRoom) {
  std::mt19937 random(3);
  SpscRing<int> ring(5, 0);
  std::deque<int> expected;  // a ring by another route
  std::uint64_t refused = 0;
  for (int i = 0; i < 20000; ++i) {
    if (random() % 2 == 0) {
      int* const slot = ring.BeginWrite();
      ASSERT_EQ(slot == nullptr, expected.size() == 5) << i;
      if (slot == nullptr) {
        ++refused;
        continue;
      }
      *slot = i;
      ring.EndWrite();
      expected.push_back(i);
    } else {
      int* const slot = ring.BeginRead();
      ASSERT_EQ(slot == nullptr, expected.empty()) << i;
      if (slot == nullptr) continue;
      ASSERT_EQ(*slot, expected.front());
      ring.EndRead();
      expected.pop_front();
    }
    ASSERT_EQ(ring.unread(), expected.size());
  }
  EXPECT_GT(refused, 100U);
  EXPECT_EQ(ring.overruns(), refused);
}

TEST(SpscRing, DoesNotOverwriteWhatWasNotRead) {
  SpscRing<int> ring(2, 0);
  for (int i = 1; i <= 5; ++i) {
    if (int* const slot = ring.BeginWrite()) {
      *slot = i;
      ring.EndWrite();
    }
  }
  EXPECT_EQ(*ring.BeginRead(), 1);
  ring.EndRead();
  EXPECT_EQ(*ring.BeginRead(), 2);
  EXPECT_EQ(ring.overruns(), 3U);
}

// Each slot is written word by word, so that a slot handed over too early shows as one that is torn.
TEST(SpscRing, HoldsBetweenTwoThreads) {
  struct Item {
    std::array<std::uint64_t, 16> words{};
  };
  constexpr std::uint64_t kItems = 200000;
  SpscRing<Item> ring(64, Item{});
  std::uint64_t refused = 0;
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kItems;) {
      Item* const item = ring.BeginWrite();
      if (item == nullptr) {
        ++refused;
        std::this_thread::yield();
        continue;
      }
      for (std::size_t k = 0; k < item->words.size(); ++k) item->words[k] = i * item->words.size() + k;
      ring.EndWrite();
      ++i;
    }
  });
  std::uint64_t torn = 0;
  for (std::uint64_t i = 0; i < kItems;) {
    const Item* const item = ring.BeginRead();
    if (item == nullptr) {
      std::this_thread::yield();
      continue;
    }
    for (std::size_t k = 0; k < item->words.size(); ++k) torn += item->words[k] != i * item->words.size() + k;
    ring.EndRead();
    ++i;
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(ring.overruns(), refused);
  EXPECT_EQ(ring.BeginRead(), nullptr);
}

TEST(SpscRing, RefusesToHoldNothing) {
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { SpscRing<int>(0, 0); }), "slots = 0 is not above zero");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::spsc_ring_test
