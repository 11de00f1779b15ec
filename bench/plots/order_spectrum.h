// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "analysis/transmission_error.h"

namespace strainwave::bench {

/// Where the order spectrum stands on the picture, in shares of its width and height.
struct SpectrumFrame {
  double left{}, right{}, bottom{}, top{};
  /// Left edge of the list of named orders.
  double list_left{};
};

/// The data blocks and the commands that draw amplitude over order inside a multiplot; `last` may be empty.
struct SpectrumScript {
  std::string data;
  std::string commands;
};
SpectrumScript MakeSpectrumScript(std::span<const analysis::OrderLine> first,
                                  std::span<const analysis::OrderLine> last, const SpectrumFrame& frame);

}  // namespace strainwave::bench
