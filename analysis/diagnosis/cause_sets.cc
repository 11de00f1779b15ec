// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/cause_sets.h"

#include <algorithm>
#include <iterator>

namespace strainwave::analysis::diagnosis {

bool Contains(std::span<const std::size_t> causes, std::size_t cause) {
  return std::find(causes.begin(), causes.end(), cause) != causes.end();
}

std::vector<std::size_t> Without(std::span<const std::size_t> causes, std::size_t cause) {
  std::vector<std::size_t> rest;
  std::copy_if(causes.begin(), causes.end(), std::back_inserter(rest),
               [&](std::size_t other) { return other != cause; });
  return rest;
}

std::vector<std::size_t> With(std::span<const std::size_t> causes, std::size_t cause) {
  std::vector<std::size_t> more(causes.begin(), causes.end());
  more.insert(std::upper_bound(more.begin(), more.end(), cause), cause);
  return more;
}

}  // namespace strainwave::analysis::diagnosis
