// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "analysis/diagnosis/transmission_error/terms.h"

namespace strainwave::analysis::diagnosis {

/// An order per turn of the output, and what makes it.
struct NamedOrder {
  double order{};
  std::string name;
};

/// What keeps samples on one grid of even steps from telling amplitude and phase of an order: it is the same
/// at each of them, or changes sign from one to the next, or is one line with another order. Empty where
/// nothing does, and where the samples are on no grid.
std::string WhyNotSeen(const TransmissionErrorSamples& samples, double order,
                       const std::vector<NamedOrder>& others);

}  // namespace strainwave::analysis::diagnosis
