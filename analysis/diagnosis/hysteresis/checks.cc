// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/arguments.h"
#include "analysis/diagnosis/hysteresis/signal.h"
#include "analysis/loop_branches.h"
#include "analysis/model/torsion_spring.h"
#include "analysis/noise_level.h"
#include "analysis/samples/holds.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr std::size_t kFewestSamples = 60;

void RequireKnees(const HysteresisData& record) {
  const bool in_order = record.t1_Nm > 0.0 && record.t1_Nm < record.t2_Nm && record.t2_Nm <= record.t3_Nm &&
                        std::isfinite(record.t3_Nm);
  if (!in_order) {
    throw std::invalid_argument(
        fmt::format("t1_Nm = {}, t2_Nm = {}, t3_Nm = {} are out of order (expected 0 < t1 < t2 <= t3)",
                    record.t1_Nm, record.t2_Nm, record.t3_Nm));
  }
}

// By how much most of a segment's samples go beyond where it begins and ends: a hump, of either sign. 0 for a
// segment too short to tell.
double HumpOf(std::span<const double> segment) {
  constexpr std::size_t kEnd = 3;
  if (segment.size() < 4 * kEnd) return 0.0;
  const double begin = Median({segment.begin(), segment.begin() + kEnd});
  const double end = Median({segment.end() - kEnd, segment.end()});
  const auto middle = segment.subspan(segment.size() / 3, segment.size() / 3 + 1);
  const double centre = Median({middle.begin(), middle.end()});
  return std::max(centre - std::max(begin, end), std::min(begin, end) - centre);
}

[[noreturn]] void RefuseSaturated(double extreme_Nm, std::size_t samples, bool largest) {
  throw std::invalid_argument(fmt::format(
      "torque_Nm is saturated: {} samples read {:.4g} Nm, its {} value, while the angle goes on and "
      "comes back (expected a transducer or an amplifier with room beyond the peak torque)",
      samples, extreme_Nm, largest ? "largest" : "smallest"));
}

// A run of readings at the largest or smallest torque, equal to the last digit although the signal has noise,
// or equal but for noise while the twist goes on outward and comes back: the torque did so, too, and its
// signal could not follow.
void RequireTorqueNotSaturated(const HysteresisData& record, double twist_range_rad) {
  constexpr double kHump = 0.02;  // of the twist's range
  const std::span<const double> torque = record.torque_Nm;
  const std::span<const double> twist = record.output_angle_rad;
  const std::vector<double> times_s = TimesOfSamples(record.time_s, torque, twist);
  const double least_hump_rad = std::max(kHump * twist_range_rad, 4.0 * SampleNoise(times_s, twist));
  const auto [low, high] = std::minmax_element(torque.begin(), torque.end());
  for (const samples::Saturated& end : samples::FindSaturated(torque))
    RefuseSaturated(end.at, end.count, end.at == *high);
  // A stair of a few samples a step passes for noise, and its risers would be equal.
  constexpr double kMostEqual = 0.02;  // of the torque's range
  const double equal_Nm = std::min(8.0 * SampleNoise(times_s, torque), kMostEqual * (*high - *low));
  for (const double extreme : {*low, *high}) {
    std::size_t stuck = 0;
    bool humped = false;
    for (std::size_t i = 0; i < torque.size(); ++i) {
      std::size_t end = i;
      while (end < torque.size() && std::abs(torque[end] - extreme) <= equal_Nm) ++end;
      if (end == i) continue;
      stuck += end - i;
      humped = humped || HumpOf(twist.subspan(i, end - i)) > least_hump_rad;
      i = end;
    }
    if (humped) RefuseSaturated(extreme, stuck, extreme == *high);
  }
}

}  // namespace

void RequireDiagnosableLoop(const HysteresisData& record) {
  RequireSameLength("torque_Nm", record.torque_Nm, "time_s", record.time_s);
  RequireSameLength("output_angle_deg", record.output_angle_rad, "time_s", record.time_s);
  if (!record.temperature_degC.empty()) {
    RequireSameLength("temperature_degC", record.temperature_degC, "time_s", record.time_s);
    RequireFinite("temperature_degC", record.temperature_degC);
  }
  RequireFinite("time_s", record.time_s);
  RequireFinite("torque_Nm", record.torque_Nm);
  RequireFinite("output_angle_deg", record.output_angle_rad);
  RequireKnees(record);
  if (record.time_s.size() < kFewestSamples) {
    throw std::invalid_argument(
        fmt::format("the record is too short: {} samples (expected at least {}, of a whole loop)",
                    record.time_s.size(), kFewestSamples));
  }
  const auto [angle_low, angle_high] =
      std::minmax_element(record.output_angle_rad.begin(), record.output_angle_rad.end());
  const double twist_range_rad = *angle_high - *angle_low;
  const std::vector<double> times_s =
      TimesOfSamples(record.time_s, record.torque_Nm, record.output_angle_rad);
  if (!(twist_range_rad > 12.0 * SampleNoise(times_s, record.output_angle_rad)) || twist_range_rad == 0.0) {
    throw std::invalid_argument(fmt::format(
        "output_angle_deg stays within {:.3g} arcmin, which is its noise (expected it to follow the torque)",
        ArcminFromRad(twist_range_rad)));
  }
  const auto [torque_low, torque_high] =
      std::minmax_element(record.torque_Nm.begin(), record.torque_Nm.end());
  if (std::max(std::abs(*torque_low), std::abs(*torque_high)) <= record.t1_Nm) {
    throw std::invalid_argument(
        fmt::format("torque_Nm stays between {:.4g} and {:.4g} Nm (expected it to go beyond t1_Nm = {:.4g})",
                    *torque_low, *torque_high, record.t1_Nm));
  }
  const double threshold_Nm = std::max(0.2 * record.t1_Nm, 10.0 * SampleNoise(times_s, record.torque_Nm));
  if (SplitBranches(record.torque_Nm, threshold_Nm).size() < 2) {
    throw std::invalid_argument(
        fmt::format("torque_Nm goes from {:.4g} to {:.4g} Nm and never back (expected a loop)",
                    record.torque_Nm.front(), record.torque_Nm.back()));
  }
  RequireTorqueNotSaturated(record, twist_range_rad);
}

std::vector<std::string> OddThingsAbout(const HysteresisData& record, double twist_range_rad,
                                        double peak_torque_Nm) {
  std::vector<std::string> odd;
  const auto [low, high] = std::minmax_element(record.torque_Nm.begin(), record.torque_Nm.end());
  // Gears of this make, of all sizes, wind up by 3 to 8 arcmin at T3: stiffness grows as the rated torque
  // does.
  constexpr double kWindUpAtT3_arcmin = 5.0;
  // Couplings and transducer of the simulated bench, left in, double it.
  constexpr double kMostWindUp = 4.0;
  const double wind_up_arcmin = ArcminFromRad(twist_range_rad) / (*high - *low) * record.t3_Nm;
  const double factor = wind_up_arcmin / kWindUpAtT3_arcmin;
  if (factor > 20.0 && factor < 180.0) {
    odd.push_back(fmt::format(
        "output_angle_deg looks like arcmin: the twist is about {:.2g} times what a gear with t3 = "
        "{:.4g} Nm has (1 deg = 60 arcmin)",
        factor, record.t3_Nm));
  } else if (factor < 1.0 / 20.0 && factor > 1.0 / 180.0) {
    odd.push_back(fmt::format(
        "output_angle_deg looks like rad: the twist is about {:.2g} times smaller than what a gear "
        "with t3 = {:.4g} Nm has (1 rad = 57.3 deg)",
        1.0 / factor, record.t3_Nm));
  } else if (factor > kMostWindUp || factor < 1.0 / kMostWindUp) {
    odd.push_back(fmt::format(
        "twist per torque is {:.2g} times what a gear with t3 = {:.4g} Nm has: look at the units of "
        "torque_Nm and output_angle_deg",
        factor, record.t3_Nm));
  }
  if (*low > -0.2 * *high || *high < -0.2 * *low) {
    odd.push_back(
        fmt::format("torque goes to one side only ({:.4g} to {:.4g} Nm): what differs between the two sides "
                    "cannot be seen",
                    *low, *high));
  }
  if (peak_torque_Nm < record.t2_Nm) {
    odd.push_back(
        fmt::format("torque goes up to {:.4g} Nm and never beyond t2_Nm = {:.4g}: K3 cannot be seen",
                    peak_torque_Nm, record.t2_Nm));
  } else if (peak_torque_Nm > 3.0 * record.t3_Nm) {
    odd.push_back(
        fmt::format("torque goes up to {:.4g} Nm, {:.2g} times t3_Nm: look at the units of torque_Nm",
                    peak_torque_Nm, peak_torque_Nm / record.t3_Nm));
  }
  return odd;
}

std::string CommonStiffnessChange(std::span<const double> k_Nm_per_rad, double t1_Nm, double t2_Nm) {
  constexpr double kAlike = 0.1;    // spread of the three among themselves
  constexpr double kScatter = 0.3;  // from one unit to the next (docs/effects.md E25)
  const model::TorsionSpring reference;
  if (std::abs(t1_Nm / reference.t1_Nm - 1.0) > 0.05 || std::abs(t2_Nm / reference.t2_Nm - 1.0) > 0.05 ||
      k_Nm_per_rad.size() != 3) {
    return {};
  }
  const double nominal[3] = {reference.k1_Nm_per_rad, reference.k2_Nm_per_rad, reference.k3_Nm_per_rad};
  double ratios[3];
  double compliances[3];
  for (std::size_t k = 0; k < 3; ++k) {
    ratios[k] = k_Nm_per_rad[k] / nominal[k];
    compliances[k] = 1.0 / k_Nm_per_rad[k] - 1.0 / nominal[k];
  }
  const auto spread = [](const double(&values)[3]) {
    const auto [low, high] = std::minmax_element(std::begin(values), std::end(values));
    return (*high - *low) / std::abs((values[0] + values[1] + values[2]) / 3.0);
  };
  const double mean_ratio = (ratios[0] + ratios[1] + ratios[2]) / 3.0;
  const double mean_compliance = (compliances[0] + compliances[1] + compliances[2]) / 3.0;
  if (std::abs(std::log(mean_ratio)) < std::log1p(kScatter)) return {};
  // Another unit, which OddThingsAbout tells.
  if (std::abs(std::log(mean_ratio)) > std::log(20.0)) return {};
  if (spread(ratios) < kAlike && spread(ratios) <= spread(compliances)) {
    return fmt::format(
        "K1, K2 and K3 are all {:.2g} times those of the reference unit: a gain error of the torque signal "
        "looks the same "
        "(calibrate it with weights on an arm before the gear is blamed)",
        mean_ratio);
  }
  if (mean_compliance > 0.0 && spread(compliances) < 0.25) {
    return fmt::format(
        "K1, K2 and K3 are low as if {:.3g} arcmin/Nm were in series with the gear: couplings and transducer "
        "look the "
        "same (measure them with a rigid blank in place of the gear: blank_test)",
        ArcminFromRad(mean_compliance));
  }
  return {};
}

}  // namespace strainwave::analysis::diagnosis
