// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/outliers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "analysis/diagnosis/lone_samples.h"
#include "analysis/diagnosis/residuals.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Whether the other passes of a sample's angle, all in all, stand off like it: then it is no outlier but
// something narrow at that angle.
bool ComesAgain(std::span<const double> turn_angles_rad, std::span<const double> residuals,
                std::size_t sample) {
  constexpr double kSameAngle = 0.6;  // of the way to the nearer neighbour
  constexpr double kLike = 0.5;       // of the sample
  if (sample == 0 || sample + 1 >= turn_angles_rad.size()) return false;
  const double reach_rad =
      kSameAngle * std::min(std::abs(turn_angles_rad[sample] - turn_angles_rad[sample - 1]),
                            std::abs(turn_angles_rad[sample + 1] - turn_angles_rad[sample]));
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < turn_angles_rad.size(); ++i) {
    if (i + 1 >= sample && i <= sample + 1) continue;
    if (std::abs(std::remainder(turn_angles_rad[i] - turn_angles_rad[sample], kTwoPi)) > reach_rad) continue;
    sum += residuals[i];
    count += 1.0;
  }
  return count > 0.0 && sum / count / residuals[sample] > kLike;
}

}  // namespace

bool LeaveOutSpikes(const Study& study, const ModelFit& fit, std::vector<double>& weights) {
  if (!study.SpikesAreOutliers()) return false;
  const std::vector<double> residuals = ResidualsOf(study, fit);
  const std::span<const double> turn_angles_rad = study.AnglesOnTurn();
  bool any = false;
  for (std::size_t s = 0; s < study.segments().size(); ++s) {
    const std::size_t first = study.segments()[s];
    const std::size_t last = s + 1 < study.segments().size() ? study.segments()[s + 1] : residuals.size();
    const std::span<const double> segment(residuals.data() + first, last - first);
    for (const auto& found : {FindSpikes(segment, EstimateNoise(segment)), FindLoneSamples(segment)}) {
      for (const std::size_t spike : found) {
        if (ComesAgain(turn_angles_rad, residuals, first + spike)) continue;
        any = any || weights[first + spike] > 0.0;
        weights[first + spike] = 0.0;
      }
    }
  }
  return any;
}

}  // namespace strainwave::analysis::diagnosis
