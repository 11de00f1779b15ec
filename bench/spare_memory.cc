// SPDX-License-Identifier: Apache-2.0
#include "bench/spare_memory.h"

#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace strainwave::bench {
namespace {

// Blocks that the heap itself holds, so that they serve where the process may have no page more.
constexpr std::size_t kSpareBlock_bytes = 64 * 1024;
// Of glibc's heaps for threads: as long as they are fewer, it asks again how many there may be.
constexpr int kManyHeaps = 1000;

std::atomic<SpareMemory*> kept_spare{};
std::atomic<bool> spare_given_up{};

}  // namespace

SpareMemory::SpareMemory() {
  for (void*& block : blocks_) block = std::malloc(kSpareBlock_bytes);
  if (blocks_.back() == nullptr) {
    Free();
    throw std::bad_alloc();
  }
  ::mallopt(M_ARENA_TEST, kManyHeaps);
  spare_given_up = false;
  kept_spare = this;
  std::set_new_handler(GiveUp);
}

SpareMemory::~SpareMemory() {
  std::set_new_handler(nullptr);
  if (kept_spare.exchange(nullptr) != nullptr) Free();
}

void SpareMemory::Free() {
  for (void* const block : blocks_) std::free(block);
}

// As `operator new` calls it: it tries again after a return.
void SpareMemory::GiveUp() {
  SpareMemory* const spare = kept_spare.exchange(nullptr);
  if (spare == nullptr) throw std::bad_alloc();
  spare_given_up = true;
  // A thread that has no heap of its own yet would want one, and look nowhere else.
  ::mallopt(M_ARENA_MAX, 1);
  spare->Free();
}

void SpareMemory::DemandKept() {
  if (spare_given_up) throw std::bad_alloc();
}

}  // namespace strainwave::bench
