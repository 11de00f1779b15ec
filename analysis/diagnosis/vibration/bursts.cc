// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/bursts.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "analysis/diagnosis/vibration/families.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kLeastPower = 12.0;

// Frequency (in cycles a sample) and drop of the sum of squares of the strongest tone in a short segment.
SpectrumPeak StrongestTone(std::span<const double> values) {
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<double> padded(2 * values.size(), 0.0);
  std::copy(values.begin(), values.end(), padded.begin());
  std::vector<std::complex<double>> spectrum;
  transform.fwd(spectrum, padded);
  SpectrumPeak best;
  for (std::size_t j = 2; j + 2 < spectrum.size(); ++j) {
    const double drop = 2.0 * std::norm(spectrum[j]) / static_cast<double>(values.size());
    if (drop > best.power) best = {static_cast<double>(j) / static_cast<double>(padded.size()), drop};
  }
  return best;
}

}  // namespace

std::vector<BurstSpot> FindBursts(const VibrationResidual& residual, std::size_t count) {
  const VibrationRun& run = residual.samples().runs.front();
  const double variance = residual.base().variance();
  std::vector<BurstSpot> spots;
  for (std::size_t length = 32; length <= run.size() / 6; length *= 2) {
    for (const VibrationSegment& channel : run.channels) {
      const double* values = residual.residual().data() + channel.first;
      for (std::size_t from = 0; from + length <= run.size(); from += length / 2) {
        // Large segments alone are worth a spectrum.
        double energy = 0.0;
        for (std::size_t i = from; i < from + length; ++i) energy += values[i] * values[i];
        const double excess = energy / variance - static_cast<double>(length);
        if (excess < kLeastPower + 1.5 * std::sqrt(2.0 * static_cast<double>(length))) continue;
        const SpectrumPeak peak = StrongestTone({values + from, length});
        if (peak.power / variance < kLeastPower) continue;
        spots.push_back({peak.power / variance, peak.order / run.period_s,
                         run.time_s[from] + 0.5 * static_cast<double>(length) * run.period_s,
                         0.25 * static_cast<double>(length) * run.period_s});
      }
    }
  }
  std::sort(spots.begin(), spots.end(),
            [](const BurstSpot& a, const BurstSpot& b) { return a.power > b.power; });
  std::vector<BurstSpot> chosen;
  for (const BurstSpot& spot : spots) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const BurstSpot& other) {
      return std::abs(other.centre_s - spot.centre_s) < 2.0 * (other.width_s + spot.width_s) &&
             std::abs(other.frequency_Hz - spot.frequency_Hz) < 0.2 * spot.frequency_Hz;
    });
    if (!near) chosen.push_back(spot);
  }
  return chosen;
}

std::optional<TermFit> SearchBurst(const VibrationResidual& residual, std::size_t index) {
  const VibrationSamples& samples = residual.samples();
  std::optional<TermFit> best;
  for (const BurstSpot& spot : FindBursts(residual, 3)) {
    if (spot.power < 2.0 * kLeastPower) break;
    VibrationTerm term;
    term.cause = index;
    term.form = VibrationForm::kBurst;
    term.observable.assign(samples.channels(), 0);
    std::fill_n(term.observable.begin(), samples.runs.front().channels.size(), 1);
    term.nonlinear_parameters = {std::clamp(spot.frequency_Hz, 1.0, 0.95 * samples.highest_Hz()),
                                 spot.centre_s, spot.width_s};
    Keep(residual.With(std::move(term), 12), best);
  }
  return best;
}

}  // namespace strainwave::analysis::diagnosis
