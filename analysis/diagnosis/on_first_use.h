// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>
#include <optional>

namespace strainwave::analysis::diagnosis {

/// A value that is made when it is first asked for, by one thread, while others that ask wait for it.
template <typename Value>
class OnFirstUse {
 public:
  /// @param make  gives the value, or anything that it can be constructed from
  template <typename Make>
  const Value& Get(Make make) const {
    std::call_once(made_, [&] { value_.emplace(make()); });
    return *value_;
  }

 private:
  mutable std::once_flag made_;
  mutable std::optional<Value> value_;
};

}  // namespace strainwave::analysis::diagnosis
