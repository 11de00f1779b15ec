// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/shared_noise.h"

#include "analysis/decompositions.h"
#include "analysis/diagnosis/vibration/spectrum.h"

namespace strainwave::analysis::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

// Of the noise of a channel: what two of them differ by is no less than this, however alike they look. Below,
// rounding and the errors of the estimate would decide.
constexpr double kLeastApart = 0.01;

}  // namespace

MatrixXd DecorrelationOf(std::span<const std::vector<double>> channels) {
  const auto count = static_cast<Index>(channels.size());
  MatrixXd correlation = MatrixXd::Identity(count, count);
  for (Index a = 0; a < count; ++a) {
    for (Index b = 0; b < a; ++b) {
      correlation(a, b) = correlation(b, a) =
          BroadbandCorrelation(channels[static_cast<std::size_t>(a)], channels[static_cast<std::size_t>(b)]);
    }
  }
  const SymmetricParts parts = SymmetricEigen(correlation);
  return parts.values.cwiseMax(kLeastApart).cwiseSqrt().cwiseInverse().asDiagonal() *
         parts.vectors.transpose();
}

void Decorrelate(const VibrationSamples& samples, std::span<const double> weights,
                 std::span<double> residual) {
  for (const VibrationRun& run : samples.runs) {
    const auto count = static_cast<Index>(run.channels.size());
    if (count < 2) continue;
    // The channels of a record stand one after the other.
    const std::size_t first = run.channels.front().first;
    for (std::size_t i = first; i < first + run.size() * run.channels.size(); ++i) {
      if (!(weights[i] > 0.0)) residual[i] = 0.0;
    }
    Eigen::Map<MatrixXd> own(residual.data() + first, static_cast<Index>(run.size()), count);
    own *= run.decorrelation.transpose();
  }
}

}  // namespace strainwave::analysis::diagnosis
