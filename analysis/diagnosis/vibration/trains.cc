// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/trains.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <cstdint>
#include <utility>

#include "analysis/diagnosis/vibration/matched_orders.h"
#include "analysis/diagnosis/vibration/speed_band.h"
#include "analysis/diagnosis/vibration/zero_padded_inverse_fft.h"
#include "analysis/units.h"
#include "analysis/vector_clones.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kOtherResonance = 0.25;  // ln of how far apart resonances are that one train may have
constexpr double kNextResonance = 1.055;  // within a width of the resonance
constexpr double kHighestMatchedResonance = 0.45;  // of the sampling rate
constexpr double kLeastTrainOverlap = 0.1;         // of a train's harmonics with the resonance
// Far below what the number of search locations makes of noise: what is weaker is never among the strongest.
constexpr double kLeastTrainPower = 9.0;
constexpr double kLeastTrainExcess = 9.0;
constexpr std::size_t kPhasesPerHarmonic = 2;  // or more: a power of two in all
constexpr std::size_t kCandidatesPerResonance = 24;
constexpr std::size_t kTrainsPerResonance = 3;
constexpr double kMostWork = 1500.0;  // harmonics looked at, a sample

// Of complex numbers: adds their norms, and their squares.
STRAINWAVE_VECTOR_CLONES
void AddSquares(std::span<const float> real, std::span<const float> imaginary, std::span<float> norms,
                std::span<float> squares_real, std::span<float> squares_imaginary) {
  for (std::size_t n = 0; n < norms.size(); ++n) {
    const float real_square = real[n] * real[n];
    const float imaginary_square = imaginary[n] * imaginary[n];
    norms[n] += real_square + imaginary_square;
    squares_real[n] += real_square - imaginary_square;
    squares_imaginary[n] += 2.0F * real[n] * imaginary[n];
  }
}

// Twice what lies along the best phase, out of norms and squares of several numbers.
STRAINWAVE_VECTOR_CLONES
void AddOfOnePhase(std::span<float> norms, std::span<const float> squares_real,
                   std::span<const float> squares_imaginary) {
  for (std::size_t n = 0; n < norms.size(); ++n) {
    norms[n] += std::sqrt(squares_real[n] * squares_real[n] + squares_imaginary[n] * squares_imaginary[n]);
  }
}

// By phase, then by list: the phase of each list at which it is largest.
STRAINWAVE_VECTOR_CLONES
std::array<std::int32_t, ZeroPaddedInverseFft::kLists> LargestOfEach(std::span<const float> values) {
  std::array<float, ZeroPaddedInverseFft::kLists> largest{};
  std::array<std::int32_t, ZeroPaddedInverseFft::kLists> at{};
  std::copy_n(values.begin(), ZeroPaddedInverseFft::kLists, largest.begin());
  const float* row = values.data();
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(values.size() / ZeroPaddedInverseFft::kLists); ++p) {
    for (std::size_t i = 0; i < ZeroPaddedInverseFft::kLists; ++i) {
      const bool larger = row[i] > largest[i];
      largest[i] = larger ? row[i] : largest[i];
      at[i] = larger ? p : at[i];
    }
    row += ZeroPaddedInverseFft::kLists;
  }
  return at;
}

// A share of an order by which its highest harmonic moves half a cell.
double OrderStep(double turns, double highest) { return 0.5 / (turns * highest); }

// Trains in one resonance.
class TrainSearch {
 public:
  TrainSearch(double turns, double resonance_Hz, const MatchedOrders& matched,
              std::span<const double> sidebands)
      : turns_(turns),
        resonance_Hz_(resonance_Hz),
        matched_(matched),
        sidebands_(sidebands),
        reach_(*std::ranges::max_element(sidebands)),
        channels_(static_cast<double>(matched.of_channel.size())) {}

  std::vector<TrainStart> Find(double lowest, double highest,
                               const std::function<bool(double order)>& allowed) {
    std::vector<std::pair<double, double>> candidates;  // statistic, order; the weakest first once it is full
    double least = kLeastTrainPower;
    std::vector<Comb> together;
    const auto take = [&] {
      const std::vector<TrainPhase> best = BestPhases(together);
      for (std::size_t i = 0; i < together.size(); ++i) {
        if (best[i].power < least) continue;
        candidates.emplace_back(best[i].power, together[i].order);
        std::push_heap(candidates.begin(), candidates.end(), std::greater<>());
        if (candidates.size() <= kCandidatesPerResonance) continue;
        std::pop_heap(candidates.begin(), candidates.end(), std::greater<>());
        candidates.pop_back();
        least = candidates.front().first;
      }
      together.clear();
    };
    const double step = OrderStep(turns_, matched_.last() - reach_);
    for (double order = lowest; order < highest; order *= 1.0 + step) {
      Comb comb = CombOf(order);
      if (comb.last < comb.first || !allowed(order)) continue;
      const CombPower plain = PowerOf(comb, 0.0);
      // No sum with phases exceeds that of the amplitudes.
      if (plain.noise < kLeastTrainOverlap ||
          plain.power * static_cast<double>(comb.harmonics()) < least * plain.noise)
        continue;
      comb.noise = plain.noise;
      if (!together.empty() && together.front().phases() != comb.phases()) take();
      together.push_back(comb);
      if (together.size() == ZeroPaddedInverseFft::kLists) take();
    }
    take();
    std::vector<TrainStart> found;
    for (const auto& [power, order] : candidates) {
      const TrainStart start = WithSidebands(CombOf(order));
      if (start.excess > kLeastTrainExcess) found.push_back(start);
    }
    return found;
  }

 private:
  // Impulses of one train at their best phase.
  struct TrainPhase {
    double power{};  // that they explain, half the number of amplitudes and phase under noise
    double share{};  // of a period
    Complex phase{1.0};
  };

  // Harmonics of an order that the resonance lets through.
  struct Comb {
    double order{};
    int first{};
    int last{};
    double noise{};  // a channel

    std::size_t harmonics() const { return static_cast<std::size_t>(last - first + 1); }
    std::size_t phases() const {
      return harmonics() > 1 ? std::bit_ceil(kPhasesPerHarmonic * harmonics()) : 1;
    }
  };

  Comb CombOf(double order) const {
    return {order, static_cast<int>(std::ceil((matched_.first + reach_) / order)),
            static_cast<int>(std::floor((matched_.last() - reach_) / order)), 0.0};
  }

  // Power of the harmonics moved by `side`, beside what noise has there.
  struct CombPower {
    double power{};
    double noise{};  // a channel
  };
  CombPower PowerOf(const Comb& comb, double side) const {
    CombPower sum;
    for (int k = comb.first; k <= comb.last; ++k) {
      const std::size_t bin = matched_.BinOf(k * comb.order + side);
      if (bin >= matched_.power.size()) continue;
      sum.power += static_cast<double>(matched_.power[bin]);
      sum.noise += static_cast<double>(matched_.noise[bin]);
    }
    sum.power *= comb.order;
    sum.noise *= comb.order;
    return sum;
  }

  // The response starts in step in all channels, or against it: of their amplitudes the parts of one phase
  // count.
  // @param combs  with as many phases each
  std::vector<TrainPhase> BestPhases(std::span<const Comb> combs) {
    std::vector<TrainPhase> best(combs.size());
    if (combs.empty()) return best;
    const std::size_t phases = combs.front().phases();
    const std::size_t count = phases * ZeroPaddedInverseFft::kLists;
    sum_.assign(count, 0.0F);
    square_real_.assign(count, 0.0F);
    square_imaginary_.assign(count, 0.0F);
    for (const std::vector<std::complex<float>>& channel : matched_.of_channel) {
      sums_.Clear(phases);
      for (std::size_t i = 0; i < combs.size(); ++i) {
        for (int k = combs[i].first; k <= combs[i].last; ++k) {
          const std::size_t bin = matched_.BinOf(k * combs[i].order);
          if (bin < channel.size()) sums_.Set(i, static_cast<std::size_t>(k - combs[i].first), channel[bin]);
        }
      }
      sums_.Sum();
      AddSquares(sums_.real(), sums_.imaginary(), sum_, square_real_, square_imaginary_);
    }
    AddOfOnePhase(sum_, square_real_, square_imaginary_);
    const std::array<std::int32_t, ZeroPaddedInverseFft::kLists> largest = LargestOfEach(sum_);
    for (std::size_t i = 0; i < combs.size(); ++i) {
      const std::size_t most = static_cast<std::size_t>(largest[i]) * ZeroPaddedInverseFft::kLists + i;
      best[i] = {0.5 * static_cast<double>(sum_[most]) * combs[i].order / combs[i].noise,
                 static_cast<double>(most / ZeroPaddedInverseFft::kLists) / static_cast<double>(phases),
                 std::polar(1.0, 0.5 * std::atan2(static_cast<double>(square_imaginary_[most]),
                                                  static_cast<double>(square_real_[most])))};
    }
    return best;
  }

  std::vector<Complex> AmplitudesAt(const Comb& comb, double side, double share) const {
    const Complex turn = std::polar(1.0, kTwoPi * share);
    std::vector<Complex> amplitudes;
    for (std::size_t c = 0; c < matched_.of_channel.size(); ++c) {
      Complex sum{};
      for (int k = comb.last; k >= comb.first; --k) sum = sum * turn + matched_.At(c, k * comb.order + side);
      amplitudes.push_back(sum);
    }
    return amplitudes;
  }

  // Impulses that change have sidebands in the proportion of the channels' amplitudes, the upper one the
  // lower one's mirror image.
  TrainStart WithSidebands(Comb comb) {
    const double noise = PowerOf(comb, 0.0).noise;
    comb.noise = noise;
    const TrainPhase best = BestPhases({&comb, 1}).front();
    const double cells = 0.5 * (channels_ + 1.0);
    TrainStart start{comb.order, resonance_Hz_, ExcessOf(best.power, cells), 0.0, matched_.relative_noise};
    const std::vector<Complex> plain = AmplitudesAt(comb, 0.0, best.share);
    for (const double side : sidebands_) {
      // Impulses that come more seldom do not show the change; its lines are their own harmonics again.
      if (side == 0.0 || side > kLargestSideband * comb.order) continue;
      const std::vector<Complex> above = AmplitudesAt(comb, side, best.share);
      const std::vector<Complex> below = AmplitudesAt(comb, -side, best.share);
      Complex upper{};
      Complex lower{};
      double square = 0.0;
      for (std::size_t c = 0; c < plain.size(); ++c) {
        const double own = (std::conj(best.phase) * plain[c]).real();
        upper += own * std::conj(best.phase) * above[c];
        lower += own * std::conj(best.phase) * below[c];
        square += own * own;
      }
      if (!(square > 0.0)) continue;
      // About a resonance that is far from the harmonics the sidebands are the larger ones, by noise alone.
      const double beside = PowerOf(comb, side).noise + PowerOf(comb, -side).noise;
      if (beside < kLeastTrainOverlap) continue;
      const double more = std::norm(upper + std::conj(lower)) / square * comb.order / beside;
      const double excess = ExcessOf(best.power + more, cells + 1.0);
      if (excess > start.excess) start = {comb.order, resonance_Hz_, excess, side, matched_.relative_noise};
    }
    return start;
  }

  double turns_{};
  double resonance_Hz_{};
  const MatchedOrders& matched_;
  std::span<const double> sidebands_;
  double reach_{};
  double channels_{};
  ZeroPaddedInverseFft sums_;
  // By phase, then by comb.
  std::vector<float> sum_;
  std::vector<float> square_real_;
  std::vector<float> square_imaginary_;
};

// The strongest, each a cell of its harmonics from the others.
std::vector<TrainStart> Strongest(std::vector<TrainStart> trains, double turns, double turn_Hz,
                                  std::size_t count) {
  std::sort(trains.begin(), trains.end(),
            [](const TrainStart& a, const TrainStart& b) { return a.excess > b.excess; });
  std::vector<TrainStart> chosen;
  for (const TrainStart& start : trains) {
    if (chosen.size() == count) break;
    const bool near = std::any_of(chosen.begin(), chosen.end(), [&](const TrainStart& other) {
      const double cell = start.order * turn_Hz / (turns * start.resonance_Hz);
      return std::abs(other.order - start.order) < 1.5 * cell &&
             std::abs(std::log(other.resonance_Hz / start.resonance_Hz)) < kOtherResonance;
    });
    if (!near) chosen.push_back(start);
  }
  return chosen;
}

std::vector<double> ResonancesOf(const VibrationRun& run) {
  std::vector<double> resonances_Hz;
  const double turn_Hz = run.mean_speed_rad_per_s / kTwoPi;
  for (double resonance = kLowestTrainResonance; resonance < kHighestMatchedResonance;
       resonance *= kNextResonance) {
    const double resonance_Hz = resonance / run.period_s;
    if (resonance_Hz >= 3.0 * turn_Hz) resonances_Hz.push_back(resonance_Hz);
  }
  return resonances_Hz;
}

// Harmonics of all trains in all resonances.
double WorkOf(const VibrationRun& run, const SpeedBand& band, const std::vector<double>& resonances_Hz,
              double reach, double lowest, double highest) {
  double work = 0.0;
  for (const double resonance_Hz : resonances_Hz) {
    const OrderRange range = ResonanceMatcher::Range(run, band, resonance_Hz, reach, highest);
    work += (range.last - range.first) * (1.0 / lowest - 1.0 / highest) / OrderStep(band.span, range.last);
  }
  return work;
}

}  // namespace

std::vector<TrainStart> FindTrains(const VibrationResidual& residual, double lowest, double highest,
                                   std::span<const double> sidebands, std::size_t count,
                                   const std::function<bool(double order)>& allowed) {
  const VibrationRun& run = residual.samples().runs.front();
  const double turn_Hz = run.mean_speed_rad_per_s / kTwoPi;
  if (!(highest > lowest)) return {};
  const double reach = *std::ranges::max_element(sidebands);
  std::vector<double> resonances_Hz = ResonancesOf(run);
  const auto band_for = [&] {
    return BandWithin(run, kMostWork * static_cast<double>(run.size()), [&](const SpeedBand& tried) {
      return WorkOf(run, tried, resonances_Hz, reach, lowest, highest);
    });
  };
  // Of a shaft that creeps the highest resonances are given up: they have most harmonics.
  SpeedBand band = band_for();
  while (!(band.turns > 0.0) && resonances_Hz.size() > 1) {
    resonances_Hz.resize(resonances_Hz.size() - 1 - resonances_Hz.size() / 10);
    band = band_for();
  }
  if (!(band.turns > 0.0)) return {};
  ResonanceMatcher matcher(residual, band);
  std::vector<TrainStart> found;
  for (const double resonance_Hz : resonances_Hz) {
    const MatchedOrders matched = matcher.Match(resonance_Hz, reach, highest);
    TrainSearch search(band.span, resonance_Hz, matched, sidebands);
    const auto own =
        Strongest(search.Find(lowest, highest, allowed), run.turns, turn_Hz, kTrainsPerResonance);
    found.insert(found.end(), own.begin(), own.end());
  }
  return Strongest(std::move(found), run.turns, turn_Hz, count);
}

}  // namespace strainwave::analysis::diagnosis
