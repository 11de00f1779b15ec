// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/trains.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr double kDamping = 0.03;      // of the rings that are tried; a match to twice or half of it is good
constexpr double kNextRing = 1.07;     // about a width of the resonance apart
constexpr double kLowestRing = 0.03;   // of the sampling rate
constexpr double kHighestRing = 0.45;  // of the sampling rate
constexpr double kEdge = 4.0;          // half-widths of the resonance that count
constexpr double kLeastOverlap = 0.4;
constexpr double kLeastExcess = 9.0;
constexpr std::size_t kPadding = 4;
constexpr std::size_t kSpeeds = 48;
constexpr std::size_t kLooksPerRing = 60;
constexpr std::size_t kTrainsPerRing = 3;

// The residual, matched to a ring, over orders of the input angle.
struct MatchedOrders {
  double first{};
  double step{};
  std::vector<std::vector<Complex>> of_channel;
  std::vector<float> power;  // of all channels
  std::vector<float> noise;  // power that a channel has without impulses; its integral over the orders is one

  double last() const { return first + step * static_cast<double>(power.size() - 1); }
  std::size_t PlaceOf(double order) const { return static_cast<std::size_t>((order - first) / step + 0.5); }
  Complex At(std::size_t channel, double order) const {
    const std::size_t place = PlaceOf(order);
    return place < power.size() ? of_channel[channel][place] : Complex{};
  }
};

class RingMatcher {
 public:
  explicit RingMatcher(const VibrationRemainder& remainder)
      : remainder_(remainder), run_(remainder.samples().runs.front()), filtered_(run_.size()) {
    const auto [slowest, fastest] = std::ranges::minmax(run_.speed_rad_per_s);
    slowest_ = std::max(slowest, 1e-9);
    fastest_ = std::max(fastest, 1e-9);
  }

  MatchedOrders Match(double ring_Hz, double reach) {
    const double natural = kTwoPi * ring_Hz;
    const Complex step = std::exp(
        Complex(-kDamping * natural, natural * std::sqrt(1.0 - kDamping * kDamping)) * run_.period_s);
    const double half_width = kDamping * natural;
    const double first = std::max(0.5, (natural - kEdge * half_width) / fastest_ - reach);
    const double last = std::max(first + 1.0, (natural + kEdge * half_width) / slowest_ + reach);
    const double centre = 0.5 * (first + last);
    // What is matched to a narrow ring changes slowly beside it: a few samples a bandwidth are enough.
    const auto places = static_cast<std::size_t>(1.3 * (last - first) * run_.turns) + 8;
    const std::size_t size = std::bit_ceil(kPadding * places);
    const double angle_step = run_.angle_rad.back() / static_cast<double>(places);
    std::vector<Complex> turns(run_.size());
    for (std::size_t i = 0; i < run_.size(); ++i) turns[i] = std::polar(1.0, -centre * run_.angle_rad[i]);

    MatchedOrders matched;
    matched.step = kTwoPi / (static_cast<double>(size) * angle_step);
    const auto below = static_cast<std::size_t>((centre - first) / matched.step);
    const auto above = static_cast<std::size_t>((last - centre) / matched.step);
    matched.first = centre - matched.step * static_cast<double>(below);
    matched.power.resize(below + above + 1, 0.0F);
    const double scale = angle_step *
                         std::sqrt((1.0 - std::norm(step)) / (remainder_.base().variance() * run_.turns)) /
                         kTwoPi;
    Foretell(natural, half_width, matched);
    for (const VibrationStretch& channel : run_.channels) {
      Filter(channel, step, turns);
      values_.assign(size, Complex{});
      std::size_t i = 0;
      for (std::size_t p = 0; p < places; ++p) {
        const double angle = angle_step * static_cast<double>(p);
        while (i + 2 < run_.size() && run_.angle_rad[i + 1] <= angle) ++i;
        const double gap = run_.angle_rad[i + 1] - run_.angle_rad[i];
        const double u = gap > 0.0 ? std::clamp((angle - run_.angle_rad[i]) / gap, 0.0, 1.0) : 0.0;
        values_[p] = scale * ((1.0 - u) * filtered_[i] + u * filtered_[i + 1]);
      }
      transform_.fwd(spectrum_, values_);
      std::vector<Complex> lines(matched.power.size());
      for (std::size_t k = 0; k < lines.size(); ++k) {
        // Phases from the middle of the record, so that they change slowly with the order.
        const double off = matched.step * (static_cast<double>(k) - static_cast<double>(below));
        lines[k] = spectrum_[(size + k - below) % size] * std::polar(1.0, 0.5 * off * run_.angle_rad.back());
        matched.power[k] += static_cast<float>(std::norm(lines[k]));
      }
      matched.of_channel.push_back(std::move(lines));
    }
    return matched;
  }

 private:
  // The resonance is a Lorentz line over frequency; over orders it is smeared by the speeds.
  void Foretell(double natural, double half_width, MatchedOrders& matched) const {
    const std::size_t speeds = run_.speed_spread < 0.01 ? 1 : kSpeeds;
    matched.noise.assign(matched.power.size(), 0.0F);
    constexpr std::size_t kEvery = 8;  // bins; the noise is smooth
    for (std::size_t s = 0; s < speeds; ++s) {
      const double angle =
          run_.angle_rad.back() * (static_cast<double>(s) + 0.5) / static_cast<double>(speeds);
      const auto at = std::ranges::lower_bound(run_.angle_rad, angle) - run_.angle_rad.begin();
      const double speed = std::max(run_.speed_rad_per_s[static_cast<std::size_t>(at)], 1e-9);
      for (std::size_t k = 0; k < matched.noise.size(); k += kEvery) {
        const double order = matched.first + matched.step * static_cast<double>(k);
        const double off = (order * speed - natural) / half_width;
        matched.noise[k] +=
            static_cast<float>(speed / (kPi * half_width * (1.0 + off * off)) / static_cast<double>(speeds));
      }
    }
    for (std::size_t k = 0; k < matched.noise.size(); ++k)
      matched.noise[k] = matched.noise[k / kEvery * kEvery];
  }

  void Filter(const VibrationStretch& channel, Complex step, const std::vector<Complex>& turns) {
    Complex common{};
    for (std::size_t i = run_.size(); i-- > 0;) {
      const std::size_t place = channel.first + i;
      common =
          common * step + (remainder_.solver().weights()[place] > 0.0 ? remainder_.residual()[place] : 0.0);
      filtered_[i] = std::conj(common) * turns[i];
    }
  }

  const VibrationRemainder& remainder_;
  const VibrationRun& run_;
  double slowest_{};
  double fastest_{};
  std::vector<Complex> filtered_;
  std::vector<Complex> values_;
  std::vector<Complex> spectrum_;
  Eigen::FFT<double> transform_;
};

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
    std::vector<std::pair<double, double>> looks;  // excess, order
    const double step = 0.4 / (run_.turns * (matched_.last() - reach_));
    for (double order = lowest; order < highest; order *= 1.0 + step) {
      SetOrder(order);
      if (last_ < first_ || !allowed(order)) continue;
      looks.emplace_back(Incoherent(), order);
    }
    // The power without phases takes a fraction of the work: what is far down there does not come out on top
    // with them.
    const std::size_t kept = std::min(looks.size(), kLooksPerRing);
    std::partial_sort(looks.begin(), looks.begin() + static_cast<std::ptrdiff_t>(kept), looks.end(),
                      std::greater<>());
    looks.resize(kept);
    std::vector<TrainStart> found;
    for (const auto& [look, order] : looks) {
      SetOrder(order);
      const double excess = Coherent();
      if (excess > kLeastExcess) found.push_back({order, ring_Hz_, excess});
    }
    return found;
  }

 private:
  void SetOrder(double order) {
    order_ = order;
    first_ = static_cast<int>(std::ceil((matched_.first + reach_) / order));
    last_ = static_cast<int>(std::floor((matched_.last() - reach_) / order));
  }

  // Power of the harmonics moved by `side`, beside what noise has there.
  struct Look {
    double power{};
    double noise{};  // a channel
    double cells{};  // harmonics that share most of it
  };
  Look LookAt(double side) const {
    Look look;
    double squares = 0.0;
    for (int k = first_; k <= last_; ++k) {
      const std::size_t place = matched_.PlaceOf(k * order_ + side);
      if (place >= matched_.power.size()) continue;
      const auto noise = static_cast<double>(matched_.noise[place]);
      look.power += static_cast<double>(matched_.power[place]);
      look.noise += noise;
      squares += noise * noise;
    }
    look.cells = squares > 0.0 ? look.noise * look.noise / squares : 0.0;
    look.power *= order_;
    look.noise *= order_;
    return look;
  }

  double Incoherent() const {
    const Look plain = LookAt(0.0);
    if (plain.noise < kLeastOverlap) return 0.0;
    double excess = 0.0;
    for (const double side : sidebands_) {
      double sum = plain.power / plain.noise * plain.cells;
      double cells = channels_ * plain.cells;
      for (const double off : {-side, side}) {
        if (side == 0.0) break;
        const Look look = LookAt(off);
        if (look.noise < 0.2 * kLeastOverlap) continue;
        sum += look.power / look.noise * look.cells;
        cells += channels_ * look.cells;
      }
      excess = std::max(excess, ExcessOf(sum, cells));
    }
    return excess;
  }

  // For each place of the impulses, one a channel under noise.
  std::vector<double> PowersByPlace(double side) {
    const double noise = std::max(0.2 * kLeastOverlap, LookAt(side).noise);
    const auto harmonics = static_cast<std::size_t>(last_ - first_ + 1);
    const std::size_t places = harmonics > 1 ? 4 * harmonics : 1;
    std::vector<double> powers(places, 0.0);
    for (std::size_t c = 0; c < matched_.of_channel.size(); ++c) {
      lines_.clear();
      for (int k = first_; k <= last_; ++k) lines_.push_back(matched_.At(c, k * order_ + side));
      for (std::size_t p = 0; p < places; ++p) {
        const Complex turn = std::polar(1.0, kTwoPi * static_cast<double>(p) / static_cast<double>(places));
        Complex amplitude{};
        for (std::size_t k = harmonics; k-- > 0;) amplitude = amplitude * turn + lines_[k];
        powers[p] += order_ / noise * std::norm(amplitude);
      }
    }
    return powers;
  }

  double Coherent() {
    const std::vector<double> plain = PowersByPlace(0.0);
    double excess = 0.0;
    for (const double side : sidebands_) {
      std::vector<double> powers = plain;
      for (const double off : {-side, side}) {
        if (side == 0.0) break;
        const std::vector<double> more = PowersByPlace(off);
        for (std::size_t p = 0; p < powers.size(); ++p) powers[p] += more[p];
      }
      const double cells = channels_ * (side > 0.0 ? 3.0 : 1.0);
      excess = std::max(excess, ExcessOf(*std::ranges::max_element(powers), cells));
    }
    return excess;
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
  std::vector<Complex> lines_;
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
      return std::abs(other.order - start.order) < 1.5 * cell;
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
    const MatchedOrders matched = matcher.Match(ring_Hz, reach);
    TrainSearch search(run, ring_Hz, matched, sidebands);
    const auto own = Strongest(search.Find(lowest, highest, allowed), run.turns, turn_Hz, kTrainsPerRing);
    found.insert(found.end(), own.begin(), own.end());
  }
  return Strongest(std::move(found), run.turns, turn_Hz, count);
}

}  // namespace strainwave::analysis::diagnosis
