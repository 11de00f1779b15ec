// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "analysis/statistics/gaussian_process.h"

namespace strainwave::analysis::health {

/// The system's index of a measured value: 0 as healthy, 1 at the limit.
struct SystemScale {
  double healthy{};
  double limit{1.0};

  double Index(double measured) const { return (measured - healthy) / (limit - healthy); }
  double factor() const { return 1.0 / (limit - healthy); }
};

/// A number with the interval that it lies in at 95 %.
struct Bounded {
  double value{};
  double low{};
  double high{};
};

/// Whether intervals are of the surface, or of a new measurement, which has the noise on top.
enum class IntervalOf { kMean, kMeasurement };

/// The system at one state, in its index.
struct SystemAt {
  Bounded index;
  bool extrapolated{};  // outside the convex hull of what was measured
};
/// @param points  p × components.
std::vector<SystemAt> SystemsAt(const statistics::GaussianProcess& surface, const SystemScale& scale,
                                const Eigen::MatrixXd& points, IntervalOf interval);

/// What of the system's index comes from which component, with all others as they are or as new.
struct WhatIf {
  SystemAt system;
  std::vector<SystemAt> restored;    // with that component as new
  std::vector<Bounded> shapley;      // sum: system − baseline
  std::vector<Bounded> alone;        // that component as it is and all others as new, less the baseline
  Bounded interaction;               // system − baseline − all of `alone`
  SystemAt baseline;                 // all components as new: what none of them explains
  std::vector<Bounded> gain;         // system − restored: what replacing that component alone would bring
  std::vector<std::size_t> ranking;  // by `gain`, the greatest first
  std::vector<bool> tied_with_next;  // by the ranking: the difference of the two gains may be of either sign
  bool extrapolated{};               // any corner of it
};

inline constexpr Eigen::Index kMostWhatIfComponents = 12;

/// All of it is linear in the 2ⁿ corners of the box between new and the state, so that the joint posterior of
/// these gives each interval in closed form. Intervals of shares are those of the surface.
/// @param state  one a component, 0 to 1.
/// @throws std::invalid_argument for another number of components or more than `kMostWhatIfComponents`.
WhatIf AskWhatIf(const statistics::GaussianProcess& surface, const SystemScale& scale,
                 const Eigen::VectorXd& state, IntervalOf interval);

}  // namespace strainwave::analysis::health
