// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/impulse_train.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "analysis/diagnosis/phasors.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;

Complex PoleOf(const ImpulseTrain& train) { return ResonancePole(train.resonance_Hz, train.damping_ratio); }

// What a response is turned and damped by from sample to sample. Steps are even but for the last digit of
// their time stamps, for which a few powers do.
class PoleStep {
 public:
  PoleStep(Complex pole, double period_s)
      : pole_(pole), period_s_(period_s), even_(std::exp(pole * period_s)) {}

  Complex operator()(double step_s) const {
    constexpr double kSmall = 1e-4;  // of a squared turn: the next power is below 1e-12
    const Complex more = pole_ * (step_s - period_s_);
    if (!(std::norm(more) < kSmall)) return std::exp(pole_ * step_s);
    // What time stamps are rounded by: the square is lost in the last digit of one.
    constexpr double kRounding = 1e-18;
    if (std::norm(more) < kRounding) return Product(even_, 1.0 + more);
    const Complex powers = 1.0 + Product(more / 2.0, 1.0 + Product(more / 3.0, 1.0 + more / 4.0));
    return Product(even_, 1.0 + Product(more, powers));
  }

 private:
  Complex pole_;
  double period_s_;
  Complex even_;
};

double Impulses(const VibrationRun& run, const ImpulseTrain& train, std::size_t sample) {
  return (run.angle_rad[sample] - 0.5 * run.angle_rad.back()) * train.order / kTwoPi - train.phase;
}

}  // namespace

Complex ResonancePole(double resonance_Hz, double damping_ratio) {
  const double natural = kTwoPi * resonance_Hz;
  return {-damping_ratio * natural, natural * std::sqrt(std::max(0.0, 1.0 - damping_ratio * damping_ratio))};
}

double ImpulseTrain::SlipOf(double impulse) const {
  if (slips.empty()) return 0.0;
  const auto last = static_cast<double>(slips.size() - 1);
  return slips[static_cast<std::size_t>(std::clamp(impulse + std::floor(0.5 * last), 0.0, last))];
}

namespace {

// An impulse as it is observable at a sample behind it.
struct ObservableImpulse {
  double angle_rad{};
  double speed_rad_per_s{};
  double since_s{};
  Complex left{};  // of its response
};

// Goes through a run with the impulses of a train.
// @param add      takes the impulses that came since the last sample, or before the record
// @param advance  takes a step of time from sample to sample, and by what a response is turned and damped in
//   it
// @param take     takes the sample
template <typename Add, typename Advance, typename Take>
void GoThrough(const VibrationRun& run, const ImpulseTrain& train, const Add& add, const Advance& advance,
               const Take& take) {
  const Complex pole = PoleOf(train);
  const PoleStep step(pole, run.period_s);
  // What rang before the record began: the train goes on backwards at the first speed until it has died away.
  const double first_speed = std::max(run.speed_rad_per_s.front(), 1e-9);
  const double apart_s = kTwoPi / (train.order * first_speed);
  const double begin = Impulses(run, train, 0);
  const auto position_of = [&train](double impulse) { return impulse + train.SlipOf(impulse); };
  double next = std::floor(begin) + 1.0;
  while (position_of(next) <= begin) next += 1.0;
  while (position_of(next - 1.0) > begin) next -= 1.0;
  for (int back = 1; back <= 200; ++back) {
    const double since_s = (begin - position_of(next - back)) * apart_s;
    const Complex left = std::exp(pole * since_s);
    if (std::norm(left) < 1e-8) break;
    add(ObservableImpulse{run.angle_rad.front() - since_s * first_speed, first_speed, since_s, left});
  }
  take(0);
  const double per_angle = train.order / kTwoPi;
  const double offset = 0.5 * run.angle_rad.back() * per_angle + train.phase;
  for (std::size_t i = 1; i < run.size(); ++i) {
    const double step_s = run.time_s[i] - run.time_s[i - 1];
    advance(step_s, step(step_s));
    const double here = per_angle * run.angle_rad[i] - offset;
    for (; position_of(next) <= here; next += 1.0) {
      const double turned_rad = run.angle_rad[i] - run.angle_rad[i - 1];
      const double before = per_angle * run.angle_rad[i - 1] - offset;
      const double share = (position_of(next) - before) / (here - before);
      const double since_s = (1.0 - share) * step_s;
      add(ObservableImpulse{run.angle_rad[i - 1] + share * turned_rad, turned_rad / std::max(step_s, 1e-300),
                            since_s, std::exp(pole * since_s)});
    }
    take(i);
  }
}

// Height of an impulse at an angle, and its slope by that.
struct ImpulseHeight {
  double height{1.0};
  double slope_per_rad{};
};
ImpulseHeight HeightAt(const ImpulseTrain& train, double angle_rad) {
  ImpulseHeight at;
  for (const auto& [order, cosine, sine] : train.modulations) {
    const double c = std::cos(order * angle_rad);
    const double s = std::sin(order * angle_rad);
    at.height += cosine * c + sine * s;
    at.slope_per_rad += order * (sine * c - cosine * s);
  }
  return at;
}

}  // namespace

Eigen::VectorXd ImpulseTrainColumn(const VibrationRun& run, const ImpulseTrain& train) {
  Eigen::VectorXd column(static_cast<Index>(run.size()));
  Complex state;
  GoThrough(
      run, train,
      [&](const ObservableImpulse& impulse) {
        state += HeightAt(train, impulse.angle_rad).height * impulse.left;
      },
      [&](double, Complex step) { state = Product(state, step); },
      [&](std::size_t i) { column(static_cast<Index>(i)) = state.imag(); });
  return column;
}

Eigen::MatrixXd ImpulseTrainSlopes(const VibrationRun& run, const ImpulseTrain& train) {
  const std::size_t changes = train.modulations.size();
  const Complex pole = PoleOf(train);
  const double natural = kTwoPi * train.resonance_Hz;
  const double root = std::sqrt(std::max(1e-12, 1.0 - train.damping_ratio * train.damping_ratio));
  const Complex pole_by_damping{-natural, -natural * train.damping_ratio / root};
  const double middle_rad = 0.5 * run.angle_rad.back();
  // The responses, and the responses times their age: those turn and damp by another pole.
  Complex responses;
  Complex aged;
  // Impulses that come at another time, by order and by phase, then their changes.
  std::vector<Complex> states(2 + 2 * changes);
  Eigen::MatrixXd slopes(static_cast<Index>(run.size()), static_cast<Index>(4 + 2 * changes));
  GoThrough(
      run, train,
      [&](const ObservableImpulse& impulse) {
        const ImpulseHeight at = HeightAt(train, impulse.angle_rad);
        responses += at.height * impulse.left;
        aged += at.height * impulse.since_s * impulse.left;
        const Complex by_angle =
            (at.slope_per_rad - pole * at.height / impulse.speed_rad_per_s) * impulse.left;
        states[0] -= (impulse.angle_rad - middle_rad) / train.order * by_angle;
        states[1] += kTwoPi / train.order * by_angle;
        for (std::size_t m = 0; m < changes; ++m) {
          const double angle = train.modulations[m].order * impulse.angle_rad;
          states[2 + 2 * m] += std::cos(angle) * impulse.left;
          states[3 + 2 * m] += std::sin(angle) * impulse.left;
        }
      },
      [&](double step_s, Complex step) {
        aged = Product(aged + step_s * responses, step);
        responses = Product(responses, step);
        for (Complex& state : states) state = Product(state, step);
      },
      [&](std::size_t i) {
        auto row = slopes.row(static_cast<Index>(i));
        row(0) = states[0].imag();
        row(1) = Product(pole / train.resonance_Hz, aged).imag();
        row(2) = Product(pole_by_damping, aged).imag();
        for (std::size_t m = 0; m < 2 * changes; ++m) row(static_cast<Index>(3 + m)) = states[2 + m].imag();
        row(static_cast<Index>(3 + 2 * changes)) = states[1].imag();
      });
  return slopes;
}

void AddTransient(const VibrationRun& run, double resonance_Hz, double damping_ratio, double start_s,
                  double height, Eigen::Ref<Eigen::VectorXd> column) {
  const Complex pole = ResonancePole(resonance_Hz, damping_ratio);
  const auto first = std::lower_bound(run.time_s.begin(), run.time_s.end(), start_s) - run.time_s.begin();
  const PoleStep step(pole, run.period_s);
  Complex state = 1.0;
  double before_s = start_s;
  for (auto i = static_cast<std::size_t>(first); i < run.size() && std::norm(state) > 1e-8; ++i) {
    state = Product(state, step(run.time_s[i] - before_s));
    before_s = run.time_s[i];
    column(static_cast<Index>(i)) += height * state.imag();
  }
}

Impact OneOf(const Impact& first, const Impact& second, double resonance_Hz, double damping_ratio) {
  const Complex pole = ResonancePole(resonance_Hz, damping_ratio);
  // Size and phase at the start of the first; the sign makes up for half a turn of the phase.
  const Complex sum = first.height + second.height * std::exp(pole * (first.start_s - second.start_s));
  const double sign = sum.real() < 0.0 ? -1.0 : 1.0;
  const double later_s = -std::arg(sign * sum) / pole.imag();
  return {first.start_s + later_s, sign * std::abs(sum) * std::exp(pole.real() * later_s)};
}

}  // namespace strainwave::analysis::diagnosis
