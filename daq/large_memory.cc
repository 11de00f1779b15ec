// SPDX-License-Identifier: Apache-2.0
#include "daq/large_memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>

namespace strainwave::daq {

void PreferLargePages(void* memory, std::size_t bytes) noexcept {
  constexpr std::size_t kWorthwhile_bytes = std::size_t{4} << 20;
  if (bytes < kWorthwhile_bytes) return;
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::uintptr_t>(memory) + page - 1) / page * page;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + bytes) / page * page;
  // An advice: where it is not taken everything is as before.
  (void)::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace strainwave::daq
