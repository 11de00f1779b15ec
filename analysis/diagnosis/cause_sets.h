// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

/// Causes of a model as their indices into `Study::causes()`, ascending.
namespace strainwave::analysis::diagnosis {

bool Contains(std::span<const std::size_t> causes, std::size_t cause);

/// The set without one cause, or with one more.
std::vector<std::size_t> Without(std::span<const std::size_t> causes, std::size_t cause);
std::vector<std::size_t> With(std::span<const std::size_t> causes, std::size_t cause);

}  // namespace strainwave::analysis::diagnosis
