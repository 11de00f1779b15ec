// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/inter_sample_extrema.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

// Of the second difference: how far a round turn goes beyond the samples, and one of two straight ramps.
constexpr double kRound = 0.125;
constexpr double kSharp = 0.5;
constexpr double kSpread = 0.5 * (kSharp - kRound);

// A turn between sample `before` and the next.
struct InterSampleExtremum {
  std::size_t before{};
  double outermost_Nm{};  // of both samples
  double turned_Nm{};     // with the sign of a peak: the smaller of the second differences on both sides
};

std::vector<InterSampleExtremum> FindInterSampleExtrema(const LoopGrid& samples) {
  const std::vector<double>& torque_Nm = samples.torque_Nm;
  std::vector<InterSampleExtremum> peaks;
  for (std::size_t r = 0; r < samples.records(); ++r) {
    for (std::size_t k = samples.starts[r] + 1; k + 2 < samples.starts[r + 1]; ++k) {
      if (!std::isnan(samples.turn_Nm[k + 1])) continue;
      const double before_Nm = torque_Nm[k] - torque_Nm[k - 1];
      const double between_Nm = torque_Nm[k + 1] - torque_Nm[k];
      const double after_Nm = torque_Nm[k + 2] - torque_Nm[k + 1];
      if (!(before_Nm * after_Nm < 0.0)) continue;
      const double up = before_Nm > 0.0 ? 1.0 : -1.0;
      const double turned_Nm = std::min(up * (before_Nm - between_Nm), up * (between_Nm - after_Nm));
      if (!(turned_Nm > 0.0)) continue;
      const double outermost_Nm = up * std::max(up * torque_Nm[k], up * torque_Nm[k + 1]);
      peaks.push_back({k, outermost_Nm, up * turned_Nm});
    }
  }
  return peaks;
}

void PlaceAt(const InterSampleExtremum& peak, double share, LoopGrid& samples) {
  samples.turn_Nm[peak.before + 1] = peak.outermost_Nm + share * peak.turned_Nm;
  samples.turn_share[peak.before + 1] = 0.5;
}

}  // namespace

bool SetInterSampleExtrema(const GearLaw& law, const Eigen::VectorXd& predicted_rad, double noise_rad,
                           LoopGrid& samples) {
  constexpr double kShows = 0.5;  // of the noise
  const std::vector<InterSampleExtremum> peaks = FindInterSampleExtrema(samples);
  LoopGrid further = samples;
  for (const InterSampleExtremum& peak : peaks) PlaceAt(peak, kRound + kSpread, further);
  Eigen::VectorXd as_seen_rad;
  Eigen::VectorXd further_rad;
  FillTwist(law, samples, as_seen_rad);
  FillTwist(law, further, further_rad);
  // What each peak does to the samples up to the next one.
  const Eigen::VectorXd done_rad = further_rad - as_seen_rad;
  if (!(done_rad.cwiseAbs().maxCoeff() > kShows * noise_rad)) return false;
  const double per_share = 1.0 / (kRound + kSpread);
  for (std::size_t p = 0; p < peaks.size(); ++p) {
    const std::size_t end = p + 1 < peaks.size() ? peaks[p + 1].before + 1 : samples.size();
    double following = 0.0;
    double weights = 0.0;
    for (std::size_t i = peaks[p].before + 1; i < end; ++i) {
      const double by_share_rad = per_share * done_rad(static_cast<Index>(i));
      const double off_rad = samples.twist_rad[i] - predicted_rad(static_cast<Index>(i));
      following += by_share_rad * (off_rad - kRound * by_share_rad);
      weights += by_share_rad * by_share_rad;
    }
    // Round, unless the angle says more.
    const double beyond = following / (weights + noise_rad * noise_rad / (kSpread * kSpread));
    PlaceAt(peaks[p], std::clamp(kRound + beyond, kRound, kSharp), samples);
  }
  return true;
}

}  // namespace strainwave::analysis::diagnosis
