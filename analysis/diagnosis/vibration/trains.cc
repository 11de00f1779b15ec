// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/trains.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <utility>

#include "analysis/diagnosis/vibration/matched_orders.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kOtherRing = 0.25;    // ln of how far apart rings are that one train may have
constexpr double kNextRing = 1.055;    // within a width of the resonance
constexpr double kLowestRing = 0.03;   // of the sampling rate
constexpr double kHighestRing = 0.45;  // of the sampling rate
constexpr double kLeastOverlap = 0.1;  // of a train's harmonics with the resonance
// Far below what the number of places searched makes of noise: what is weaker is never among the strongest.
constexpr double kLeastPower = 9.0;
constexpr double kLeastExcess = 9.0;
constexpr std::size_t kPlacesPerHarmonic = 2;
constexpr std::size_t kLooksPerRing = 24;
constexpr std::size_t kTrainsPerRing = 3;

// Trains in one resonance.
class TrainSearch {
 public:
  TrainSearch(const VibrationRun& run, double ring_Hz, const MatchedOrders& matched,
              std::span<const double> sidebands)
      : run_(run),
        ring_Hz_(ring_Hz),
        matched_(matched),
        sidebands_(sidebands),
        reach_(*std::ranges::max_element(sidebands)),
        channels_(static_cast<double>(matched.of_channel.size())) {}

  std::vector<TrainStart> Find(double lowest, double highest,
                               const std::function<bool(double order)>& allowed) {
    std::vector<std::pair<double, double>> looks;  // statistic, order; the weakest first once it is full
    const double step = 0.5 / (run_.turns * (matched_.last() - reach_));
    double least = kLeastPower;
    for (double order = lowest; order < highest; order *= 1.0 + step) {
      SetOrder(order);
      if (last_ < first_ || !allowed(order)) continue;
      const Look plain = LookAt(0.0);
      // No sum with phases exceeds that of the amplitudes.
      if (plain.noise < kLeastOverlap || plain.power * (last_ - first_ + 1) < least * plain.noise) continue;
      const double power = BestPlace(plain.noise).power;
      if (power < least) continue;
      looks.emplace_back(power, order);
      std::push_heap(looks.begin(), looks.end(), std::greater<>());
      if (looks.size() <= kLooksPerRing) continue;
      std::pop_heap(looks.begin(), looks.end(), std::greater<>());
      looks.pop_back();
      least = looks.front().first;
    }
    std::vector<TrainStart> found;
    for (const auto& [power, order] : looks) {
      SetOrder(order);
      const TrainStart start = WithSidebands();
      if (start.excess > kLeastExcess) found.push_back(start);
    }
    return found;
  }

 private:
  // Impulses of one train at their best place.
  struct Place {
    double power{};  // that they explain, half the number of amplitudes and phase under noise
    double share{};  // of a period
    Complex phase{1.0};
  };

  void SetOrder(double order) {
    order_ = order;
    first_ = static_cast<int>(std::ceil((matched_.first + reach_) / order));
    last_ = static_cast<int>(std::floor((matched_.last() - reach_) / order));
  }

  // Power of the harmonics moved by `side`, beside what noise has there.
  struct Look {
    double power{};
    double noise{};  // a channel
  };
  Look LookAt(double side) const {
    Look look;
    for (int k = first_; k <= last_; ++k) {
      const std::size_t place = matched_.PlaceOf(k * order_ + side);
      if (place >= matched_.power.size()) continue;
      look.power += static_cast<double>(matched_.power[place]);
      look.noise += static_cast<double>(matched_.noise[place]);
    }
    look.power *= order_;
    look.noise *= order_;
    return look;
  }

  // The ring starts in step in all channels, or against it: of their amplitudes the parts of one phase count.
  Place BestPlace(double noise) {
    const auto harmonics = static_cast<std::size_t>(last_ - first_ + 1);
    const std::size_t places = harmonics > 1 ? kPlacesPerHarmonic * harmonics : 1;
    const Turns& turns = TurnsOf(places);
    sum_.assign(places, 0.0F);
    square_real_.assign(places, 0.0F);
    square_imaginary_.assign(places, 0.0F);
    for (const std::vector<Complex>& channel : matched_.of_channel) {
      real_.assign(places, 0.0F);
      imaginary_.assign(places, 0.0F);
      for (int k = last_; k >= first_; --k) {
        const std::size_t place = matched_.PlaceOf(k * order_);
        const Complex line = place < channel.size() ? channel[place] : Complex{};
        AddLine(turns, static_cast<float>(line.real()), static_cast<float>(line.imag()));
      }
      for (std::size_t p = 0; p < places; ++p) {
        const float re = real_[p];
        const float im = imaginary_[p];
        sum_[p] += re * re + im * im;
        square_real_[p] += re * re - im * im;
        square_imaginary_[p] += 2.0F * re * im;
      }
    }
    std::size_t best = 0;
    float most = -1.0F;
    for (std::size_t p = 0; p < places; ++p) {
      const float power = sum_[p] + std::sqrt(square_real_[p] * square_real_[p] +
                                              square_imaginary_[p] * square_imaginary_[p]);
      if (power <= most) continue;
      most = power;
      best = p;
    }
    return {0.5 * static_cast<double>(most) * order_ / noise,
            static_cast<double>(best) / static_cast<double>(places),
            std::polar(1.0, 0.5 * std::atan2(static_cast<double>(square_imaginary_[best]),
                                             static_cast<double>(square_real_[best])))};
  }

  // Directions of places, as real and imaginary parts.
  struct Turns {
    std::vector<float> real;
    std::vector<float> imaginary;
  };
  const Turns& TurnsOf(std::size_t places) {
    Turns& turns = turns_[places];
    for (std::size_t p = turns.real.size(); p < places; ++p) {
      const double angle = kTwoPi * static_cast<double>(p) / static_cast<double>(places);
      turns.real.push_back(static_cast<float>(std::cos(angle)));
      turns.imaginary.push_back(static_cast<float>(std::sin(angle)));
    }
    return turns;
  }

  // A step of Horner's rule, for all places at once.
  void AddLine(const Turns& turns, float line_real, float line_imaginary) {
    const std::size_t places = real_.size();
    float* const real = real_.data();
    float* const imaginary = imaginary_.data();
    const float* const turn_real = turns.real.data();
    const float* const turn_imaginary = turns.imaginary.data();
    for (std::size_t p = 0; p < places; ++p) {
      const float next = real[p] * turn_real[p] - imaginary[p] * turn_imaginary[p] + line_real;
      imaginary[p] = real[p] * turn_imaginary[p] + imaginary[p] * turn_real[p] + line_imaginary;
      real[p] = next;
    }
  }

  std::vector<Complex> AmplitudesAt(double side, double share) {
    const Complex turn = std::polar(1.0, kTwoPi * share);
    std::vector<Complex> amplitudes;
    for (std::size_t c = 0; c < matched_.of_channel.size(); ++c) {
      Complex sum{};
      for (int k = last_; k >= first_; --k) sum = sum * turn + matched_.At(c, k * order_ + side);
      amplitudes.push_back(sum);
    }
    return amplitudes;
  }

  // Impulses that change have sidebands in the proportion of the channels' amplitudes, the upper one the
  // lower one's mirror image.
  TrainStart WithSidebands() {
    const double noise = LookAt(0.0).noise;
    const Place place = BestPlace(noise);
    const double cells = 0.5 * (channels_ + 1.0);
    TrainStart start{order_, ring_Hz_, ExcessOf(place.power, cells), 0.0, matched_.loudness};
    const std::vector<Complex> plain = AmplitudesAt(0.0, place.share);
    for (const double side : sidebands_) {
      // Impulses that come more seldom do not show the change; its lines are their own harmonics again.
      if (side == 0.0 || side > kLargestSideband * order_) continue;
      const std::vector<Complex> above = AmplitudesAt(side, place.share);
      const std::vector<Complex> below = AmplitudesAt(-side, place.share);
      Complex upper{};
      Complex lower{};
      double square = 0.0;
      for (std::size_t c = 0; c < plain.size(); ++c) {
        const double own = (std::conj(place.phase) * plain[c]).real();
        upper += own * std::conj(place.phase) * above[c];
        lower += own * std::conj(place.phase) * below[c];
        square += own * own;
      }
      if (!(square > 0.0)) continue;
      const double more = 0.5 * std::norm(upper + std::conj(lower)) / square * order_ / noise;
      const double excess = ExcessOf(place.power + more, cells + 1.0);
      if (excess > start.excess) start = {order_, ring_Hz_, excess, side, matched_.loudness};
    }
    return start;
  }

  const VibrationRun& run_;
  double ring_Hz_{};
  const MatchedOrders& matched_;
  std::span<const double> sidebands_;
  double reach_{};
  double channels_{};
  double order_{};
  int first_{};
  int last_{};
  std::map<std::size_t, Turns> turns_;
  // By place.
  std::vector<float> real_;
  std::vector<float> imaginary_;
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
      const double cell = start.order * turn_Hz / (turns * start.ring_Hz);
      return std::abs(other.order - start.order) < 1.5 * cell &&
             std::abs(std::log(other.ring_Hz / start.ring_Hz)) < kOtherRing;
    });
    if (!near) chosen.push_back(start);
  }
  return chosen;
}

}  // namespace

std::vector<TrainStart> FindTrains(const VibrationRemainder& remainder, double lowest, double highest,
                                   std::span<const double> sidebands, std::size_t count,
                                   const std::function<bool(double order)>& allowed) {
  const VibrationRun& run = remainder.samples().runs.front();
  const double turn_Hz = run.mean_speed_rad_per_s / kTwoPi;
  const double reach = *std::ranges::max_element(sidebands);
  RingMatcher matcher(remainder);
  std::vector<TrainStart> found;
  for (double ring = kLowestRing; ring < kHighestRing; ring *= kNextRing) {
    const double ring_Hz = ring / run.period_s;
    if (ring_Hz < 3.0 * turn_Hz) continue;
    const MatchedOrders matched = matcher.Match(ring_Hz, reach, highest);
    TrainSearch search(run, ring_Hz, matched, sidebands);
    const auto own = Strongest(search.Find(lowest, highest, allowed), run.turns, turn_Hz, kTrainsPerRing);
    found.insert(found.end(), own.begin(), own.end());
  }
  return Strongest(std::move(found), run.turns, turn_Hz, count);
}

}  // namespace strainwave::analysis::diagnosis
