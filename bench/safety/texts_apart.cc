// SPDX-License-Identifier: Apache-2.0
#include "bench/safety/texts_apart.h"

#include <algorithm>

#include <fmt/format.h>

namespace strainwave::bench {

std::vector<std::string> TextsApart(double value, const std::vector<double>& others, int decimals) {
  constexpr int kMostDecimals = 9;
  for (;; ++decimals) {
    std::vector<std::string> texts{fmt::format("{:.{}f}", value, decimals)};
    for (const double other : others) texts.push_back(fmt::format("{:.{}f}", other, decimals));
    const bool alike = std::find(texts.begin() + 1, texts.end(), texts.front()) != texts.end();
    if (!alike || decimals >= kMostDecimals) return texts;
  }
}

}  // namespace strainwave::bench
