// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// What one core of this machine can do at most, by loops that do nothing else; as wide as Highway's are.
namespace strainwave::peaks {

/// Products and sums in one instruction where the machine has it, `rounds` for each of so many independent
/// sums.
/// @return how many operations on numbers these were.
double MultiplyAdd(std::size_t rounds, float& result);
double MultiplyAdd(std::size_t rounds, double& result);

}  // namespace strainwave::peaks
