// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/acceleration_transients.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kStandsOut =
    2.5;  // times the noise of a band, from which on an acceleration transient shows in it
constexpr double kStandsOutAtLeast = 1.5;  // the same where what hides in the noise shows in the torque
constexpr double kStandsOutAlone = 6.0;    // the same of a band that no other bears out
constexpr double kFast = 0.5;      // of the 95 % quantile of the speed: where noise that goes with it shows
constexpr double kCalm = 0.5;      // of the time that an axis is fast, from which on it is calm then
constexpr double kNoMore = 1.2;    // times the noise expected, which is no more than that
constexpr double kAround = 2.0;    // σ to either side, over which a band's size at a point is taken
constexpr double kFollowed = 0.3;  // of the inertia, from which on the torque follows a calm band
constexpr double kBeyond = 0.3;    // of the last band: what lies beyond it and folds back into the torque
// A band over the one half an octave lower: of a fast oscillation, and the most of a jump.
constexpr double kFastOscillation = 1.5;
constexpr double kUneven = 1.15;
// Shares of the acceleration transients that are jumps.
constexpr double kFewJumps = 0.35;
constexpr double kMostlyJumps = 0.5;
constexpr double kManySamples = 2.0;  // in the smoothing of the path
// A band over the one half an octave lower, at most: a kink in the acceleration.
const double kSlowestDecay = 1.0 / std::numbers::sqrt2;

// The same, above which it is one.
constexpr double kKink = 0.5;

// Half an octave of the acceleration, at the points.
struct AccelerationBand {
  std::vector<double> values;
  std::vector<double> mean_squares;  // around each
  std::vector<double> noise;         // standard deviations
  std::vector<double> white;         // of the part that the path's noise makes
};

// Mean squares over `half` points to either side.
void AddMeanSquares(std::span<const double> values, std::size_t half, std::vector<double>& means) {
  std::vector<double> sums(values.size() + 1, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i] * values[i];
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i > half ? i - half : 0;
    const std::size_t to = std::min(i + half + 1, values.size());
    means.push_back((sums[to] - sums[from]) / static_cast<double>(to - from));
  }
}

// Of what the path is smoothed from, at a speed.
double PathNoise(const MotionSamples& samples, const MotionBandwidth& bandwidth, double speed) {
  return bandwidth.by_velocity ? samples.velocity_noise : samples.PositionNoise(speed);
}

AccelerationBand MeasureAccelerationBand(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                                         std::span<const PointLayout> layouts, const MotionGrid& grid,
                                         double sigma_s) {
  AccelerationBand band;
  band.values.assign(grid.time_s.size(), 0.0);
  const double top_speed = QuantileOfMagnitude(grid.velocity, 0.95);
  std::vector<double> moving;
  std::vector<double> fast;
  std::vector<double> by_speed;
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const MotionGrid::Segment& segment = grid.segments[s];
    const EvenSegment& raw = samples.segments[s];
    const std::vector<double>& moved = bandwidth.by_velocity ? raw.velocity : raw.position;
    const KernelTaps kernel = MakeBandKernel(sigma_s, raw.step_s, bandwidth.by_velocity ? 1 : 2);
    const double gain = NoiseGain(kernel);
    for (std::size_t i = 0; i < segment.count; ++i) {
      const std::size_t sample = layouts[s].SampleOf(i);
      const double speed = std::abs(grid.velocity[segment.first + i]);
      band.white.push_back(gain * PathNoise(samples, bandwidth, speed));
      if (sample < kernel.reach || sample + kernel.reach >= moved.size()) continue;
      const double value = kernel.At(moved, sample);
      band.values[segment.first + i] = value;
      if (speed > kMoving * top_speed) moving.push_back(value);
      if (speed > kFast * top_speed) {
        fast.push_back(value);
        by_speed.push_back(value / speed);
      }
    }
    const auto half = static_cast<std::size_t>(kAround * sigma_s / segment.step_s);
    AddMeanSquares({band.values.data() + segment.first, segment.count}, half, band.mean_squares);
  }
  // Where a fast axis is calm there is no other noise.
  std::size_t calm = 0;
  std::size_t seen = 0;
  double squares = 0.0;
  double squares_of_white = 0.0;
  for (std::size_t i = 0; i < grid.time_s.size(); ++i) {
    if (std::abs(grid.velocity[i]) < kFast * top_speed) continue;
    ++seen;
    if (std::sqrt(band.mean_squares[i]) > kStandsOut * band.white[i]) continue;
    ++calm;
    squares_of_white += band.white[i] * band.white[i];
    squares += band.values[i] * band.values[i];
  }
  if (static_cast<double>(calm) > kCalm * static_cast<double>(seen) &&
      squares < kNoMore * kNoMore * squares_of_white) {
    band.noise = band.white;
    return band;
  }
  // An axis that turns often has its acceleration transients where it is slow, one that is struck has them
  // anywhere.
  const double everywhere = std::min(UsualSize(moving), UsualSize(fast));
  const double with_speed = UsualSize(by_speed);
  for (std::size_t i = 0; i < grid.time_s.size(); ++i)
    band.noise.push_back(std::max({band.white[i], everywhere, with_speed * std::abs(grid.velocity[i])}));
  return band;
}

// Sums over points of a band of the acceleration x and the same band of the torque y.
struct TorqueBand {
  double xx{};
  double xy{};
  double yy{};
};

// @param counts  of a point; asked where the band of the torque is known
template <typename Predicate>
TorqueBand MeasureTorqueBand(const MotionSamples& samples, std::span<const PointLayout> layouts,
                             const MotionGrid& grid, double sigma_s, const AccelerationBand& band,
                             const Predicate& counts) {
  TorqueBand sums;
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const MotionGrid::Segment& segment = grid.segments[s];
    const EvenSegment& raw = samples.segments[s];
    const KernelTaps kernel = MakeBandKernel(sigma_s, raw.step_s, 0);
    for (std::size_t i = 0; i < segment.count; ++i) {
      const std::size_t sample = layouts[s].SampleOf(i);
      const std::size_t point = segment.first + i;
      if (sample < kernel.reach || sample + kernel.reach >= raw.torque.size() || !counts(point)) continue;
      const double x = band.values[point];
      const double y = kernel.At(raw.torque, sample);
      sums.xx += x * x;
      sums.xy += x * y;
      sums.yy += y * y;
    }
  }
  return sums;
}

// What the torque follows is motion, however usual it is.
void TakeFollowedForMotion(const TorqueBand& torque, AccelerationBand& band) {
  const double followed =
      torque.xx > 0.0 && torque.yy > 0.0 ? torque.xy * torque.xy / (torque.xx * torque.yy) : 0.0;
  const double unfollowed = std::sqrt((1.0 - followed) * torque.xx /
                                      static_cast<double>(std::max<std::size_t>(band.values.size(), 1)));
  for (std::size_t i = 0; i < band.noise.size(); ++i)
    band.noise[i] = std::max(band.white[i], std::min(band.noise[i], unfollowed));
}

// What the bands have shown of an acceleration transient at a point so far.
struct Trace {
  bool shows{};
  double size{};   // in the last band
  double decay{};  // from band to band
  double sharp{};  // 0: a kink of the acceleration, or gentler; 1: a jump
};

// By what a band has over the one before. A fast oscillation has more.
double SharpnessOf(double decay) {
  if (decay > 1.0) return std::clamp((kFastOscillation - decay) / (kFastOscillation - kUneven), 0.0, 1.0);
  return std::clamp((decay - kSlowestDecay) / (1.0 - kSlowestDecay), 0.0, 1.0);
}

// Whether the large acceleration transients are jumps: 1, or 0 where there are none. Those that come close
// together spoil each other's course from band to band, but where the largest are jumps all are.
double ShareOfJumps(std::span<const Trace> traces) {
  double all = 0.0;
  double sharp = 0.0;
  for (const Trace& trace : traces) {
    if (!trace.shows) continue;
    const double weight = std::pow(trace.size, 4);
    all += weight;
    sharp += weight * trace.sharp;
  }
  return std::clamp((sharp / std::max(all, 1e-300) - kFewJumps) / (kMostlyJumps - kFewJumps), 0.0, 1.0);
}

// An acceleration that jumps does so between two samples, and so does the torque. The path says where between
// them; what is sampled of the torque does not, and may have it half a step earlier or later. Where the path
// is smoothed over many samples, what looks like a jump lasts for several of them, and the torque shows it in
// full.
std::vector<double> JumpErrors(const MotionSamples& samples, const MotionGrid& grid, double share) {
  std::vector<double> errors(grid.time_s.size(), 0.0);
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const MotionGrid::Segment& segment = grid.segments[s];
    const double step_s = samples.segments[s].step_s;
    if (grid.path_sigma_s > kManySamples * step_s) continue;
    const double late_s = share * step_s / std::sqrt(12.0);
    for (std::size_t i = segment.first + 1; i + 1 < segment.first + segment.count; ++i) {
      const double rise = grid.passed_acceleration[i + 1] - grid.passed_acceleration[i - 1];
      errors[i] = late_s * std::abs(rise) / (2.0 * segment.step_s);
    }
  }
  return errors;
}

}  // namespace

std::vector<double> CalmAcceleration(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                                     std::span<const PointLayout> layouts, MotionGrid& grid) {
  std::vector<double> variances;
  const double at_rest = PathNoise(samples, bandwidth, 0.0);
  for (const double velocity : grid.velocity) {
    const double more = at_rest > 0.0 ? PathNoise(samples, bandwidth, velocity) / at_rest : 1.0;
    variances.push_back(std::pow(more * grid.acceleration_noise, 2));
  }
  for (double sigma_s = bandwidth.path_sigma_s; sigma_s < 1.01 * bandwidth.calm_sigma_s;
       sigma_s *= std::numbers::sqrt2) {
    const AccelerationBand band = MeasureAccelerationBand(samples, bandwidth, layouts, grid, sigma_s);
    std::vector<bool> calm(grid.time_s.size(), false);
    const auto is_calm = [&](std::size_t point) {
      calm[point] = std::sqrt(band.mean_squares[point]) < kStandsOut * band.white[point];
      return calm[point];
    };
    const TorqueBand torque = MeasureTorqueBand(samples, layouts, grid, sigma_s, band, is_calm);
    if (std::abs(torque.xy) > kFollowed * std::abs(bandwidth.inertia) * torque.xx) break;
    for (std::size_t i = 0; i < calm.size(); ++i) {
      if (!calm[i]) continue;
      grid.passed_acceleration[i] -= band.values[i];
      variances[i] = std::max(variances[i] - band.white[i] * band.white[i], 0.0);
    }
  }
  for (double& variance : variances) variance = std::sqrt(variance);
  return variances;
}

std::vector<double> AddAccelerationTransients(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                                              std::span<const PointLayout> layouts, MotionGrid& grid) {
  std::vector<Trace> traces(grid.time_s.size());
  std::vector<double> variances(grid.time_s.size(), 0.0);
  // From four bands that the smoothing has left, which show how an acceleration transient goes on, to the end
  // of the low-pass.
  for (double sigma_s = 2.0 * std::numbers::sqrt2 * bandwidth.path_sigma_s;
       sigma_s > 0.99 * bandwidth.sigma_s; sigma_s /= std::numbers::sqrt2) {
    const bool left = sigma_s > 0.99 * bandwidth.path_sigma_s;
    const bool last = sigma_s < 1.01 * bandwidth.sigma_s;
    AccelerationBand band = MeasureAccelerationBand(samples, bandwidth, layouts, grid, sigma_s);
    const auto all = [](std::size_t) { return true; };
    TakeFollowedForMotion(MeasureTorqueBand(samples, layouts, grid, sigma_s, band, all), band);
    for (std::size_t i = 0; i < traces.size(); ++i) {
      Trace& trace = traces[i];
      const double size = std::sqrt(band.mean_squares[i]);
      // What does not stand out, but would show in the torque, is not to be taken for known.
      const double hidden_torque = std::abs(bandwidth.inertia) * band.noise[i];
      const double stands_out =
          left ? std::clamp(grid.noise_floor / std::max(hidden_torque, 1e-300), kStandsOutAtLeast, kStandsOut)
               : kStandsOut;
      const double usual = stands_out * band.noise[i];
      const double share = usual * usual / std::max(band.mean_squares[i], 1e-300);
      // Where an axis turns every few samples, acceleration transients are what is usual in the wider bands.
      trace.shows =
          trace.shows || (left && share < 1.0) || ((last || !left) && size > kStandsOutAlone * band.noise[i]);
      if (!trace.shows) continue;
      if (left) {
        // A kink of the acceleration goes on below the noise that hides it, a gentle end does not.
        const bool hidden = share > 1.0;
        if (hidden && trace.decay < kKink) {
          trace = {};
          continue;
        }
        if (!hidden) {
          const double decay = trace.size > 0.0 ? size / trace.size : 0.0;
          trace.decay = std::min(decay, kSlowestDecay);
          trace.sharp = SharpnessOf(decay);
        }
        trace.size = hidden ? trace.decay * trace.size : size;
      } else if (share < 1.0 && std::abs(bandwidth.inertia) * band.noise[i] < grid.noise_floor) {
        grid.passed_acceleration[i] += (1.0 - share) * band.values[i];
        variances[i] += std::pow(share * size, 2) + std::pow((1.0 - share) * band.noise[i], 2);
        trace.size = size;
      } else {
        trace.size = share < 1.0 ? size : std::min(trace.decay * trace.size, usual);
        variances[i] += trace.size * trace.size;
      }
    }
  }
  for (std::size_t i = 0; i < traces.size(); ++i)
    variances[i] = std::sqrt(variances[i] + std::pow(kBeyond * traces[i].size, 2));
  grid.jump_error = JumpErrors(samples, grid, ShareOfJumps(traces));
  return variances;
}

std::vector<double> LastBand(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                             std::span<const PointLayout> layouts, const MotionGrid& grid) {
  std::vector<double> sizes =
      MeasureAccelerationBand(samples, bandwidth, layouts, grid, bandwidth.path_sigma_s).mean_squares;
  for (double& size : sizes) size = size > 0.0 ? std::sqrt(size) : std::numeric_limits<double>::infinity();
  return sizes;
}

}  // namespace strainwave::analysis::diagnosis
