// SPDX-License-Identifier: Apache-2.0
#include "bench/realtime/timing_histogram.h"

#include <algorithm>
#include <bit>

#include <fmt/core.h>

namespace strainwave::bench {

// Below kSteps one nanosecond a bin; above, the power of two and the four bits that follow its leading one.
std::size_t TimingHistogram::BinOf(std::uint64_t nanoseconds) noexcept {
  constexpr int kStepBits = std::bit_width(static_cast<unsigned>(kSteps)) - 1;
  if (nanoseconds < kSteps) return static_cast<std::size_t>(nanoseconds);
  const int shift = static_cast<int>(std::bit_width(nanoseconds)) - 1 - kStepBits;
  const std::uint64_t step = nanoseconds >> shift;  // kSteps to 2 kSteps − 1
  const auto bin = static_cast<std::size_t>(kSteps * shift) + static_cast<std::size_t>(step);
  return std::min(bin, static_cast<std::size_t>(kSteps * kPowers - 1));
}

std::uint64_t TimingHistogram::EndOf(std::size_t bin) noexcept {
  if (bin < 2 * kSteps) return bin;
  const std::size_t shift = bin / kSteps - 1;
  const std::uint64_t step = bin - kSteps * shift;
  return ((step + 1) << shift) - 1;
}

void TimingHistogram::Add(std::chrono::nanoseconds duration) noexcept {
  const auto nanoseconds = std::max<std::int64_t>(0, duration.count());
  ++bins_[BinOf(static_cast<std::uint64_t>(nanoseconds))];
  ++count_;
  longest_ = std::max(longest_, duration);
}

std::chrono::nanoseconds TimingHistogram::Percentile(double share) const noexcept {
  const double wanted = share * static_cast<double>(count_);
  std::uint64_t so_far = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    so_far += bins_[bin];
    if (so_far > 0 && static_cast<double>(so_far) >= wanted) {
      // The last bin holds everything beyond, too.
      const bool last = bin + 1 == bins_.size();
      return last ? longest_
                  : std::min(longest_, std::chrono::nanoseconds(static_cast<std::int64_t>(EndOf(bin))));
    }
  }
  return longest_;
}

std::string TimingHistogram::Text() const {
  const auto ms = [](std::chrono::nanoseconds duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
  };
  return fmt::format("p50 {:.3f} ms, p99 {:.3f} ms, p99.9 {:.3f} ms, max {:.3f} ms of {}",
                     ms(Percentile(0.5)), ms(Percentile(0.99)), ms(Percentile(0.999)), ms(longest_), count_);
}

}  // namespace strainwave::bench
