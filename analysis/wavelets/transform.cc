// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/transform.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string_view>

#include "analysis/wavelets/polyphase.h"

namespace strainwave::analysis::wavelets {
namespace {

using Index = std::ptrdiff_t;

void RequireCount(std::string_view name, std::size_t got, std::size_t expected) {
  if (got != expected) {
    throw std::invalid_argument(fmt::format("{} has {} places (expected {})", name, got, expected));
  }
}

// The samples at begin, begin + 1, …, beyond the ends as the border says, even and odd ones apart.
void Gather(std::span<const double> signal, Index begin, std::size_t pairs, Border border,
            PolyphaseBlock& block) {
  const auto n = static_cast<Index>(signal.size());
  const auto all = static_cast<Index>(pairs);
  // Pairs that lie within the signal, both of them.
  const Index first = std::clamp<Index>((1 - begin) / 2, 0, all);
  const Index last = std::clamp<Index>(n > begin ? (n - begin) / 2 : 0, first, all);
  const auto gather_beyond = [&](Index from, Index to) {
    for (Index t = 2 * from; t < 2 * to; ++t) {
      const Index index = InsideIndex(begin + t, n, border);
      (t % 2 == 0 ? block.even : block.odd)[t / 2] =
          index < 0 ? 0.0 : signal[static_cast<std::size_t>(index)];
    }
  };
  gather_beyond(0, first);
  if (last > first)
    Deinterleave(signal.data() + begin + 2 * first, static_cast<std::size_t>(last - first),
                 block.even + first, block.odd + first);
  gather_beyond(last, all);
}

// Coefficients at begin, begin + 1, …; only by periodization are some of them outside.
void GatherCircular(std::span<const double> coefficients, Index begin, std::size_t count, double* block) {
  const auto n = static_cast<Index>(coefficients.size());
  for (std::size_t t = 0; t < count; ++t) {
    const Index index = (begin + static_cast<Index>(t)) % n;
    block[t] = coefficients[static_cast<std::size_t>(index < 0 ? index + n : index)];
  }
}

}  // namespace

std::size_t CoefficientCount(std::size_t samples, std::size_t filter_length, Border border) {
  return border == Border::kPeriodization ? (samples + 1) / 2 : (samples + filter_length - 1) / 2;
}

std::size_t SampleCount(std::size_t coefficients, std::size_t filter_length, Border border) {
  if (border == Border::kPeriodization) return 2 * coefficients;
  return 2 * coefficients + 2 > filter_length ? 2 * coefficients + 2 - filter_length : 0;
}

void Transform(std::span<const double> signal, const FilterBank& bank, Border border,
               std::span<double> approximation, std::span<double> detail) {
  if (signal.empty()) throw std::invalid_argument("signal has 0 samples (expected at least 1)");
  const std::size_t count = CoefficientCount(signal.size(), bank.length(), border);
  if (!approximation.empty()) RequireCount("approximation", approximation.size(), count);
  if (!detail.empty()) RequireCount("detail", detail.size(), count);
  const std::size_t half = bank.length() / 2;
  const Index shift = border == Border::kPeriodization ? static_cast<Index>(half) : 1;
  thread_local PolyphaseBlock block;  // kept, since filling it with zeros each time takes time, too
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    const std::size_t here = std::min(kBlock, count - begin);
    Gather(signal, static_cast<Index>(2 * begin) + shift - static_cast<Index>(bank.length()) + 1,
           here + half - 1, border, block);
    // Reversed, the decomposition filters are those of the reconstruction.
    if (!approximation.empty() && !detail.empty()) {
      FilterBoth(block, bank.reconstruction_low.data(), bank.reconstruction_high.data(), half,
                 approximation.data() + begin, detail.data() + begin, here);
    } else if (!approximation.empty()) {
      Filter(block, bank.reconstruction_low.data(), half, approximation.data() + begin, here);
    } else if (!detail.empty()) {
      Filter(block, bank.reconstruction_high.data(), half, detail.data() + begin, here);
    }
  }
}

void InverseTransform(std::span<const double> approximation, std::span<const double> detail,
                      const FilterBank& bank, Border border, std::span<double> signal) {
  RequireCount("detail", detail.size(), approximation.size());
  const std::size_t count = SampleCount(approximation.size(), bank.length(), border);
  if (count == 0) {
    throw std::invalid_argument(
        fmt::format("approximation has {} coefficients (expected at least {} for {})", approximation.size(),
                    border == Border::kPeriodization ? 1 : bank.length() / 2, bank.name));
  }
  RequireCount("signal", signal.size(), count);
  const std::size_t half = bank.length() / 2;
  // Sample p is index p + shift of the full convolution of the coefficients, with zeros between, and the
  // filter.
  const std::size_t shift = border == Border::kPeriodization ? half - 1 : bank.length() - 2;
  CoefficientBlock low;
  CoefficientBlock high;
  double even[kBlock];
  double odd[kBlock];
  const std::size_t last_pair = (shift + count - 1) / 2;
  for (std::size_t pair = shift / 2; pair <= last_pair; pair += kBlock) {
    const std::size_t here = std::min(kBlock, last_pair - pair + 1);
    const Index begin = static_cast<Index>(pair) - static_cast<Index>(half) + 1;
    GatherCircular(approximation, begin, here + half - 1, low.values);
    GatherCircular(detail, begin, here + half - 1, high.values);
    Synthesize(low, high, bank.decomposition_low.data(), bank.decomposition_high.data(), half, even, odd);
    for (std::size_t i = 0; i < here; ++i) {
      const std::size_t index = 2 * (pair + i);
      if (index >= shift && index - shift < count) signal[index - shift] = even[i];
      if (index + 1 >= shift && index + 1 - shift < count) signal[index + 1 - shift] = odd[i];
    }
  }
}

}  // namespace strainwave::analysis::wavelets
