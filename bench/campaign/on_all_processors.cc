// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/on_all_processors.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <new>
#include <system_error>
#include <thread>

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace strainwave::bench {

struct ProcessorLimit::Control {
  tbb::global_control threads;
};

ProcessorLimit::ProcessorLimit(std::size_t most)
    : control_(new Control{{tbb::global_control::max_allowed_parallelism, most}}) {
  // Each task waits until all are there, for which the library has to make its threads.
  constexpr std::chrono::milliseconds kPatience{200};
  const auto until = std::chrono::steady_clock::now() + kPatience;
  const std::size_t threads =
      std::min(most, static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  std::atomic<std::size_t> there{0};
  try {
    OnAllProcessors(threads, [&](std::size_t) {
      ++there;
      while (there < threads && std::chrono::steady_clock::now() < until) std::this_thread::yield();
    });
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception&) {
    // What the library says when there is no other thread to be had is in words of its own.
    throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
  }
}
ProcessorLimit::~ProcessorLimit() = default;

void OnAllProcessors(std::size_t count, const std::function<void(std::size_t)>& task) {
  // A thread that waits here for others takes on no task of another call: that one might wait for this
  // thread.
  tbb::this_task_arena::isolate([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) task(i);
        },
        tbb::simple_partitioner());
  });
}

}  // namespace strainwave::bench
