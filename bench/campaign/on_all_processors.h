// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace strainwave::bench {

/// Calls task(0) … task(count − 1) on all processors, this thread among them, and comes back when all are
/// done. After an exception no further task is begun; the first one is thrown again here. A task may call it
/// in turn.
void OnAllProcessors(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace strainwave::bench
