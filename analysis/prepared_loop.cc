// SPDX-License-Identifier: Apache-2.0
#include "analysis/prepared_loop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "analysis/arguments.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

constexpr std::size_t kFewestLoopSamples = 16;

void RequireLoop(const TorsionLoop& loop, const TestTorques& torques) {
  RequireSameLength("torque_Nm", loop.torque_Nm, "twist_rad", loop.twist_rad);
  if (!loop.time_s.empty()) {
    RequireSameLength("time_s", loop.time_s, "twist_rad", loop.twist_rad);
    RequireFinite("time_s", loop.time_s);
  }
  RequireAtLeast("torque_Nm", loop.torque_Nm, kFewestLoopSamples);
  RequireFinite("torque_Nm", loop.torque_Nm);
  RequireFinite("twist_rad", loop.twist_rad);
  const bool in_order = torques.t1_Nm > 0.0 && torques.t1_Nm < torques.t2_Nm &&
                        torques.t2_Nm < torques.t3_Nm && std::isfinite(torques.t3_Nm);
  if (!in_order) {
    throw std::invalid_argument(
        fmt::format("t1_Nm = {}, t2_Nm = {}, t3_Nm = {} are out of order (expected 0 < t1 < t2 < t3)",
                    torques.t1_Nm, torques.t2_Nm, torques.t3_Nm));
  }
  RequireNotNegative("rated_Nm", torques.rated_Nm);
}

// Sign of the regression of twist on torque.
bool FallsWithTorque(std::span<const double> torque_Nm, std::span<const double> twist_rad) {
  double mean_torque_Nm = 0.0;
  double mean_twist_rad = 0.0;
  for (std::size_t i = 0; i < torque_Nm.size(); ++i) {
    mean_torque_Nm += torque_Nm[i];
    mean_twist_rad += twist_rad[i];
  }
  mean_torque_Nm /= static_cast<double>(torque_Nm.size());
  mean_twist_rad /= static_cast<double>(torque_Nm.size());
  double covariance = 0.0;
  for (std::size_t i = 0; i < torque_Nm.size(); ++i) {
    covariance += (torque_Nm[i] - mean_torque_Nm) * (twist_rad[i] - mean_twist_rad);
  }
  return covariance < 0.0;
}

bool Settled(const PreparedLoop& loop, const Branch& branch) {
  const double start_Nm = loop.torque_Nm[branch.first];
  return branch.rising ? start_Nm <= -loop.torques.t1_Nm : start_Nm >= loop.torques.t1_Nm;
}

// Mean twist at a torque over the branches of one direction: over the settled ones; else over these prolonged
// by the level (a record that ends at zero torque); else, where none is settled, over what there is.
Estimate MeanTwist(const PreparedLoop& loop, double level_Nm, bool rising) {
  const double window_Nm = loop.ZeroWindow_Nm();
  struct Choice {
    bool settled_only;
    double window_Nm;
    double reach_Nm;
  };
  const double near_Nm = 0.02 * loop.torques.t1_Nm;
  const bool has_settled = std::ranges::any_of(
      loop.branches, [&](const Branch& branch) { return branch.rising == rising && Settled(loop, branch); });
  for (const Choice& choice : {Choice{true, window_Nm, near_Nm},
                               Choice{true, window_Nm + std::abs(level_Nm), std::abs(level_Nm) + near_Nm},
                               Choice{has_settled, window_Nm, near_Nm}}) {
    double sum = 0.0;
    double variance = 0.0;
    int count = 0;
    for (const Branch& branch : loop.branches) {
      if (branch.rising != rising || (choice.settled_only && !Settled(loop, branch))) {
        continue;
      }
      const auto twist = TwistAtTorque(loop.torque_Nm, loop.twist_rad, branch, level_Nm, choice.window_Nm,
                                       choice.reach_Nm + 5.0 * loop.torque_noise_Nm.standard_deviation);
      if (twist) {
        sum += twist->value;
        variance += twist->standard_error * twist->standard_error;
        ++count;
      }
    }
    if (count > 0) {
      return {sum / count, std::sqrt(variance) / count};
    }
  }
  return kNotEstimated;
}

double Hypotenuse(double a, double b, double c, double d) {
  return std::hypot(std::hypot(a, b), std::hypot(c, d));
}

void CheckTorqueReached(const PreparedLoop& loop, std::vector<std::string>* failed) {
  constexpr double kShareOfPeak = 0.98;
  const auto [low, high] = std::minmax_element(loop.torque_Nm.begin(), loop.torque_Nm.end());
  const double t3_Nm = loop.torques.t3_Nm;
  if (*high < kShareOfPeak * t3_Nm) {
    failed->push_back(fmt::format(
        "torque not reached: {:.4g} Nm at most (expected at least 98 % of {:.4g} Nm)", *high, t3_Nm));
  }
  if (*low > -kShareOfPeak * t3_Nm) {
    failed->push_back(fmt::format(
        "torque not reached: {:.4g} Nm at least (expected at most 98 % of {:.4g} Nm)", *low, -t3_Nm));
  }
}

void CheckSegments(const PreparedLoop& loop, std::vector<std::string>* failed) {
  constexpr int kMinPerSegment = 8;
  const TestTorques& t = loop.torques;
  int counts[3] = {};
  for (double torque_Nm : loop.torque_Nm) {
    const double size = std::abs(torque_Nm);
    ++counts[(size > t.t1_Nm ? 1 : 0) + (size > t.t2_Nm ? 1 : 0)];
  }
  const double bounds_Nm[4] = {0.0, t.t1_Nm, t.t2_Nm, t.t3_Nm};
  for (int k = 0; k < 3; ++k) {
    if (counts[k] < kMinPerSegment) {
      failed->push_back(fmt::format("too few samples: {} between {:.4g} and {:.4g} Nm (expected at least {})",
                                    counts[k], bounds_Nm[k], bounds_Nm[k + 1], kMinPerSegment));
    }
  }
}

// The twist has to come back to where it was at the same torque. By how much the loop's two branches differ
// there is no failure, since the first sample may lie on either of them or, before the friction has settled,
// between.
void CheckClosed(const PreparedLoop& loop, const TorsionalStiffness& result,
                 std::vector<std::string>* failed) {
  const std::size_t n = loop.torque_Nm.size();
  const std::size_t few = std::min<std::size_t>(n / 8, 5);
  const auto mean_of = [few](const std::vector<double>& x, std::size_t first) {
    double sum = 0.0;
    for (std::size_t i = first; i < first + few; ++i) {
      sum += x[i];
    }
    return sum / static_cast<double>(few);
  };
  const double start_Nm = mean_of(loop.torque_Nm, 0);
  const double end_Nm = mean_of(loop.torque_Nm, n - few);
  const double end_rad = mean_of(loop.twist_rad, n - few);
  double there_rad = mean_of(loop.twist_rad, 0);
  const double elsewhere_Nm = 0.02 * loop.torques.t3_Nm + 4.0 * loop.torque_noise_Nm.standard_deviation;
  if (std::abs(end_Nm - start_Nm) > elsewhere_Nm) {
    // It ends elsewhere: compare with the first crossing of that torque.
    std::size_t crossing = n;
    for (std::size_t i = 1; i + few < n && crossing == n; ++i) {
      if ((loop.torque_Nm[i - 1] - end_Nm) * (loop.torque_Nm[i] - end_Nm) <= 0.0) {
        crossing = i;
      }
    }
    const bool earlier_branch = loop.branches.size() > 1 && crossing < loop.branches.back().first;
    if (!earlier_branch) {
      failed->push_back(fmt::format(
          "loop not closed: torque goes from {:.3g} to {:.3g} Nm and never comes back", start_Nm, end_Nm));
      return;
    }
    there_rad = loop.twist_rad[crossing];
  } else {
    there_rad += (end_Nm - start_Nm) / result.k1_Nm_per_rad.value;
  }
  const auto [low, high] = std::minmax_element(loop.twist_rad.begin(), loop.twist_rad.end());
  const double width_rad =
      std::isfinite(result.hysteresis_rad.value) ? std::abs(result.hysteresis_rad.value) : 0.0;
  const double noise_rad = Hypotenuse(loop.twist_noise_rad.standard_deviation, loop.twist_noise_rad.step,
                                      loop.torque_noise_Nm.standard_deviation / result.k1_Nm_per_rad.value,
                                      loop.torque_noise_Nm.step / result.k1_Nm_per_rad.value);
  // 0.2 % of the wind-up: what a loop without friction and noise may miss by its sampling.
  const double allowed_rad = width_rad + 6.0 * noise_rad + 0.002 * (*high - *low);
  const double gap_rad = end_rad - there_rad;
  if (std::isfinite(allowed_rad) && std::abs(gap_rad) > allowed_rad) {
    failed->push_back(
        fmt::format("loop not closed: the twist ends {:.3g} arcmin from where it was at {:.3g} Nm "
                    "(expected within {:.3g} arcmin)",
                    ArcminFromRad(gap_rad), end_Nm, ArcminFromRad(allowed_rad)));
  }
}

void CheckStiffness(const TorsionalStiffness& result, std::vector<std::string>* failed) {
  const Estimate* slopes[3] = {&result.k1_Nm_per_rad, &result.k2_Nm_per_rad, &result.k3_Nm_per_rad};
  for (int k = 0; k < 3; ++k) {
    if (std::isnan(slopes[k]->value)) {
      failed->push_back(fmt::format("stiffness K{} is not in the record", k + 1));
    } else if (!(slopes[k]->value > 0.0) || std::isinf(slopes[k]->value)) {
      failed->push_back(fmt::format("stiffness not positive: K{} = {:.4g} Nm/rad", k + 1, slopes[k]->value));
    }
  }
}

}  // namespace

PreparedLoop PrepareLoop(const TorsionLoop& loop, const TestTorques& torques) {
  RequireLoop(loop, torques);
  PreparedLoop prepared;
  prepared.torques = torques;
  prepared.torque_Nm.assign(loop.torque_Nm.begin(), loop.torque_Nm.end());
  prepared.twist_rad.assign(loop.twist_rad.begin(), loop.twist_rad.end());
  prepared.torque_noise_Nm = EstimateNoise(prepared.torque_Nm);
  prepared.twist_noise_rad = EstimateNoise(prepared.twist_rad);
  const auto torque_spikes = FindSpikes(prepared.torque_Nm, prepared.torque_noise_Nm);
  const auto twist_spikes = FindSpikes(prepared.twist_rad, prepared.twist_noise_rad);
  InterpolateOver(prepared.torque_Nm, torque_spikes);
  InterpolateOver(prepared.twist_rad, twist_spikes);
  std::set<std::size_t> spikes(torque_spikes.begin(), torque_spikes.end());
  spikes.insert(twist_spikes.begin(), twist_spikes.end());
  prepared.spikes.assign(spikes.begin(), spikes.end());

  prepared.sign_swapped = FallsWithTorque(prepared.torque_Nm, prepared.twist_rad);
  if (prepared.sign_swapped) {
    for (double& twist_rad : prepared.twist_rad) {
      twist_rad = -twist_rad;
    }
  }
  prepared.branches = SplitBranches(
      prepared.torque_Nm, std::max(ReversalThreshold(prepared.torque_noise_Nm), 0.02 * torques.t3_Nm));
  return prepared;
}

void MeasureLoopWidth(const PreparedLoop& loop, TorsionalStiffness* result) {
  const Estimate rising = MeanTwist(loop, 0.0, true);
  const Estimate falling = MeanTwist(loop, 0.0, false);
  // Where all samples of a line stand on one step, they agree, and are wrong together.
  const double rounding_rad = loop.twist_noise_rad.step / std::sqrt(12.0);
  result->hysteresis_rad = {falling.value - rising.value, Hypotenuse(rising.standard_error, rounding_rad,
                                                                     falling.standard_error, rounding_rad)};

  const double level_Nm = 0.04 * loop.RatedTorque_Nm();
  const Estimate rising_up = MeanTwist(loop, level_Nm, true);
  const Estimate falling_up = MeanTwist(loop, level_Nm, false);
  const Estimate rising_down = MeanTwist(loop, -level_Nm, true);
  const Estimate falling_down = MeanTwist(loop, -level_Nm, false);
  result->lost_motion_rad = {
      0.5 * (rising_up.value + falling_up.value - rising_down.value - falling_down.value),
      0.5 * std::hypot(2.0 * rounding_rad,
                       Hypotenuse(rising_up.standard_error, falling_up.standard_error,
                                  rising_down.standard_error, falling_down.standard_error))};
}

void CheckLoop(const PreparedLoop& loop, TorsionalStiffness* result) {
  std::vector<std::string>* failed = &result->failed_checks;
  if (loop.sign_swapped) {
    failed->push_back("twist falls with torque: a sign is swapped");
  }
  CheckTorqueReached(loop, failed);
  CheckSegments(loop, failed);
  if (std::isnan(result->hysteresis_rad.value)) {
    failed->push_back("no loop at zero torque: the record lacks a loading or an unloading branch there");
  }
  CheckClosed(loop, *result, failed);
  RestoreSign(loop, result);
  CheckStiffness(*result, failed);
}

void RestoreSign(const PreparedLoop& loop, TorsionalStiffness* result) {
  if (!loop.sign_swapped) {
    return;
  }
  for (Estimate* slope : {&result->k1_Nm_per_rad, &result->k2_Nm_per_rad, &result->k3_Nm_per_rad}) {
    slope->value = -slope->value;
  }
}

}  // namespace strainwave::analysis
