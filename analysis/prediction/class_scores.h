// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace strainwave::analysis::prediction {

/// The area under the curve of the share of faults found over the share of false alarms: how often a record
/// of class 1 has a higher score than one of class 0, equal ones counting half. NaN where a class is missing.
/// @param actual  0 or 1.
/// @throws std::invalid_argument if the lengths differ.
///
/// Source: docs/sources.md#hanley-1982.
double AreaUnderCurve(std::span<const int> actual, std::span<const double> score);

/// An interval for a share that was counted in independent cases.
struct ShareInterval {
  double low{};
  double high{};
};
/// Of `hits` in `cases`, with 95 % confidence. @throws std::invalid_argument unless 0 ≤ hits ≤ cases, and a
/// case.
///
/// Source: docs/sources.md#wilson-1927.
ShareInterval WilsonInterval(double hits, double cases);

}  // namespace strainwave::analysis::prediction
