// SPDX-License-Identifier: Apache-2.0
#include "analysis/one_turn.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "analysis/units.h"

namespace strainwave::analysis {

TurnCurve OneTurn(const SweepError& sweep) {
  const std::size_t samples = std::min(sweep.output_angle_rad.size(), sweep.error_rad.size());
  std::vector<double> angle_deg(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double turned_deg = DegFromRad(sweep.output_angle_rad[i]);
    angle_deg[i] = turned_deg - 360.0 * std::floor(turned_deg / 360.0);
  }
  std::vector<std::size_t> rank(samples);
  std::iota(rank.begin(), rank.end(), std::size_t{0});
  std::stable_sort(rank.begin(), rank.end(),
                   [&](std::size_t a, std::size_t b) { return angle_deg[a] < angle_deg[b]; });
  TurnCurve curve;
  for (const std::size_t i : rank) {
    curve.angle_deg.push_back(angle_deg[i]);
    curve.error_arcmin.push_back(ArcminFromRad(sweep.error_rad[i]));
  }
  return curve;
}

}  // namespace strainwave::analysis
