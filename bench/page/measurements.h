// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/campaign/cycle_curves.h"

namespace strainwave::bench {

/// Points of a curve as they were taken.
struct PlotCurve {
  std::vector<double> x;
  std::vector<double> y;
};

/// At most about `most` points: of each run of neighbours the one with the smallest and the one with the
/// largest y, so that what stands out stays.
PlotCurve Thinned(const PlotCurve& curve, std::size_t most);

/// Of a cycle as the page draws it: `cycle`; `hysteresis` (lock_angle_deg, torque_Nm, twist_arcmin: the
/// gear's own), `transmission_error` (cw and ccw, each angle_deg and error_arcmin), `spectrum` (of each
/// accelerometer frequency_Hz and amplitude_m_per_s2). What the cycle has not measured is null.
nlohmann::json MeasurementsJson(int cycle, const CycleCurves& curves);

/// Of the complete cycle with that number. @param cycle  0: the newest; of a campaign without one all is
/// null.
/// @throws as ReadCycleCurves; std::invalid_argument where that cycle is not complete.
nlohmann::json ReadMeasurements(const CampaignFolder& folder, int cycle);

}  // namespace strainwave::bench
