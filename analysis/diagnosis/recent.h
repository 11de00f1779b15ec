// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <list>
#include <utility>

namespace strainwave::analysis::diagnosis {

/// The values that were asked for last, so that none of them is worked out twice. Not for several threads at
/// once.
template <typename Key, typename Value>
class Recent {
 public:
  /// @param most  values that are kept; two at least
  explicit Recent(std::size_t most) : most_(std::max<std::size_t>(2, most)) {}

  /// The value of a key, made by `make()` where it is not known. It stays until `most` others were asked for.
  template <typename Make>
  const Value& Get(const Key& key, Make make) {
    const auto known = std::ranges::find(kept_, key, &Kept::first);
    if (known != kept_.end()) {
      kept_.splice(kept_.begin(), kept_, known);
    } else {
      kept_.emplace_front(key, make());
      if (kept_.size() > most_) kept_.pop_back();
    }
    return kept_.front().second;
  }

 private:
  using Kept = std::pair<Key, Value>;
  std::size_t most_;
  std::list<Kept> kept_;  // the last used first
};

}  // namespace strainwave::analysis::diagnosis
