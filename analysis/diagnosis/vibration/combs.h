// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "analysis/diagnosis/vibration/spectrum.h"

namespace strainwave::analysis::diagnosis {

/// Harmonics of one order that stand out together.
struct Comb {
  double order{};
  int first{1};  // harmonics from … to
  int last{1};
  double excess{};    // −ln p of their power, the strongest of them left out: a single line is no comb
  double centre{};    // power-weighted mean harmonic
  double sideband{};  // lines at this distance on both sides of each harmonic count, too; 0 for none
};

/// The best range of harmonics of orders within `range` of one.
Comb CombNear(const VibrationSpectrum& spectrum, double order, double range, double sideband);

/// The comb with its order where its harmonics have most power, within a cell of the highest one.
Comb Refined(const VibrationSpectrum& spectrum, Comb comb);

/// The `count` best combs with orders between two, each a cell of its highest harmonic from the others.
/// @param allowed  says which orders count; others are passed over.
std::vector<Comb> FindCombs(const VibrationSpectrum& spectrum, double lowest, double highest, double sideband,
                            std::size_t count, const std::function<bool(double order)>& allowed);

}  // namespace strainwave::analysis::diagnosis
