// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "analysis/diagnosis/vibration/samples.h"

namespace strainwave::analysis::diagnosis {

/// The speeds at which a search takes the samples of a record, and what the shaft turns at them.
struct SpeedBand {
  double slowest_rad_per_s{};
  double fastest_rad_per_s{};
  double turns{};  // of the input shaft at these speeds; 0 where there is no band
  double span{};   // turns from the first of them to the last

  bool Holds(double speed_rad_per_s) const {
    return speed_rad_per_s >= slowest_rad_per_s && speed_rad_per_s <= fastest_rad_per_s;
  }
};

/// What a frequency stands at in orders spreads with one over the speed: the slowest turns of a run-up cost a
/// search most of its locations and hold few of the impulses, and at standstill there is no order at all.
/// @returns the band with most of the turns whose work is no more than this; without turns where none with
///          half of them is.
SpeedBand BandWithin(const VibrationRun& run, double most_work,
                     const std::function<double(const SpeedBand& band)>& work);

}  // namespace strainwave::analysis::diagnosis
