// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/bandwidth.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "analysis/diagnosis/motion/kernel.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewestRows = 40;
constexpr double kKeptSignal = 0.9;       // of the acceleration's variance
constexpr double kCorrelated = 4.5;       // standard errors of a correlation coefficient
constexpr double kFollows = 4.0;          // standard errors of a covariance
constexpr double kFarOut = 10.0;          // of the torque's noise in a band; of swings it was 1.7 to 8.5
constexpr double kFewestInBand = 30.0;    // samples
constexpr double kMostlyNoise = 0.3;      // share of the acceleration that the torque shows
constexpr double kMostlyMotion = 0.8;     // the same, where the noise of the path looks wild
constexpr double kImmaterial = 2.0;       // of −2 log-likelihood, over the whole record
constexpr double kClear = 4.0;            // times the noise expected
constexpr double kSeesMotion = 0.3;       // of the acceleration's variance, enough to know the inertia by
constexpr double kNextToNarrowest = 1.3;  // steps in the low-pass
const double kHalfOctave = std::sqrt(2.0);

const std::vector<double>& Moved(const EvenSegment& segment, bool by_velocity) {
  return by_velocity ? segment.velocity : segment.position;
}

std::size_t RowStride(double sigma_s, double step_s) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(kRowSpacing * sigma_s / step_s));
}

// What half an octave holds of acceleration and torque.
struct Band {
  double xx{};  // sums over samples as far apart as the band is wide
  double xy{};
  double yy{};
  double count{};
  double motion_noise{};  // expected of xx and yy
  double torque_noise{};
  double spacing_s{};
};

Band MeasureBand(const MotionSamples& samples, double sigma_s, bool by_velocity) {
  Band band;
  for (const EvenSegment& segment : samples.segments) {
    const KernelTaps of_motion = MakeBandKernel(sigma_s, segment.step_s, by_velocity ? 1 : 2);
    const KernelTaps of_torque = MakeBandKernel(sigma_s, segment.step_s, 0);
    const std::size_t reach = std::max(of_motion.reach, of_torque.reach);
    const std::size_t stride = RowStride(sigma_s, segment.step_s);
    double count = 0.0;
    for (std::size_t i = reach; i + reach < segment.torque.size(); i += stride) {
      const double x = of_motion.At(Moved(segment, by_velocity), i);
      const double y = of_torque.At(segment.torque, i);
      band.xx += x * x;
      band.xy += x * y;
      band.yy += y * y;
      count += 1.0;
    }
    const double of_path = by_velocity ? samples.velocity_noise : samples.position_noise;
    band.motion_noise += count * std::pow(NoiseGain(of_motion) * of_path, 2);
    band.torque_noise += count * std::pow(NoiseGain(of_torque) * samples.torque_noise, 2);
    band.count += count;
    band.spacing_s = std::max(band.spacing_s, static_cast<double>(stride) * segment.step_s);
  }
  return band;
}

// Noise of the path may be wilder than its white part: where time stamps jitter it comes and goes with the
// speed. The top of the spectrum says by how much, in variances; of the fast half of the record, since an
// axis that sticks before it turns has acceleration there, too.
double WildnessOf(const MotionSamples& samples, double sigma_s, bool by_velocity) {
  std::vector<double> values;  // over their white part
  std::vector<double> speeds;
  for (const EvenSegment& segment : samples.segments) {
    const KernelTaps kernel = MakeBandKernel(sigma_s, segment.step_s, by_velocity ? 1 : 2);
    const double white = NoiseGain(kernel) * (by_velocity ? samples.velocity_noise : samples.position_noise);
    if (!(white > 0.0)) return 1.0;
    const std::size_t stride = RowStride(sigma_s, segment.step_s);
    for (std::size_t i = kernel.reach; i + kernel.reach < segment.position.size(); i += stride) {
      values.push_back(kernel.At(Moved(segment, by_velocity), i) / white);
      speeds.push_back(std::abs(segment.position[i + 1] - segment.position[i - 1]) / segment.step_s);
    }
  }
  const double fast = QuantileOfMagnitude(speeds, 0.5);
  std::size_t next = 0;
  std::erase_if(values, [&](double) { return speeds[next++] < fast; });
  return std::max(1.0, std::pow(UsualSize(values), 2));
}

// Whether motion would be lost with the band. The path has to stand clear of its noise there, or the torque
// to follow nearly all of it; where the torque has nothing but noise, correlation has to say as well that it
// follows.
bool HoldsMotion(const Band& band, double inertia, double noise_per_s, double wildness) {
  if (band.count < kFewestInBand) return true;
  if (inertia * inertia * band.xx * band.spacing_s < kImmaterial * noise_per_s) return false;
  const bool correlated = band.xy * band.xy * band.count > kCorrelated * kCorrelated * band.xx * band.yy;
  const double followed = correlated ? std::abs(band.xy) / (std::abs(inertia) * band.xx) : 0.0;
  if (band.xx < kClear * wildness * band.motion_noise && followed < kMostlyMotion) return false;
  return band.yy > kClear * band.torque_noise || followed > kMostlyNoise;
}

// One width of the low-pass that was tried.
struct Trial {
  double inertia{};
  double coulomb{};
  double acceleration_noise{};
  double acceleration_signal{};  // variance, noise taken off
};

Trial TryWidth(const MotionSamples& samples, double sigma_s, bool by_velocity) {
  Trial trial;
  std::vector<Eigen::Vector4d> regressors;
  std::vector<double> torques;
  std::vector<double> velocities;
  double squares = 0.0;
  double sum = 0.0;
  double count = 0.0;
  for (const EvenSegment& segment : samples.segments) {
    const KernelTaps low = MakeKernel(sigma_s, segment.step_s, 0);
    const KernelTaps first = MakeKernel(sigma_s, segment.step_s, 1);
    const KernelTaps second = MakeKernel(sigma_s, segment.step_s, 2);
    trial.acceleration_noise =
        by_velocity ? NoiseGain(first) * samples.velocity_noise : NoiseGain(second) * samples.position_noise;
    const std::size_t stride = RowStride(sigma_s, segment.step_s);
    for (std::size_t i = low.reach; i + low.reach < segment.position.size(); i += stride) {
      const double velocity = first.At(segment.position, i);
      const double acceleration =
          by_velocity ? first.At(segment.velocity, i) : second.At(segment.position, i);
      regressors.emplace_back(acceleration, velocity, velocity > 0.0 ? 1.0 : -1.0, 1.0);
      torques.push_back(low.At(segment.torque, i));
      velocities.push_back(velocity);
      squares += acceleration * acceleration;
      sum += acceleration;
      count += 1.0;
    }
  }
  if (count < 8.0) return trial;
  const auto fit = [&](double slowest) {
    Eigen::Matrix4d gram = Eigen::Matrix4d::Zero();
    Eigen::Vector4d right = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < regressors.size(); ++i) {
      if (std::abs(velocities[i]) < slowest) continue;
      gram += regressors[i] * regressors[i].transpose();
      right += regressors[i] * torques[i];
    }
    const double scale = 1e-12 * gram.trace();
    return Eigen::Vector4d((gram + scale * Eigen::Matrix4d::Identity()).ldlt().solve(right));
  };
  // Where an axis stands, or creeps, friction has nothing of its sign, and the inertia would stand in for it.
  trial.inertia = fit(kMoving * QuantileOfMagnitude(velocities, 0.95))(0);
  trial.coulomb = fit(0.0)(2);
  trial.acceleration_signal =
      squares / count - sum * sum / (count * count) - trial.acceleration_noise * trial.acceleration_noise;
  return trial;
}

// How much of the motion a width sees is known where it stands clear of its noise.
bool IsClear(const Trial& trial) {
  return trial.acceleration_signal > 300.0 * trial.acceleration_noise * trial.acceleration_noise;
}

// How long the record is, and its longest step.
struct Extent {
  double duration_s{};
  double step_s{};
};

struct Choice {
  double sigma_s{};
  double calm_sigma_s{};  // where the noise is nothing any more
  Trial trial;
};

// The widest smoothing that takes nothing away which shows in the torque, nor much of the acceleration.
Choice WidestFor(const MotionSamples& samples, const Extent& extent, double narrowest, double widest,
                 bool by_velocity) {
  const double wildness = WildnessOf(samples, narrowest, by_velocity);
  std::vector<Choice> choices;
  double kept = 0.0;
  double inertia = 0.0;  // by the widest smoothing that sees the motion: noise shrinks it least there
  for (double sigma_s = narrowest; sigma_s <= widest * 1.001; sigma_s *= kHalfOctave) {
    Trial trial = TryWidth(samples, sigma_s, by_velocity);
    trial.acceleration_signal -= (wildness - 1.0) * trial.acceleration_noise * trial.acceleration_noise;
    trial.acceleration_noise *= std::sqrt(wildness);
    if (IsClear(trial)) kept = std::max(kept, trial.acceleration_signal);
    if (IsClear(trial) && trial.acceleration_signal < kSeesMotion * kept) break;
    inertia = trial.inertia;
    choices.push_back({sigma_s, sigma_s, trial});
  }
  const double noise_per_s =
      std::pow(NoiseGain(MakeKernel(narrowest, extent.step_s, 0)) * samples.torque_noise, 2) * kRowSpacing *
      narrowest;
  const Choice* chosen = &choices.front();
  double narrower = 0.0;  // signal of what is narrower
  for (const Choice& choice : choices) {
    if (IsClear(choice.trial)) {
      if (choice.trial.acceleration_signal < kKeptSignal * narrower) break;
      narrower = std::max(narrower, choice.trial.acceleration_signal);
    }
    chosen = &choice;
    // Of the noise that is left, over the record; and of the acceleration.
    const double noise = inertia * choice.trial.acceleration_noise;
    if (noise * noise * extent.duration_s < kImmaterial * noise_per_s) break;
    const Band band = MeasureBand(samples, choice.sigma_s, by_velocity);
    if (HoldsMotion(band, inertia, noise_per_s, wildness)) break;
  }
  double calm_sigma_s = chosen->sigma_s;
  for (double noise = inertia * chosen->trial.acceleration_noise;
       noise * noise * extent.duration_s > kImmaterial * noise_per_s && calm_sigma_s < widest;
       noise /= std::pow(kHalfOctave, by_velocity ? 1.5 : 2.5))
    calm_sigma_s *= kHalfOctave;
  return {chosen->sigma_s,
          calm_sigma_s / kHalfOctave,
          {inertia, chosen->trial.coulomb, chosen->trial.acceleration_noise, 0.0}};
}

// The low-pass that takes away the bands of the torque in which it follows motion that the path, smoothed
// since its time stamps are off, does not show: an axis in closed loop swings there, and that would be taken
// for a resonance, or for play. Of 28 axes of tests/blind without any effect (seed 5371) 13 had such stamps,
// and six of these got one.
double WithoutHiddenMotion(const MotionSamples& samples, const MotionBandwidth& bandwidth) {
  double sigma_s = bandwidth.sigma_s;
  if (samples.stamp_error_s == 0.0 || std::ranges::none_of(samples.segments, &EvenSegment::resampled))
    return sigma_s;
  for (double band_s = sigma_s; band_s < 0.99 * bandwidth.path_sigma_s; band_s *= kHalfOctave) {
    const Band band = MeasureBand(samples, band_s, bandwidth.by_velocity);
    const double error = std::sqrt(band.xx * band.yy / std::max(band.count, 1.0));
    const bool follows = bandwidth.inertia * band.xy > kFollows * std::abs(bandwidth.inertia) * error;
    // What stands far out of the noise are transients, which have rows of their own.
    if (follows && band.yy < kFarOut * band.torque_noise)
      sigma_s = std::min(kHalfOctave * band_s, bandwidth.path_sigma_s);
  }
  return sigma_s;
}

}  // namespace

bool KeepsUpWith(const MotionBandwidth& bandwidth, double step_s) {
  return bandwidth.sigma_s < kNextToNarrowest * step_s;
}

MotionBandwidth ChooseBandwidth(const MotionSamples& samples, std::size_t most_rows) {
  Extent extent;
  bool has_velocity = true;
  for (const EvenSegment& segment : samples.segments) {
    extent.duration_s += static_cast<double>(segment.position.size()) * segment.step_s;
    extent.step_s = std::max(extent.step_s, segment.step_s);
    has_velocity = has_velocity && !segment.velocity.empty();
  }
  MotionBandwidth bandwidth;
  bandwidth.sigma_s = std::max(kNarrowestKernel * extent.step_s,
                               extent.duration_s / (kRowSpacing * static_cast<double>(most_rows)));
  const double widest =
      std::max(bandwidth.sigma_s, extent.duration_s / (kRowSpacing * static_cast<double>(kFewestRows)));
  double quietest = std::numeric_limits<double>::max();
  for (const bool by_velocity : {false, true}) {
    if (by_velocity && !has_velocity) continue;
    const auto [sigma_s, calm_sigma_s, trial] =
        WidestFor(samples, extent, bandwidth.sigma_s, widest, by_velocity);
    // The column that shows more of the motion; of two that show the same, the quieter one.
    const bool shows_more = sigma_s < 0.99 * bandwidth.path_sigma_s;
    const bool shows_less = by_velocity && sigma_s > 1.01 * bandwidth.path_sigma_s;
    if (by_velocity && (shows_less || (!shows_more && trial.acceleration_noise >= quietest))) continue;
    quietest = trial.acceleration_noise;
    bandwidth.path_sigma_s = sigma_s;
    bandwidth.calm_sigma_s = calm_sigma_s;
    bandwidth.by_velocity = by_velocity;
    bandwidth.inertia = trial.inertia;
    bandwidth.coulomb = std::abs(trial.coulomb);
  }
  bandwidth.sigma_s = WithoutHiddenMotion(samples, bandwidth);
  const KernelTaps kernel = MakeKernel(bandwidth.path_sigma_s, extent.step_s, bandwidth.by_velocity ? 0 : 1);
  bandwidth.velocity_noise =
      NoiseGain(kernel) * (bandwidth.by_velocity ? samples.velocity_noise : samples.position_noise);
  return bandwidth;
}

}  // namespace strainwave::analysis::diagnosis
