// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/on_all_processors.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace strainwave::bench {

struct ProcessorLimit::Control {
  tbb::global_control threads;
};

ProcessorLimit::ProcessorLimit(std::size_t most)
    : control_(new Control{{tbb::global_control::max_allowed_parallelism, most}}) {}
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
