// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/settled_grid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "analysis/diagnosis/motion/grid.h"

namespace strainwave::analysis::diagnosis {
namespace {

// What is missing is this many standard deviations of the noise or less, where all samples are looked at:
// more shows in the low-pass as well, in less time, and what is fast about it is known less well than noise.
constexpr double kFaint = 50.0;
constexpr double kAsNarrow = 1.01;
// Of the torque's noise, what the last half octave of the acceleration makes of it there: more goes on
// beyond.
constexpr double kEnds = 0.05;
constexpr double kKinked = 0.01;  // of the points, at most
// Of the torque's noise, what the acceleration changes from sample to sample: of a torque that changes by
// more nobody knows which sample stands off.
constexpr double kSteep = 20.0;

// What the nominal model misses beyond noise, in matched-filter terms.
double MissingSigma(const MotionGrid& grid) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  const double squares = grid.Weighted(measured - grid.nominal * grid.prefit).squaredNorm();
  const double expected = std::accumulate(grid.weights.begin(), grid.weights.end(), 0.0);
  return std::sqrt(std::max(squares / (grid.noise_floor * grid.noise_floor) - expected, 0.0));
}

// Whether every sample can be a row: none is made of its neighbours, the path is as sharp as they are, and it
// has no kinks of which there is more than the path can show, nor changes much between two of them.
bool EverySampleIsKnown(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                        const MotionGrid& grid) {
  std::size_t count = 0;
  for (const EvenSegment& segment : samples.segments) {
    if (segment.resampled || !KeepsUpWith(bandwidth, segment.step_s)) return false;
    count += segment.position.size();
  }
  // Of the acceleration, that would make as much of the torque.
  const double noise = grid.noise_floor / std::max(std::abs(bandwidth.inertia), 1e-300);
  const auto kinked = static_cast<double>(std::ranges::count_if(
      grid.last_band, [&](double size) { return std::isfinite(size) && size > kEnds * noise; }));
  std::vector<double> changes(grid.passed_acceleration);
  std::adjacent_difference(changes.begin(), changes.end(), changes.begin());
  return count <= kMostRows && bandwidth.path_sigma_s <= kAsNarrow * bandwidth.sigma_s &&
         kinked <= kKinked * static_cast<double>(count) &&
         QuantileOfMagnitude(changes, 0.95) <= kSteep * noise;
}

}  // namespace

SharedGrid WithoutLowPass(const MotionSamples& samples, MotionBandwidth bandwidth) {
  bandwidth.passes_all = true;
  return std::make_shared<const MotionGrid>(MakeMotionGrid(samples, bandwidth, 0.0, 0.0));
}

SettledGrid MakeSettledGrid(const MotionSamples& samples) {
  const MotionBandwidth bandwidth = ChooseBandwidth(samples, kMostRows);
  const auto make = [&](double expected_delay_s, double reversal_smoothing_delay_s) {
    SettledGrid made{std::make_shared<const MotionGrid>(
                         MakeMotionGrid(samples, bandwidth, expected_delay_s, reversal_smoothing_delay_s)),
                     {}};
    made.delay = EstimateDelay(*made.grid);
    return made;
  };
  SettledGrid first = make(0.0, 0.0);
  const double delay_s = first.delay.delay_s;
  if (delay_s == 0.0) {
    if (EverySampleIsKnown(samples, bandwidth, *first.grid) && MissingSigma(*first.grid) <= kFaint)
      first.grid = WithoutLowPass(samples, bandwidth);
    return first;
  }
  SettledGrid wide = make(delay_s, 0.0);
  SettledGrid sharp = make(delay_s, delay_s);
  // Elements that bend over ways of their own follow a lag of friction as well as they do presliding.
  const double lead = wide.grid->reversal_smoothing.elements.empty()
                          ? 0.0
                          : kClearDetail / static_cast<double>(wide.grid->rows());
  return std::log(sharp.delay.square_sum / wide.delay.square_sum) < lead ? sharp : wide;
}

}  // namespace strainwave::analysis::diagnosis
