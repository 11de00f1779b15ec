// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace strainwave::daq {

/// Asks the kernel for large pages, where the memory is large enough for some. A first touch of many small
/// ones takes longer than what is read into them.
void PreferLargePages(void* memory, std::size_t bytes) noexcept;

/// Room for `count` values in all, on large pages. Grows by a factor, so that many calls cost as one.
template <typename Value>
void ReserveLarge(std::vector<Value>& values, std::size_t count) {
  if (count <= values.capacity()) return;
  const std::size_t twice = 2 * values.capacity();
  values.reserve(count < twice ? twice : count);
  PreferLargePages(values.data(), values.capacity() * sizeof(Value));
}

}  // namespace strainwave::daq
