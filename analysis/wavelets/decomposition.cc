// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/decomposition.h"

#include <fmt/format.h>

#include <stdexcept>

namespace strainwave::analysis::wavelets {

void Decompose(std::span<const double> signal, const FilterBank& bank, Border border, int levels,
               Details details, Decomposition& out) {
  if (levels < 1 || levels > kMostLevels) {
    throw std::invalid_argument(fmt::format("levels = {} is not in 1 to {}", levels, kMostLevels));
  }
  const auto count = static_cast<std::size_t>(levels);
  out.approximations.resize(count);
  out.details.resize(count);
  for (std::size_t level = 0; level < count; ++level) {
    const std::size_t length = CoefficientCount(signal.size(), bank.length(), border);
    out.approximations[level].resize(length);
    out.details[level].resize(details == Details::kKeep ? length : 0);
    Transform(signal, bank, border, out.approximations[level], out.details[level]);
    signal = out.approximations[level];
  }
}

std::vector<double> Reconstruct(const Decomposition& decomposition, const FilterBank& bank, Border border,
                                std::size_t samples) {
  const std::size_t levels = decomposition.details.size();
  if (levels == 0 || decomposition.approximations.size() != levels) {
    throw std::invalid_argument(
        fmt::format("decomposition has {} approximations and {} details (expected as many)",
                    decomposition.approximations.size(), levels));
  }
  std::vector<double> coarse = decomposition.approximations.back();
  for (std::size_t level = levels; level-- > 0;) {
    std::vector<double> fine(SampleCount(coarse.size(), bank.length(), border));
    InverseTransform(coarse, decomposition.details[level], bank, border, fine);
    // An odd length came back one longer.
    const std::size_t length = level == 0 ? samples : decomposition.details[level - 1].size();
    if (length > fine.size()) {
      throw std::invalid_argument(
          fmt::format("level {} gives {} samples back (expected {})", level + 1, fine.size(), length));
    }
    fine.resize(length);
    coarse = std::move(fine);
  }
  return coarse;
}

}  // namespace strainwave::analysis::wavelets
