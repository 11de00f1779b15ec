// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <list>
#include <mutex>
#include <utility>

namespace strainwave::analysis::diagnosis {

/// The values that were asked for last, so that none of them is worked out twice. For several threads at
/// once: each works out what it asks for.
template <typename Key, typename Value>
class Recent {
 public:
  /// @param most  values that are kept; two at least
  explicit Recent(std::size_t most) : most_(std::max<std::size_t>(2, most)) {}

  /// The value of a key, made by `make()` where it is not known. It stays until `most` others were asked for.
  template <typename Make>
  Value Get(const Key& key, Make make) {
    {
      const std::lock_guard looking(mutex_);
      const auto known = std::ranges::find(kept_, key, &Kept::first);
      if (known != kept_.end()) {
        kept_.splice(kept_.begin(), kept_, known);
        return known->second;
      }
    }
    Value made = make();
    const std::lock_guard keeping(mutex_);
    kept_.emplace_front(key, made);
    if (kept_.size() > most_) kept_.pop_back();
    return made;
  }

 private:
  using Kept = std::pair<Key, Value>;
  std::size_t most_;
  std::mutex mutex_;
  std::list<Kept> kept_;  // the last used first
};

}  // namespace strainwave::analysis::diagnosis
