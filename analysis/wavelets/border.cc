// SPDX-License-Identifier: Apache-2.0
#include "analysis/wavelets/border.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace strainwave::analysis::wavelets {
namespace {

constexpr std::array<std::pair<std::string_view, Border>, 3> kNames{
    {{"symmetric", Border::kSymmetric}, {"periodization", Border::kPeriodization}, {"zero", Border::kZero}}};

std::ptrdiff_t Modulo(std::ptrdiff_t value, std::ptrdiff_t period) {
  const std::ptrdiff_t rest = value % period;
  return rest < 0 ? rest + period : rest;
}

}  // namespace

Border BorderOf(std::string_view name) {
  for (const auto& [own, border] : kNames) {
    if (own == name) return border;
  }
  throw std::invalid_argument(
      fmt::format("mode = '{}' is not known (expected symmetric, periodization or zero)", name));
}

std::string_view NameOf(Border border) {
  return std::ranges::find(kNames, border, &std::pair<std::string_view, Border>::second)->first;
}

std::ptrdiff_t InsideIndex(std::ptrdiff_t index, std::ptrdiff_t n, Border border) {
  if (index >= 0 && index < n) return index;
  switch (border) {
    case Border::kSymmetric: {
      const std::ptrdiff_t folded = Modulo(index, 2 * n);
      return folded < n ? folded : 2 * n - 1 - folded;
    }
    case Border::kPeriodization:
      return std::min(Modulo(index, n + n % 2), n - 1);
    case Border::kZero:
      return -1;
  }
  return -1;
}

}  // namespace strainwave::analysis::wavelets
