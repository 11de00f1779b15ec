// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace strainwave::analysis {

/// Text of the std::invalid_argument that a call throws; says so if it throws none.
template <typename Call>
std::string MessageOf(Call call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no std::invalid_argument";
}

}  // namespace strainwave::analysis
