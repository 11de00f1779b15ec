// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/bandwidth.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/motion/kernel.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewestRows = 120;
constexpr double kKeptSignal = 0.9;   // of the acceleration's variance
constexpr double kFewEdges = 0.01;    // of the record
constexpr double kNegligible = 1e-3;  // noise of the acceleration, of itself
constexpr double kHidden = 2.0;       // standard deviations of a record's whole −2 log-likelihood

// One width of the low-pass that was tried.
struct Trial {
  double sigma_s{};
  double inertia{};
  double coulomb{};
  double acceleration_noise{};
  double acceleration_signal{};  // variance, noise taken off
};

Trial TryWidth(const MotionSamples& samples, double sigma_s, bool by_velocity) {
  Trial trial;
  trial.sigma_s = sigma_s;
  Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  double squares = 0.0;
  double sum = 0.0;
  double count = 0.0;
  for (const EvenStretch& stretch : samples.stretches) {
    const KernelTaps low = MakeKernel(sigma_s, stretch.step_s, 0);
    const KernelTaps first = MakeKernel(sigma_s, stretch.step_s, 1);
    const KernelTaps second = MakeKernel(sigma_s, stretch.step_s, 2);
    trial.acceleration_noise =
        by_velocity ? NoiseGain(first) * samples.velocity_noise : NoiseGain(second) * samples.position_noise;
    const auto stride =
        std::max<std::size_t>(1, static_cast<std::size_t>(kRowSpacing * sigma_s / stretch.step_s));
    for (std::size_t i = low.reach; i + low.reach < stretch.position.size(); i += stride) {
      const double velocity = first.At(stretch.position, i);
      const double acceleration =
          by_velocity ? first.At(stretch.velocity, i) : second.At(stretch.position, i);
      const Eigen::Vector4d x(acceleration, velocity, velocity > 0.0 ? 1.0 : -1.0, 1.0);
      gram += x * x.transpose();
      right += x * low.At(stretch.torque, i);
      squares += acceleration * acceleration;
      sum += acceleration;
      count += 1.0;
    }
  }
  if (count < 8.0) return trial;
  const double scale = 1e-12 * gram.trace();
  const Eigen::Vector4d numbers = (gram + scale * Eigen::Matrix4d::Identity()).ldlt().solve(right);
  trial.inertia = numbers(0);
  trial.coulomb = numbers(2);
  trial.acceleration_signal =
      squares / count - sum * sum / (count * count) - trial.acceleration_noise * trial.acceleration_noise;
  return trial;
}

// Share of the record in which a narrower smoothing sees another acceleration than noise explains.
double ShareOfEdges(const MotionSamples& samples, double sigma_s, bool by_velocity) {
  const double narrower = sigma_s / std::sqrt(2.0);
  const int derivative = by_velocity ? 1 : 2;
  const double noise = by_velocity ? samples.velocity_noise : samples.position_noise;
  double edges = 0.0;
  double all = 0.0;
  for (const EvenStretch& stretch : samples.stretches) {
    const std::vector<double>& moved = by_velocity ? stretch.velocity : stretch.position;
    const KernelTaps wide = MakeKernel(sigma_s, stretch.step_s, derivative);
    KernelTaps difference = wide;
    const KernelTaps narrow = MakeKernel(narrower, stretch.step_s, derivative);
    for (std::size_t k = 0; k < narrow.taps.size(); ++k)
      difference.taps[wide.reach - narrow.reach + k] -= narrow.taps[k];
    const double limit = 4.5 * NoiseGain(difference) * noise;
    const auto stride = std::max<std::size_t>(1, static_cast<std::size_t>(0.5 * sigma_s / stretch.step_s));
    for (std::size_t i = wide.reach; i + wide.reach < moved.size(); i += stride) {
      all += 1.0;
      if (std::abs(difference.At(moved, i)) > limit) edges += 1.0;
    }
  }
  return all > 0.0 ? edges / all : 1.0;
}

double VelocityNoise(const MotionSamples& samples, double step_s, const MotionBandwidth& bandwidth) {
  return bandwidth.by_velocity
             ? NoiseGain(MakeKernel(bandwidth.fine_sigma_s, step_s, 0)) * samples.velocity_noise
             : NoiseGain(MakeKernel(bandwidth.fine_sigma_s, step_s, 1)) * samples.position_noise;
}

// The smoothing at which velocity noise moves a reversal by as much as the smoothing blurs it.
void ChooseFine(const MotionSamples& samples, double step_s, double acceleration,
                MotionBandwidth& bandwidth) {
  for (double sigma_s = kNarrowestKernel * step_s; sigma_s <= 3.0 * bandwidth.sigma_s * 1.001;
       sigma_s *= std::sqrt(2.0)) {
    bandwidth.fine_sigma_s = sigma_s;
    bandwidth.velocity_noise = VelocityNoise(samples, step_s, bandwidth);
    if (bandwidth.velocity_noise <= 0.5 * acceleration * sigma_s) break;
  }
}

}  // namespace

MotionBandwidth ChooseBandwidth(const MotionSamples& samples, std::size_t most_rows) {
  double duration_s = 0.0;
  double step_s = 0.0;
  bool has_velocity = true;
  for (const EvenStretch& stretch : samples.stretches) {
    duration_s += static_cast<double>(stretch.position.size()) * stretch.step_s;
    step_s = std::max(step_s, stretch.step_s);
    has_velocity = has_velocity && !stretch.velocity.empty();
  }
  const double narrowest =
      std::max(kNarrowestKernel * step_s, duration_s / (kRowSpacing * static_cast<double>(most_rows)));
  const double widest = std::max(narrowest, duration_s / (kRowSpacing * static_cast<double>(kFewestRows)));
  MotionBandwidth bandwidth;
  double signal = 0.0;
  bandwidth.path_sigma_s = 2.0 * widest;
  const double rows = duration_s / (kRowSpacing * narrowest);
  const double torque_noise = NoiseGain(MakeKernel(narrowest, step_s, 0)) * samples.torque_noise;
  // The velocity column is taken where it lets the corner be higher.
  for (const bool by_velocity : {false, true}) {
    if (by_velocity && !has_velocity) continue;
    std::vector<Trial> trials;
    for (double sigma_s = narrowest; sigma_s <= widest * 1.001 && trials.size() < 20;
         sigma_s *= std::sqrt(2.0)) {
      trials.push_back(TryWidth(samples, sigma_s, by_velocity));
    }
    // The signal that a width keeps is known where it stands clear of its noise.
    double most_signal = 0.0;
    for (const Trial& trial : trials) {
      if (trial.acceleration_signal > 30.0 * trial.acceleration_noise * trial.acceleration_noise) {
        most_signal = std::max(most_signal, trial.acceleration_signal);
      }
    }
    const Trial* keeps = &trials.back();    // widest that keeps the signal
    const Trial* inertia = &trials.back();  // widest that still sees the motion: least shrunk by noise
    const Trial* quiet = &trials.back();    // narrowest whose noise does not show beside that of the torque
    for (const Trial& trial : trials) {
      if (most_signal > 0.0 && trial.acceleration_signal >= kKeptSignal * most_signal) keeps = &trial;
      if (most_signal > 0.0 && trial.acceleration_signal >= 0.3 * most_signal) inertia = &trial;
    }
    const double hidden =
        std::max(kHidden / std::sqrt(rows) * torque_noise / std::max(std::abs(inertia->inertia), 1e-300),
                 kNegligible * std::sqrt(most_signal));
    for (const Trial& trial : trials) {
      if (trial.acceleration_noise > hidden) continue;
      quiet = &trial;
      break;
    }
    const double sigma_s = std::min(quiet->sigma_s, keeps->sigma_s);
    if (sigma_s >= bandwidth.path_sigma_s) continue;
    bandwidth.path_sigma_s = sigma_s;
    bandwidth.by_velocity = by_velocity;
    bandwidth.inertia = inertia->inertia;
    bandwidth.coulomb = std::abs(inertia->coulomb);
    signal = std::max(0.0, most_signal > 0.0 ? most_signal : trials.back().acceleration_signal);
  }
  bandwidth.sigma_s = bandwidth.path_sigma_s;
  if (bandwidth.path_sigma_s > 1.2 * narrowest &&
      ShareOfEdges(samples, bandwidth.path_sigma_s, bandwidth.by_velocity) < kFewEdges) {
    bandwidth.sigma_s = narrowest;
    bandwidth.fine_sigma_s = bandwidth.path_sigma_s;
    bandwidth.velocity_noise = VelocityNoise(samples, step_s, bandwidth);
    return bandwidth;
  }
  ChooseFine(samples, step_s, std::sqrt(signal), bandwidth);
  return bandwidth;
}

}  // namespace strainwave::analysis::diagnosis
