// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/study.h"

/// Where a model may be trusted: in which ranges of each regressor its error on held-out data is no more than
/// the noise explains.
namespace strainwave::analysis::diagnosis {

/// Root mean square of the error over that of the noise up to which a model holds: a misfit of 0.83 of the
/// noise beside it. 24 independent samples without misfit show that with 95 % confidence; 1.2 would take 50.
inline constexpr double kToleratedExcess = 1.3;

/// Share of records in which a model that misses nothing fails in any range of any regressor.
inline constexpr double kTrustFamilyError = 0.01;

enum class Validity {
  kHolds,   // the upper 95 % bound of the excess is at most kToleratedExcess
  kFails,   // not so, and its simultaneous lower bound is above 1
  kTooFew,  // neither: too few samples to say
};

/// Error of one model in one range.
struct RangeError {
  double rmse{};  // of held-out samples, SI
  Validity validity{Validity::kTooFew};
};

/// One range of a regressor.
struct RegressorRange {
  double low{};  // SI; of an angle that comes by more than once, within a turn; equal where it is one value
  double high{};
  std::size_t samples{};  // with weight; at least 1
  RangeError nominal;
  RangeError extended;
};

struct TrustedRegions {
  double noise{};  // standard deviation, SI
  /// One list a regressor of the study, ascending; ranges without samples are not there. Empty where the
  /// regressor has but one value.
  std::vector<std::vector<RegressorRange>> over;
};

/// Residuals of held-out samples, SI, one a sample.
struct HeldOutErrors {
  std::span<const double> nominal;
  std::span<const double> extended;
};

/// Values of a regressor in ranges: each of up to twelve values, or up to twelve ranges of equal width; of an
/// angle that turns further than once, up to 24 sectors of the turn; as many as have 40 independent samples
/// on average. The mean square of the held-out residuals over the noise's variance is compared with χ²(ν)/ν,
/// ν from the mean, the variance and the autocorrelation of the squared noise; lower bounds are simultaneous
/// over all ranges (Bonferroni).
///
/// @param weights  one a sample, the noise's variance over the variance expected there; 0 leaves it out
/// @param noise    residual of all that was found, structure without a name included, SI, one a sample
/// @throws std::invalid_argument where the sizes differ.
///
/// Source: Satterthwaite 1946 (degrees of freedom), Andrews & Monahan 1992 (autocorrelation).
TrustedRegions FindTrustedRegions(const Study& study, std::span<const double> weights,
                                  std::span<const double> noise, const HeldOutErrors& errors);

}  // namespace strainwave::analysis::diagnosis
