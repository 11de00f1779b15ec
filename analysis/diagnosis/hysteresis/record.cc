// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "analysis/arguments.h"
#include "analysis/diagnosis/hysteresis/checks.h"
#include "analysis/diagnosis/hysteresis/holds.h"
#include "analysis/diagnosis/hysteresis/noise_reversals.h"
#include "analysis/diagnosis/hysteresis/signal.h"
#include "analysis/loop_branches.h"
#include "analysis/noise_level.h"
#include "analysis/samples/resolution.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kGap = 4.0;  // of a median step: what is longer is no step of one run of samples

// A record whose twist falls with the torque has one of the two signs swapped.
bool FallsWithTorque(std::span<const double> torque_Nm, std::span<const double> twist_rad) {
  const auto n = static_cast<double>(torque_Nm.size());
  const double mean_torque = std::accumulate(torque_Nm.begin(), torque_Nm.end(), 0.0) / n;
  const double mean_twist = std::accumulate(twist_rad.begin(), twist_rad.end(), 0.0) / n;
  double covariance = 0.0;
  for (std::size_t i = 0; i < torque_Nm.size(); ++i) {
    covariance += (torque_Nm[i] - mean_torque) * (twist_rad[i] - mean_twist);
  }
  return covariance < 0.0;
}

// Branches of a torque. What goes back by less than a fiftieth of the range, or by noise, does not turn.
std::vector<Branch> BranchesOf(std::span<const double> torque_Nm, double t3_Nm, double noise_Nm) {
  const auto [low, high] = std::minmax_element(torque_Nm.begin(), torque_Nm.end());
  return SplitBranches(torque_Nm, std::max(0.02 * std::min(t3_Nm, *high - *low), 6.0 * noise_Nm));
}

// Samples after which a torque comes to one of these stairs or leaves it.
std::vector<std::size_t> EndsOf(std::span<const Hold> stairs) {
  std::vector<std::size_t> breaks;
  for (const Hold& stair : stairs) {
    if (stair.first > 0 && (breaks.empty() || breaks.back() + 1 < stair.first))
      breaks.push_back(stair.first - 1);
    breaks.push_back(stair.end - 1);
  }
  return breaks;
}

std::vector<double> SettledTorque(std::span<const double> times_s, std::span<const double> torque_Nm,
                                  double noise_Nm, double t3_Nm) {
  const std::vector<Hold> stairs = FindStairs(torque_Nm, noise_Nm);
  CleanSignal torque = WithoutNoise(times_s, torque_Nm, noise_Nm, EndsOf(stairs));
  if (!(noise_Nm > 0.0)) return torque.values;
  KeepStill(FindHolds(torque_Nm, noise_Nm), noise_Nm, torque);
  KeepStill(stairs, noise_Nm, torque);
  return WithoutNoiseReversals(torque.values, torque.errors, noise_Nm,
                               BranchesOf(torque.values, t3_Nm, noise_Nm));
}

// The torque that drives the model, and what was taken off for noise.
struct DrivingTorque {
  std::vector<double> torque_Nm;
  std::vector<double> noise_Nm;
};

DrivingTorque DrivingTorqueOf(std::span<const double> times_s, std::vector<double> torque_Nm,
                              std::span<const double> angle_rad, double t3_Nm) {
  const auto [low_Nm, high_Nm] = std::minmax_element(torque_Nm.begin(), torque_Nm.end());
  const auto [low_rad, high_rad] = std::minmax_element(angle_rad.begin(), angle_rad.end());
  const double compliance_rad_per_Nm = (*high_rad - *low_rad) / (*high_Nm - *low_Nm);
  const double noise_Nm = SampleNoise(times_s, torque_Nm);
  InterpolateOver(torque_Nm, LoneSpikes(times_s, torque_Nm, noise_Nm));
  const std::vector<double> clean_Nm = SettledTorque(times_s, torque_Nm, noise_Nm, t3_Nm);
  const double followed = FollowedShare(times_s, torque_Nm, clean_Nm, angle_rad, compliance_rad_per_Nm);
  DrivingTorque driving{std::move(torque_Nm), {}};
  for (std::size_t i = 0; i < clean_Nm.size(); ++i) {
    driving.noise_Nm.push_back((1.0 - followed) * (driving.torque_Nm[i] - clean_Nm[i]));
    driving.torque_Nm[i] -= driving.noise_Nm[i];
  }
  return driving;
}

void AppendRate(std::span<const double> time_s, std::span<const double> torque_Nm,
                std::vector<double>& rate) {
  const std::size_t n = time_s.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t a = i < 2 ? 0 : i - 2;
    const std::size_t b = std::min(i + 2, n - 1);
    const double span_s = time_s[b] - time_s[a];
    rate.push_back(span_s > 0.0 ? (torque_Nm[b] - torque_Nm[a]) / span_s : 0.0);
  }
}

// Times that repeat are spread over the gap to the next one.
std::vector<double> RisingTimes(const std::vector<double>& time_s) {
  std::vector<double> rising(time_s);
  for (std::size_t i = 0; i < rising.size();) {
    std::size_t next = i + 1;
    while (next < rising.size() && time_s[next] <= time_s[i]) ++next;
    const double until = next < rising.size() ? time_s[next] : time_s[i];
    for (std::size_t k = i + 1; k < next; ++k) {
      rising[k] =
          time_s[i] + (until - time_s[i]) * static_cast<double>(k - i) / static_cast<double>(next - i);
    }
    i = next;
  }
  return rising;
}

double MedianStep(const std::vector<double>& time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  return Median(std::move(steps));
}

void AppendTemperature(std::span<const HysteresisData> records, LoopGrid& grid) {
  std::vector<double> all;
  for (const HysteresisData& record : records) {
    if (record.temperature_degC.empty()) return;
    const std::vector<double> clean = WithoutNoise(RisingTimes(record.time_s), record.temperature_degC,
                                                   SampleNoise(record.time_s, record.temperature_degC))
                                          .values;
    all.insert(all.end(), clean.begin(), clean.end());
  }
  const double mean = std::accumulate(all.begin(), all.end(), 0.0) / static_cast<double>(all.size());
  for (double& value : all) value -= mean;
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  double noise = 0.0;
  for (const HysteresisData& record : records)
    noise = std::max(noise, SampleNoise(record.time_s, record.temperature_degC));
  constexpr double kStandsStill_K = 0.05;
  if (*high - *low > std::max(kStandsStill_K, 3.0 * noise)) grid.temperature_K = std::move(all);
}

void AppendBranches(std::span<const double> time_s, std::span<const double> torque_Nm, double t3_Nm,
                    LoopRecords& prepared) {
  const std::size_t base = prepared.samples.direction.size();
  const std::vector<Branch> branches = BranchesOf(torque_Nm, t3_Nm, SampleNoise(time_s, torque_Nm));
  prepared.samples.direction.resize(base + torque_Nm.size(), 1.0);
  for (const Branch& branch : branches) {
    const std::size_t first = branch.first == 0 ? 0 : branch.first + 1;
    prepared.branches.push_back(base + first);
    for (std::size_t i = first; i <= branch.last; ++i) {
      prepared.samples.direction[base + i] = branch.rising ? 1.0 : -1.0;
    }
  }
}

double NoiseFloorOf(const LoopRecords& prepared) {
  // The mean compliance takes most of the motion off, and what the gear follows of the torque's fluctuation.
  const LoopGrid& grid = prepared.samples;
  double square_sum = 0.0;
  for (std::size_t r = 0; r < grid.records(); ++r) {
    const std::size_t first = grid.starts[r];
    const std::size_t count = grid.starts[r + 1] - first;
    std::vector<double> angle(grid.twist_rad.begin() + static_cast<std::ptrdiff_t>(first),
                              grid.twist_rad.begin() + static_cast<std::ptrdiff_t>(first + count));
    for (std::size_t i = 0; i < count; ++i) {
      angle[i] -= prepared.compliance_rad_per_Nm() *
                  (grid.torque_Nm[first + i] + prepared.torque_noise_Nm[first + i]);
    }
    // Of an angle that stands on its steps the differences show how often it leaves one.
    constexpr double kMostly = 0.5;
    const double rounding = RoundingNoise(std::span(grid.twist_rad).subspan(first, count), kMostly);
    const double noise =
        rounding > 0.0 ? rounding : LastingNoise(std::span(grid.time_s).subspan(first, count), angle);
    square_sum += noise * noise * static_cast<double>(count);
  }
  return std::sqrt(square_sum / static_cast<double>(grid.size()));
}

void AppendTurns(std::span<const double> time_s, std::span<const double> torque_Nm, double noise_Nm,
                 LoopRecords& prepared) {
  LoopGrid& grid = prepared.samples;
  const std::size_t base = grid.turn_Nm.size();
  grid.turn_Nm.resize(base + torque_Nm.size(), std::numeric_limits<double>::quiet_NaN());
  grid.turn_share.resize(base + torque_Nm.size(), 0.0);
  const auto [low, high] = std::minmax_element(torque_Nm.begin(), torque_Nm.end());
  const double furthest_Nm = std::max(std::abs(*low), std::abs(*high));
  const double mean_step_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (const Turn& turn : FindTurns(time_s, torque_Nm, noise_Nm)) {
    double turn_Nm = turn.value;
    // A peak that lies in a gap was no other than the record's other peaks, which lines only roughly meet.
    const double before_Nm = torque_Nm[turn.before];
    const double after_Nm = torque_Nm[turn.before + 1];
    const double near_Nm = 0.05 * (*high - *low);
    if (turn_Nm > std::max(before_Nm, after_Nm) + near_Nm && turn_Nm > *high - near_Nm) turn_Nm = *high;
    if (turn_Nm < std::min(before_Nm, after_Nm) - near_Nm && turn_Nm < *low + near_Nm) turn_Nm = *low;
    // Nor does a smooth one go as far as the lines of its sides, where it went further elsewhere than beside
    // it.
    const bool in_gap = time_s[turn.before + 1] - time_s[turn.before] > kGap * mean_step_s;
    if (in_gap && std::abs(turn_Nm) > furthest_Nm &&
        furthest_Nm > std::max(std::abs(before_Nm), std::abs(after_Nm)))
      turn_Nm = std::copysign(furthest_Nm, turn_Nm);
    if (in_gap) {
      prepared.warnings.push_back(fmt::format(
          "the torque turns back while rows are missing, {:.4g} to {:.4g} s: how far it went is not in the "
          "record, {:.4g} Nm is taken, and what friction does behind it hangs on that",
          time_s[turn.before], time_s[turn.before + 1], turn_Nm));
    }
    grid.turn_Nm[base + turn.before + 1] = turn_Nm;
    grid.turn_share[base + turn.before + 1] = turn.share;
  }
}

// Between neighbouring samples the rate has the noise that smoothing of the torque leaves, a good deal of a
// slow ramp's, and what depends on the rate would follow it.
void AppendStepRates(std::span<const double> times_s, std::span<const double> torque_Nm,
                     std::span<const double> taken_off_Nm, double noise_Nm, LoopGrid& grid) {
  const std::size_t base = grid.rate_Nm_per_s.size();
  std::vector<double> measured_Nm(torque_Nm.begin(), torque_Nm.end());
  for (std::size_t i = 0; i < measured_Nm.size(); ++i) measured_Nm[i] += taken_off_Nm[i];
  std::vector<std::size_t> breaks = EndsOf(FindStairs(measured_Nm, noise_Nm));
  for (std::size_t i = 1; i < torque_Nm.size(); ++i) {
    if (!std::isnan(grid.turn_Nm[base + i])) breaks.push_back(i - 1);
  }
  std::ranges::sort(breaks);
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  std::vector<double> rates = SlopesWithoutNoise(times_s, torque_Nm, noise_Nm, breaks);
  for (std::size_t i = 1; i + 1 < rates.size(); ++i) {
    if (!std::isnan(grid.turn_Nm[base + i])) rates[i] = rates[i + 1];
  }
  grid.rate_Nm_per_s.insert(grid.rate_Nm_per_s.end(), rates.begin(), rates.end());
}

std::size_t BlockLengthOf(const LoopRecords& prepared) {
  const std::size_t n = prepared.samples.size();
  const std::size_t loops = (prepared.branches.size() - 1) / 2 / prepared.samples.records();
  const std::size_t of_record = n / prepared.samples.records();
  if (loops >= 3) return std::max<std::size_t>(of_record / loops, 1);
  return std::max<std::size_t>(n / 20, 1);
}

void RequireOneKind(std::span<const HysteresisData> records) {
  if (records.empty()) throw std::invalid_argument("there is no record (expected at least one)");
  for (const HysteresisData& record : records) {
    RequireDiagnosableLoop(record);
    if (record.t1_Nm != records[0].t1_Nm || record.t2_Nm != records[0].t2_Nm) {
      throw std::invalid_argument(fmt::format(
          "records differ in their knees: t1_Nm = {}, t2_Nm = {} and t1_Nm = {}, t2_Nm = {} (expected one "
          "gear in all of them)",
          records[0].t1_Nm, records[0].t2_Nm, record.t1_Nm, record.t2_Nm));
    }
  }
}

}  // namespace

LoopRecords PrepareLoopRecords(std::span<const HysteresisData> records) {
  RequireOneKind(records);
  LoopRecords prepared;
  prepared.t1_Nm = records[0].t1_Nm;
  prepared.t2_Nm = records[0].t2_Nm;
  prepared.t3_Nm = records[0].t3_Nm;
  LoopGrid& grid = prepared.samples;
  for (const HysteresisData& record : records) {
    const auto [low, high] =
        std::minmax_element(record.output_angle_rad.begin(), record.output_angle_rad.end());
    const auto [low_Nm, high_Nm] = std::minmax_element(record.torque_Nm.begin(), record.torque_Nm.end());
    const double peak_Nm = std::max(std::abs(*low_Nm), std::abs(*high_Nm));
    const double range_rad = *high - *low;
    prepared.peak_torque_Nm = std::max(prepared.peak_torque_Nm, peak_Nm);
    prepared.twist_range_rad = std::max(prepared.twist_range_rad, range_rad);
    const auto odd = OddThingsAbout(record, range_rad, peak_Nm);
    prepared.warnings.insert(prepared.warnings.end(), odd.begin(), odd.end());

    HysteresisData turned = record;
    turned.time_s = RisingTimes(record.time_s);
    if (FallsWithTorque(record.torque_Nm, record.output_angle_rad)) {
      for (double& torque_Nm : turned.torque_Nm) torque_Nm = -torque_Nm;
      prepared.warnings.push_back(
          "the angle falls with the torque: the sign of one of them is swapped; torque is taken "
          "with the other sign");
    }
    const std::vector<double> times_s =
        TimesOfSamples(turned.time_s, turned.torque_Nm, turned.output_angle_rad);
    const auto [torque_Nm, noise_Nm] =
        DrivingTorqueOf(times_s, turned.torque_Nm, turned.output_angle_rad, record.t3_Nm);
    AppendBranches(times_s, torque_Nm, record.t3_Nm, prepared);
    const double torque_noise_Nm = SampleNoise(times_s, turned.torque_Nm);
    AppendTurns(times_s, torque_Nm, torque_noise_Nm, prepared);
    AppendStepRates(times_s, torque_Nm, noise_Nm, torque_noise_Nm, grid);
    AppendRate(times_s, torque_Nm, prepared.torque_rate_Nm_per_s);
    grid.starts.push_back(grid.size());
    const double centre_rad = 0.5 * (*low + *high);
    prepared.position_noise_rad =
        std::max(prepared.position_noise_rad, SampleNoise(times_s, record.output_angle_rad));
    prepared.centre_rad.push_back(centre_rad);
    for (std::size_t i = 0; i < torque_Nm.size(); ++i) {
      grid.time_s.push_back(times_s[i] - times_s[0]);
      grid.torque_Nm.push_back(torque_Nm[i]);
      grid.twist_rad.push_back(record.output_angle_rad[i] - centre_rad);
      grid.position_rad.push_back(grid.twist_rad.back());
      grid.weight.push_back(1.0);
      prepared.measured_rad.push_back(record.output_angle_rad[i]);
      prepared.measured_torque_Nm.push_back(turned.torque_Nm[i]);
      prepared.torque_noise_Nm.push_back(noise_Nm[i]);
    }
    prepared.duration_s = std::max(prepared.duration_s, grid.time_s.back());
    prepared.step_s = std::max(prepared.step_s, MedianStep(turned.time_s));
  }
  grid.starts.push_back(grid.size());
  prepared.branches.push_back(grid.size());
  AppendTemperature(records, grid);
  if (!(prepared.duration_s > 0.0)) {
    throw std::invalid_argument("time_s stands still (expected it to rise)");
  }
  prepared.step_s = std::max(prepared.step_s, prepared.duration_s / static_cast<double>(grid.size()));
  prepared.noise_floor_rad = NoiseFloorOf(prepared);
  const auto step_of = [](std::span<const double> samples) {
    const double step = samples::QuantisationStep(samples);
    return step > 0.0 && samples::StandsOnSteps(samples, step) ? step : 0.0;
  };
  for (const HysteresisData& record : records) {
    const double step_rad = std::hypot(step_of(record.output_angle_rad),
                                       prepared.compliance_rad_per_Nm() * step_of(record.torque_Nm));
    prepared.rounding_rad = std::max(prepared.rounding_rad, step_rad / std::sqrt(12.0));
  }
  prepared.block_length = BlockLengthOf(prepared);
  return prepared;
}

LoopGrid Condense(const LoopRecords& records, std::span<const double> weights, std::size_t most) {
  const LoopGrid& all = records.samples;
  const std::size_t run = most == 0 ? 1 : (all.size() + most - 1) / most;
  if (run <= 1) {
    LoopGrid same = all;
    same.weight.assign(weights.begin(), weights.end());
    return same;
  }
  LoopGrid grid;
  const auto append_mean = [&](std::size_t first, std::size_t end) {
    double weight = 0.0;
    for (std::size_t i = first; i < end; ++i) weight += weights[i];
    const auto mean = [&](const std::vector<double>& values) {
      double sum = 0.0;
      for (std::size_t i = first; i < end; ++i) sum += weight > 0.0 ? weights[i] * values[i] : values[i];
      return sum / (weight > 0.0 ? weight : static_cast<double>(end - first));
    };
    grid.time_s.push_back(mean(all.time_s));
    grid.torque_Nm.push_back(mean(all.torque_Nm));
    grid.twist_rad.push_back(mean(all.twist_rad));
    grid.position_rad.push_back(mean(all.position_rad));
    grid.weight.push_back(weight);
    if (!all.temperature_K.empty()) grid.temperature_K.push_back(mean(all.temperature_K));
    grid.direction.push_back(all.direction[first]);
    grid.turn_Nm.push_back(all.turn_Nm[first]);
    grid.turn_share.push_back(all.turn_share[first]);
    grid.rate_Nm_per_s.push_back(mean(all.rate_Nm_per_s));
  };
  std::size_t record = 0;
  for (std::size_t b = 0; b + 1 < records.branches.size(); ++b) {
    const std::size_t first = records.branches[b];
    const std::size_t end = records.branches[b + 1];
    if (record < all.records() && first == all.starts[record]) {
      grid.starts.push_back(grid.size());
      ++record;
    }
    // The first sample of a record holds the start, the last one of a branch is the reversal.
    std::size_t i = first;
    if (first == all.starts[record - 1]) append_mean(i, i + 1), ++i;
    while (i + 1 < end) {
      std::size_t stop = std::min(i + run, end - 1);
      // Turns and gaps lie between two points.
      for (std::size_t k = i + 1; k < stop; ++k) {
        if (!std::isnan(all.turn_Nm[k]) || all.time_s[k] - all.time_s[k - 1] > kGap * records.step_s)
          stop = k;
      }
      append_mean(i, stop);
      i = stop;
    }
    if (i < end) append_mean(i, end);
  }
  grid.starts.push_back(grid.size());
  return grid;
}

}  // namespace strainwave::analysis::diagnosis
