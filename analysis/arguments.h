// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string_view>

namespace strainwave::analysis {

/// Argument checks of this folder: each throws std::invalid_argument with the argument, its value and the
/// rule.
inline void RequireFinite(std::string_view name, double value) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(fmt::format("{} = {} is not finite", name, value));
  }
}

inline void RequireFinite(std::string_view name, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw std::invalid_argument(fmt::format("{}[{}] = {} is not finite", name, i, values[i]));
    }
  }
}

inline void RequirePositive(std::string_view name, double value) {
  if (!(std::isfinite(value) && value > 0.0)) {
    throw std::invalid_argument(fmt::format("{} = {} is not a positive number", name, value));
  }
}

inline void RequireNotNegative(std::string_view name, double value) {
  if (!(std::isfinite(value) && value >= 0.0)) {
    throw std::invalid_argument(fmt::format("{} = {} is not a number from 0 up", name, value));
  }
}

inline void RequireSameLength(std::string_view name, std::span<const double> values,
                              std::string_view other_name, std::span<const double> others) {
  if (values.size() != others.size()) {
    throw std::invalid_argument(fmt::format("{} has {} values, {} has {} (expected the same number)", name,
                                            values.size(), other_name, others.size()));
  }
}

inline void RequireAtLeast(std::string_view name, std::span<const double> values, std::size_t minimum) {
  if (values.size() < minimum) {
    throw std::invalid_argument(
        fmt::format("{} has {} values (expected at least {})", name, values.size(), minimum));
  }
}

}  // namespace strainwave::analysis
