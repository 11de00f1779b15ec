// SPDX-License-Identifier: Apache-2.0
#include "daq/history_ring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <stdexcept>

#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::history_ring_test {
namespace {

using Columns = std::vector<std::vector<double>>;

TEST(HistoryRing, GivesWhatWasPushedWhileItFillsUp) {
  HistoryRing ring(3, 2);
  EXPECT_EQ(ring.Unroll(), (Columns{{}, {}}));
  ring.Push(std::vector{1.0, 10.0});
  ring.Push(std::vector{2.0, 20.0});
  EXPECT_EQ(ring.rows(), 2U);
  EXPECT_EQ(ring.Unroll(), (Columns{{1.0, 2.0}, {10.0, 20.0}}));
}

TEST(HistoryRing, KeepsTheLastRowsOldestFirst) {
  HistoryRing ring(7, 1);
  std::deque<double> expected;  // a ring by another route
  for (int i = 0; i < 50; ++i) {
    ring.Push(std::vector{static_cast<double>(i)});
    expected.push_back(i);
    if (expected.size() > 7) expected.pop_front();
    ASSERT_EQ(ring.Unroll().front(), std::vector<double>(expected.begin(), expected.end())) << i;
  }
  EXPECT_EQ(ring.rows(), 7U);
}

TEST(HistoryRing, ForgetsEverythingWhenCleared) {
  HistoryRing ring(3, 1);
  for (int i = 0; i < 5; ++i) ring.Push(std::vector{1.0});
  ring.Clear();
  ring.Push(std::vector{9.0});
  EXPECT_EQ(ring.Unroll(), (Columns{{9.0}}));
}

TEST(HistoryRing, FillsAShortRowWithNanAndCutsALongOne) {
  HistoryRing ring(2, 2);
  ring.Push(std::vector{1.0});
  ring.Push(std::vector{2.0, 3.0, 4.0});
  const Columns columns = ring.Unroll();
  EXPECT_EQ(columns[0], (std::vector{1.0, 2.0}));
  EXPECT_TRUE(std::isnan(columns[1][0]));
  EXPECT_EQ(columns[1][1], 3.0);
}

TEST(HistoryRing, RefusesToKeepNothing) {
  EXPECT_EQ(MessageOf<std::invalid_argument>([] { HistoryRing(0, 2); }),
            "most_rows = 0 and width = 2 are not both above zero");
  EXPECT_THROW(HistoryRing(3, 0), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::daq::history_ring_test
