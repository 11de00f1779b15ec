// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/rows.h"

#include <algorithm>
#include <cmath>

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kShortestRun = 4;  // rows between two gaps that are of use
constexpr double kTolerated = 0.4;       // error by a reversal's time, over the noise
constexpr double kWaysToForget = 5.0;    // after which less than 1 % is left of a gradual bend
constexpr double kAlikeEachTime = 1.5;   // harm of an error that is no chance, over one that is
constexpr double kMostAtRest = 0.05;     // of a row's low-pass
constexpr double kShortestRest = 8.0;    // samples
constexpr double kLonger = 1.3;          // than a reversal as smooth as the acceleration there says
constexpr double kNoiseBand = 6.0;       // of the position's noise, in which it stays
constexpr double kMostLeftOut = 0.4;     // of the rows, because of reversals
// Part of the smoothing's width by which a kink of the velocity moves its zero.
constexpr double kBlurredReversal = 0.015;
// Of the 95 % quantile of the speed, in which friction may turn to its other sign.
constexpr double kReversalSmoothing = 5e-4;
// Part of the acceleration that shows in the last band where an axis sticks for as long as that.
constexpr double kShowsWhereItSticks = 0.0015;
// A kink of the velocity between two samples is known to Bernoulli's B₂/2 of a step² in the velocity's sum,
// to B₃/6 of a step³ in the position's (Euler and Maclaurin), of which the low-pass makes 2/σ a derivative.
// An axis that sticks has two.
constexpr double kFoldedOfVelocity = 2.0 * 2.0 / 12.0;
constexpr double kFoldedOfPosition = 2.0 * 4.0 * 0.008;

// Adds the rests that are shorter than the smoothing of the path, which lets the motion beside them in: the
// samples themselves stay at one position for longer than a reversal takes.
void AddShortRests(const MotionSamples& samples, std::span<const PointLayout> layouts, const MotionGrid& grid,
                   double slow, std::vector<double>& rests) {
  const double reversal_s = slow / std::max(QuantileOfMagnitude(grid.passed_acceleration, 0.95), 1e-300);
  const double noise = kNoiseBand * samples.position_noise;
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const EvenSegment& raw = samples.segments[s];
    const MotionGrid::Segment& segment = grid.segments[s];
    const double shortest_s =
        std::max({kShortestRest * raw.step_s, 3.0 * grid.sigma_s, 6.0 * reversal_s, noise / slow});
    const double band = slow * shortest_s + noise;
    for (std::size_t i = 0; i < raw.position.size();) {
      double low = raw.position[i];
      double high = low;
      std::size_t next = i + 1;
      for (; next < raw.position.size(); ++next) {
        low = std::min(low, raw.position[next]);
        high = std::max(high, raw.position[next]);
        if (high - low > band) break;
      }
      const std::size_t stride = layouts[s].stride;
      const std::size_t middle = std::min((i + next) / 2 / stride, segment.count - 1);
      const double acceleration = std::abs(grid.passed_acceleration[segment.first + middle]);
      const double reversal_here_s = std::sqrt(8.0 * band / std::max(acceleration, 1e-300));
      if (static_cast<double>(next - i) * raw.step_s < std::max(shortest_s, kLonger * reversal_here_s)) {
        ++i;
        continue;
      }
      for (std::size_t k = (i + stride - 1) / stride; k < segment.count && layouts[s].SampleOf(k) < next; ++k)
        rests[segment.first + k] = 1.0;
      i = next;
    }
  }
}

// One at points of a rest: slower than can be told from standing, for longer than a reversal takes.
std::vector<double> RestsOf(const MotionSamples& samples, std::span<const PointLayout> layouts,
                            const MotionGrid& grid) {
  const double standing = 2e-3 * QuantileOfMagnitude(grid.velocity, 0.95);
  const double slow = std::max(3.0 * grid.velocity_noise, standing);
  std::vector<double> rests(grid.velocity.size(), 0.0);
  if (standing > 0.0) AddShortRests(samples, layouts, grid, standing, rests);
  for (const MotionGrid::Segment& segment : grid.segments) {
    const double shortest_s = std::max(6.0 * grid.path_sigma_s, 3.0 * grid.sigma_s);
    const std::size_t end = segment.first + segment.count;
    for (std::size_t i = segment.first; i < end;) {
      std::size_t next = i;
      while (next < end && std::abs(grid.velocity[next]) < slow) ++next;
      if (static_cast<double>(next - i) * segment.step_s > shortest_s) {
        std::fill(rests.begin() + static_cast<std::ptrdiff_t>(i),
                  rests.begin() + static_cast<std::ptrdiff_t>(next), 1.0);
      }
      i = std::max(next, i + 1);
    }
  }
  return rests;
}

// Marks points before which the path of their segment is too short to tell how far friction is bent, of a
// friction that bends over a way.
void AddUnknownStarts(const MotionGrid& grid, double coulomb, std::vector<double>& rests) {
  double way = 0.0;
  for (const PreslidingElement& element : grid.reversal_smoothing.elements)
    if (2.0 * coulomb * element.share > kTolerated * grid.noise_floor)
      way = std::max(way, (element.gradual ? kWaysToForget : 2.0) * element.way);
  if (way == 0.0) return;
  for (const MotionGrid::Segment& segment : grid.segments) {
    double low = grid.position[segment.first];
    double high = low;
    for (std::size_t i = segment.first; i < segment.first + segment.count && high - low < way; ++i) {
      low = std::min(low, grid.position[i]);
      high = std::max(high, grid.position[i]);
      rests[i] = 1.0;
    }
  }
}

double ShareUnderKernel(const KernelTaps& kernel, std::span<const double> marks, std::size_t sample) {
  double marked = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < kernel.taps.size(); ++k) {
    if (sample + k < kernel.reach || sample + k >= kernel.reach + marks.size()) continue;
    const double weight = std::abs(kernel.taps[k]);
    all += weight;
    marked += weight * marks[sample + k - kernel.reach];
  }
  return marked / all;
}

// Largest magnitude of the filter from each tap outwards, by the second: what a step of 1 a second long does.
std::vector<double> EnvelopeOf(const KernelTaps& kernel, double step_s) {
  std::vector<double> envelope(kernel.reach + 1);
  double largest = 0.0;
  for (std::size_t k = kernel.reach + 1; k-- > 0;) {
    largest = std::max(largest, std::abs(kernel.taps[kernel.reach + k]));
    envelope[k] = largest / step_s;
  }
  return envelope;
}

struct Spell {
  double begin{};  // point, between points
  double end{};
};

// Where the axis is slower than `slow` around a reversal right before point `after`. Looked up, not taken
// from the acceleration: an axis that comes to rest before it turns has none there.
Spell SlowSpell(const MotionGrid& grid, const MotionGrid::Segment& segment, std::size_t after, double slow) {
  const auto speed = [&](std::size_t i) { return std::abs(grid.velocity[i]); };
  const std::size_t last = segment.first + segment.count - 1;
  std::size_t to = after;
  while (to < last && speed(to) < slow) ++to;
  std::size_t from = after - 1;
  while (from > segment.first && speed(from) < slow) --from;
  // Between the first point that is fast enough and its neighbour inside, whose velocity counts as negative
  // where the reversal lies between both.
  const auto edge = [&](std::size_t fast, std::size_t inner) {
    const double within = grid.velocity[fast] * grid.velocity[inner] > 0.0 ? speed(inner) : -speed(inner);
    const double share = (speed(fast) - slow) / std::max(speed(fast) - within, 1e-300);
    return std::clamp(share, 0.0, 1.0);
  };
  return {static_cast<double>(from) + edge(from, from + 1), static_cast<double>(to) - edge(to, to - 1)};
}

// What the samples leave open of a kink of the velocity, as a time by which friction changes late.
double FoldedKink_s(const MotionBandwidth& bandwidth, double step_s) {
  const double narrow = step_s / bandwidth.path_sigma_s;
  return step_s * narrow * (bandwidth.by_velocity ? kFoldedOfVelocity : kFoldedOfPosition * narrow);
}

// At each point, by how much a row there may be wrong because nobody knows when exactly the motion reversed.
// @param reversal_smoothing  speed over which friction may turn round, nobody knows how
std::vector<double> ReversalErrors(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                                   double expected_delay_s, double reversal_smoothing,
                                   const MotionGrid& grid) {
  std::vector<double> errors(grid.velocity.size(), 0.0);
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const MotionGrid::Segment& segment = grid.segments[s];
    const double folded_s = FoldedKink_s(bandwidth, samples.segments[s].step_s);
    const std::vector<double> narrow = EnvelopeOf(segment.low_pass, segment.step_s);
    const std::vector<double> wide = EnvelopeOf(segment.wide_low_pass, segment.step_s);
    const auto half = std::max<std::size_t>(
        1, static_cast<std::size_t>(std::lround(2.0 * grid.path_sigma_s / segment.step_s)));
    const std::size_t end = segment.first + segment.count;
    double told = 0.0;  // up to here
    for (std::size_t i = segment.first + 1; i < end; ++i) {
      // To and fro within one slow spell is one reversal.
      if (grid.velocity[i - 1] * grid.velocity[i] > 0.0 || static_cast<double>(i) < told) continue;
      const std::size_t from = i > segment.first + half ? i - half : segment.first;
      const std::size_t to = std::min(i + half, end - 1);
      const double acceleration = std::abs(grid.velocity[to] - grid.velocity[from]) /
                                  (static_cast<double>(to - from) * segment.step_s);
      const double blurred_s = kBlurredReversal * grid.path_sigma_s;
      // Of an axis that turns smoothly there is no kink, and friction turns round within a reversal
      // smoothing.
      const double share =
          std::clamp(std::max(grid.last_band[i] / kShowsWhereItSticks, reversal_smoothing / blurred_s) /
                         std::max(acceleration, 1e-300),
                     0.0, 1.0);
      const Spell spell = SlowSpell(grid, segment, i, grid.velocity_noise + share * blurred_s * acceleration);
      told = spell.end;
      const double middle = 0.5 * (spell.begin + spell.end);
      // Between which samples a resampled torque jumped is known, not where.
      const double uncertain_s = std::hypot(
          std::max(grid.reversal_error_s, share * folded_s),
          std::max(kAlikeEachTime * 0.5 * (spell.end - spell.begin) * segment.step_s, share * blurred_s));
      const auto reach =
          std::max(narrow.size(), wide.size()) +
          static_cast<std::size_t>((uncertain_s + std::abs(expected_delay_s)) / segment.step_s) + 1;
      const auto centre = static_cast<std::size_t>(middle);
      for (std::size_t k = centre > segment.first + reach ? centre - reach : segment.first;
           k < std::min(centre + reach + 1, end); ++k) {
        // Where the torque acts late, the reversal shows in it before it shows in the motion; where it is
        // recorded late, afterwards.
        const double after_s = (static_cast<double>(k) - middle) * segment.step_s;
        const double away_s = std::max(
            {after_s - std::max(-expected_delay_s, 0.0), -after_s - std::max(expected_delay_s, 0.0), 0.0});
        const auto tap = static_cast<std::size_t>(std::max(0.0, away_s - uncertain_s) / segment.step_s);
        const std::vector<double>& envelope = grid.wide[k] ? wide : narrow;
        if (tap < envelope.size()) errors[k] += 2.0 * bandwidth.coulomb * uncertain_s * envelope[tap];
      }
    }
  }
  return errors;
}

// The error that is tolerated: a part of the noise, or more where that would leave too little.
double ToleratedError(double noise, const std::vector<double>& errors) {
  std::vector<double> sorted = errors;
  const auto quantile =
      sorted.begin() + static_cast<std::ptrdiff_t>((1.0 - kMostLeftOut) * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), quantile, sorted.end());
  return std::max(kTolerated * noise, *quantile);
}

}  // namespace

void ChooseMotionRows(const MotionSamples& samples, std::span<const PointLayout> layouts,
                      const MotionBandwidth& bandwidth, double expected_delay_s,
                      std::span<const double> reversal_smoothing_error, MotionGrid& grid) {
  grid.point_of_row.clear();
  grid.segment_of_row.clear();
  grid.response_segments.clear();
  std::vector<double> rests = RestsOf(samples, layouts, grid);
  AddUnknownStarts(grid, bandwidth.coulomb, rests);
  std::vector<double> errors = ReversalErrors(samples, bandwidth, expected_delay_s, 0.0, grid);
  const std::vector<double> most =
      ReversalErrors(samples, bandwidth, expected_delay_s,
                     kReversalSmoothing * QuantileOfMagnitude(grid.velocity, 0.95), grid);
  for (std::size_t i = 0; i < errors.size(); ++i)
    errors[i] = std::min(most[i], errors[i] + reversal_smoothing_error[i]);
  const double tolerated = ToleratedError(grid.noise_floor, errors);
  std::vector<double> jumps = grid.jump_error;
  for (double& jump : jumps) jump *= std::abs(bandwidth.inertia);
  const double tolerated_of_jumps = ToleratedError(grid.noise_floor, jumps);
  // At rest friction is anything between its two values.
  const double most_at_rest =
      std::min(kMostAtRest, kTolerated * grid.noise_floor / std::max(2.0 * bandwidth.coulomb, 1e-300));
  for (std::size_t s = 0; s < grid.segments.size(); ++s) {
    const MotionGrid::Segment& segment = grid.segments[s];
    const EvenSegment& raw = samples.segments[s];
    const KernelTaps path = MakeKernel(grid.path_sigma_s, segment.step_s, 0);
    // Of a spike beside an acceleration transient nobody knows which of two samples it is.
    const KernelTaps at_samples = bandwidth.passes_all ? KernelTaps{.taps = {1.0, 1.0, 1.0}, .reach = 1}
                                                       : MakeKernel(grid.sigma_s, raw.step_s, 0);
    std::vector<double> clipped(raw.clipped.begin(), raw.clipped.end());
    const double apart_s = bandwidth.passes_all ? segment.step_s : kRowSpacing * grid.sigma_s;
    const auto spacing =
        std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(apart_s / segment.step_s)));
    std::size_t run = grid.point_of_row.size();
    const auto end_run = [&] {
      if (grid.point_of_row.size() - run < kShortestRun) {
        grid.point_of_row.resize(run);
        grid.segment_of_row.resize(run);
      } else {
        grid.response_segments.push_back(run);
      }
      run = grid.point_of_row.size();
    };
    for (std::size_t i = segment.low_pass.reach; i + segment.low_pass.reach < segment.count; i += spacing) {
      const std::size_t sample = layouts[s].SampleOf(i);
      const KernelTaps& low_pass = grid.LowPassAt(segment, segment.first + i);
      if (i < low_pass.reach || i + low_pass.reach >= segment.count) continue;
      if (sample < layouts[s].margin || sample + layouts[s].margin >= raw.position.size()) continue;
      if (errors[segment.first + i] > tolerated || jumps[segment.first + i] > tolerated_of_jumps ||
          ShareUnderKernel(low_pass, rests, segment.first + i) > most_at_rest ||
          // Where an axis stops or starts, its acceleration jumps.
          ShareUnderKernel(path, rests, segment.first + i) > kMostAtRest ||
          ShareUnderKernel(at_samples, clipped, sample) > 1e-3) {
        end_run();
        continue;
      }
      grid.point_of_row.push_back(segment.first + i);
      grid.segment_of_row.push_back(s);
    }
    end_run();
    grid.row_spacing_s = std::max(grid.row_spacing_s, static_cast<double>(spacing) * segment.step_s);
  }
}

}  // namespace strainwave::analysis::diagnosis
