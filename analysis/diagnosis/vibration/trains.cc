// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/trains.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include "analysis/diagnosis/vibration/resonances.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kLeastExcess = 9.0;
constexpr double kEdge = 7.0;  // half-widths of the resonance that count
constexpr double kLeastOverlap = 0.4;
constexpr int kMostHarmonics = 12;
constexpr double kLargestDamping = 0.12;

// A channel's residual, matched to the ring, over orders of the input angle.
struct MatchedOrders {
  double first{};
  double step{};
  std::vector<std::vector<Complex>> of_channel;  // power one under noise, for a train of one impulse a turn

  Complex At(std::size_t channel, double order) const {
    const double place = (order - first) / step;
    if (!(place >= 0.0) || place + 1.0 >= static_cast<double>(of_channel[channel].size())) return {};
    const auto below = static_cast<std::size_t>(place);
    const double u = place - static_cast<double>(below);
    return (1.0 - u) * of_channel[channel][below] + u * of_channel[channel][below + 1];
  }
};

MatchedOrders MatchOrders(const VibrationRemainder& remainder, const RingPlace& ring, double reach) {
  const VibrationRun& run = remainder.samples().runs.front();
  const double natural = kTwoPi * ring.ring_Hz;
  const Complex pole(-ring.damping_ratio * natural,
                     natural * std::sqrt(std::max(0.0, 1.0 - ring.damping_ratio * ring.damping_ratio)));
  const Complex step = std::exp(pole * run.period_s);
  const auto [slowest, fastest] = std::ranges::minmax(run.speed_rad_per_s);
  const double half_width = std::max(ring.damping_ratio * natural, 4.0 / run.span_s());
  MatchedOrders matched;
  matched.first = std::max(0.5, (natural - kEdge * half_width) / fastest - reach);
  const double last = std::min(remainder.samples().highest_order() * run.mean_speed_rad_per_s / slowest,
                               (natural + kEdge * half_width) / std::max(slowest, 1e-9) + reach);
  matched.step = 0.2 / run.turns;
  const auto orders = static_cast<std::size_t>(std::max(2.0, (last - matched.first) / matched.step + 1.0));
  // What is matched to a narrow ring changes slowly beside it: a few samples a bandwidth are enough.
  const double bandwidth_Hz = 2.5 * kEdge * half_width / kTwoPi;
  const auto stride = static_cast<std::size_t>(std::clamp(1.0 / (bandwidth_Hz * run.period_s), 1.0, 1e4));
  const double variance = remainder.base().variance();
  // Of a sum over impulses: one a turn, none of which overlap.
  const double scale = std::sqrt((1.0 - std::norm(step)) / (variance * run.turns)) / kTwoPi;
  for (const VibrationStretch& channel : run.channels) {
    std::vector<Complex> filtered(run.size());
    Complex common{};
    for (std::size_t i = run.size(); i-- > 0;) {
      const std::size_t place = channel.first + i;
      common =
          common * step + (remainder.solver().weights()[place] > 0.0 ? remainder.residual()[place] : 0.0);
      filtered[i] = std::conj(common);
    }
    std::vector<Complex> sums(orders);
    for (std::size_t i = 0; i < run.size(); i += stride) {
      const double angle = run.angle_rad[i] - 0.5 * run.angle_rad.back();
      const double turned = run.speed_rad_per_s[i] * run.period_s * static_cast<double>(stride);
      Complex line = scale * turned * filtered[i] * std::polar(1.0, -matched.first * angle);
      const Complex turn = std::polar(1.0, -matched.step * angle);
      for (Complex& sum : sums) {
        sum += line;
        line *= turn;
      }
    }
    matched.of_channel.push_back(std::move(sums));
  }
  return matched;
}

// Share of a lone ring's energy that a train keeps per impulse: above one where harmonics fall onto the
// resonance, below where they miss it. The harmonics are moved by `aside_Hz`.
double Overlap(const RingPlace& ring, double apart_Hz, double aside_Hz) {
  const double half_width = ring.damping_ratio * ring.ring_Hz;
  double sum = 0.0;
  const double nearest = std::round((ring.ring_Hz - aside_Hz) / apart_Hz);
  for (int k = -30; k <= 30; ++k) {
    const double off = ((nearest + k) * apart_Hz + aside_Hz - ring.ring_Hz) / half_width;
    sum += 1.0 / (1.0 + off * off);
  }
  return sum * apart_Hz / (kPi * half_width);
}

}  // namespace

std::vector<RingPlace> FindRings(const VibrationRemainder& remainder, std::size_t count) {
  const VibrationSpectrum& spectrum = remainder.over_seconds();
  std::vector<RingPlace> rings;
  const double lowest = std::max(20.0, 8.0 * spectrum.cell());
  for (const NoiseBand& band : FindBands(spectrum, lowest, 0.95 * spectrum.highest(), 4.0, false, count)) {
    rings.push_back(
        {band.centre_Hz, std::clamp(band.width_Hz / (4.0 * band.centre_Hz), 0.008, kLargestDamping)});
  }
  for (const SpectrumPeak& peak : FindPeaks(spectrum, lowest, 0.95 * spectrum.highest(), 1)) {
    rings.push_back({peak.order, 0.02});
  }
  return rings;
}

std::vector<TrainStart> FindTrains(const VibrationRemainder& remainder, const RingPlace& ring, double lowest,
                                   double highest, std::span<const double> sidebands, std::size_t count,
                                   const std::function<bool(double order)>& allowed) {
  const VibrationRun& run = remainder.samples().runs.front();
  const double reach = *std::ranges::max_element(sidebands);
  const MatchedOrders matched = MatchOrders(remainder, ring, reach);
  const std::size_t channels = matched.of_channel.size();
  const double from = matched.first + reach;
  const double to =
      matched.first + matched.step * static_cast<double>(matched.of_channel[0].size() - 1) - reach;
  const double turn_Hz = run.mean_speed_rad_per_s / kTwoPi;
  const double centre = ring.ring_Hz / turn_Hz;
  const bool even = run.speed_spread < 0.03;
  const auto highest_counted = [&](double order) {
    return std::min(to, centre + 0.5 * kMostHarmonics * order);
  };
  std::vector<TrainStart> found;
  std::vector<Complex> lines;
  for (double order = lowest; order < highest; order += 0.4 * order / (run.turns * highest_counted(order))) {
    if (!allowed(order)) continue;
    const auto overlap_at = [&](double side) {
      return even ? Overlap(ring, order * turn_Hz, side * turn_Hz) : 1.0;
    };
    auto first = static_cast<int>(std::ceil(from / order));
    auto last = static_cast<int>(std::floor(to / order));
    const auto nearest = static_cast<int>(std::lround(centre / order));
    first = std::max(first, nearest - kMostHarmonics / 2);
    last = std::min(last, nearest + kMostHarmonics / 2);
    if (last < first || overlap_at(0.0) < kLeastOverlap) continue;
    const auto harmonics = static_cast<std::size_t>(last - first + 1);
    const std::size_t places = last > first ? 4 * harmonics : 1;
    const auto power_of = [&](double side) {
      const double scale = order / std::max(overlap_at(side), 0.2 * kLeastOverlap);
      lines.clear();
      for (std::size_t c = 0; c < channels; ++c) {
        for (int k = first; k <= last; ++k) lines.push_back(matched.At(c, k * order + side));
      }
      std::vector<double> powers(places, 0.0);
      for (std::size_t p = 0; p < places; ++p) {
        const Complex turn = std::polar(1.0, kTwoPi * static_cast<double>(p) / static_cast<double>(places));
        for (std::size_t c = 0; c < channels; ++c) {
          Complex amplitude{};
          for (std::size_t k = harmonics; k-- > 0;) amplitude = amplitude * turn + lines[c * harmonics + k];
          powers[p] += scale * std::norm(amplitude);
        }
      }
      return powers;
    };
    const std::vector<double> plain = power_of(0.0);
    double excess = 0.0;
    for (const double sideband : sidebands) {
      std::vector<double> powers = plain;
      if (sideband > 0.0) {
        for (const double side : {-sideband, sideband}) {
          const std::vector<double> more = power_of(side);
          for (std::size_t p = 0; p < places; ++p) powers[p] += more[p];
        }
      }
      const double cells = static_cast<double>(channels) * (sideband > 0.0 ? 3.0 : 1.0);
      excess = std::max(excess, ExcessOf(*std::ranges::max_element(powers), cells));
    }
    if (excess > kLeastExcess) found.push_back({order, ring, excess});
  }
  std::sort(found.begin(), found.end(),
            [](const TrainStart& a, const TrainStart& b) { return a.excess > b.excess; });
  std::vector<TrainStart> chosen;
  for (const TrainStart& start : found) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const TrainStart& other) {
      return std::abs(other.order - start.order) < 1.5 * start.order / (run.turns * from);
    });
    if (!near) chosen.push_back(start);
  }
  return chosen;
}

}  // namespace strainwave::analysis::diagnosis
