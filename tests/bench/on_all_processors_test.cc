// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/on_all_processors.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <array>
#include <atomic>
#include <stdexcept>
#include <thread>

namespace strainwave::bench::on_all_processors_test {
namespace {

TEST(OnAllProcessors, DoesEveryTaskOnceTasksOfTasksAsWell) {
  std::array<std::array<std::atomic<int>, 30>, 20> done{};
  OnAllProcessors(done.size(), [&](std::size_t i) {
    OnAllProcessors(done[i].size(), [&](std::size_t k) { ++done[i][k]; });
  });
  OnAllProcessors(0, [](std::size_t) { FAIL(); });
  for (const auto& row : done) {
    for (const std::atomic<int>& times : row) EXPECT_EQ(times, 1);
  }
}

// Such a task may wait for what this very thread was about to do. With two threads none is ever left to take
// on.
TEST(OnAllProcessors, AThreadThatWaitsTakesOnNoTaskOfAnotherCall) {
  static thread_local bool waits = false;
  constexpr int kThreads = 6;
  const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, kThreads);
  std::atomic<int> taken_on{0};
  tbb::task_arena(kThreads).execute([&] {
    OnAllProcessors(400, [&](std::size_t) {
      if (waits) ++taken_on;
      waits = true;
      std::atomic<std::size_t> sum{0};
      OnAllProcessors(3, [&](std::size_t k) {
        for (std::size_t i = 0; i < 20'000; ++i) sum += k;
      });
      waits = false;
    });
  });
  EXPECT_EQ(taken_on, 0);
}

TEST(OnAllProcessors, ThrowsAgainWhatATaskThrew) {
  try {
    OnAllProcessors(100, [](std::size_t i) {
      if (i == 17) throw std::runtime_error("no. 17");
    });
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "no. 17");
  }
}

TEST(ProcessorLimit, HoldsWhileItLives) {
  const ProcessorLimit one(1);
  const std::thread::id here = std::this_thread::get_id();
  std::atomic<int> elsewhere{0};
  OnAllProcessors(1000, [&](std::size_t) { elsewhere += std::this_thread::get_id() == here ? 0 : 1; });
  EXPECT_EQ(elsewhere, 0);
}

}  // namespace
}  // namespace strainwave::bench::on_all_processors_test
