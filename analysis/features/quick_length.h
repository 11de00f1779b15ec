// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

namespace strainwave::analysis::features {

/// The largest even length up to this one that the discrete Fourier transform is quick for: factors 2, 3 and
/// 5 alone; 2 at least.
std::size_t QuickLength(std::size_t length);

}  // namespace strainwave::analysis::features
