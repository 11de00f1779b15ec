// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "analysis/diagnosis/records.h"
#include "analysis/units.h"

/// Hysteresis records made by another route than the fitted model: everything is stepped in small increments
/// of time with tangent stiffnesses and rates, nothing is solved.
namespace strainwave::analysis::diagnosis {

struct GeneratedGear {
  double k1_Nm_per_rad{1.5e4};
  double k2_Nm_per_rad{2.4e4};
  double k3_Nm_per_rad{3.0e4};
  double t1_Nm{7.0};
  double t2_Nm{25.0};
  std::vector<double> friction_Nm{1.2};  // of each element
  std::vector<double> yield_rad{1.0e-4};
  double dead_zone_rad{};          // in the spring, beside the friction
  double outside_dead_zone_rad{};  // in series with both
  double stiffer_share{};          // (K+ − K−) / (K+ + K−)
  double k1_stiffer_share{};       // of the first segment alone
  double k2_stiffer_share{};       // of the second
  double k3_stiffer_share{};       // of the third
  double law_stiffer_share{};      // of all of them, with the knees at the same twist on both sides
  double rise_with_rate{};         // of the friction's limits: × (1 + rise · ln(1 + |Ṫ| / 1 Nm/s))
  double linear_rise_with_rate{};  // × (1 + rise · |Ṫ| / 1 Nm/s)
  double torque_lag_s{};           // what turns the gear is the torque less its rate times that
  double hardening_Nm_per_rad3{};
  double damper_Nms_per_rad{};
  double creep_share_per_decade{};  // three Kelvin-Voigt elements, one a decade, from `creep_s` on
  double creep_share{};             // one element of `creep_s`
  double creep_s{2.0};
  double creep_rad_per_Nm{};  // > 0: one element of `creep_s` that goes with the torque, not with the twist
  double slip_from_Nm{1e9};
  double slip_rad_per_Nms{};  // speed by the excess over `slip_from_Nm`
  double slip_rad_per_s{};    // one speed beyond it
  double slip_at_once_rad{};  // once, the first time that it is passed
};

struct GeneratedSensors {
  double torque_offset_Nm{};
  double torque_noise_Nm{0.01};
  double angle_noise_rad{RadFromArcmin(0.01)};
  double autoregression{};  // of the angle's noise
  double angle_offset_rad{0.002};
  std::function<double(double time_s, double temperature_K)> drift_rad{};
  std::function<double(double time_s, double torque_Nm, double angle_rad, bool rising)> unlisted_rad{};
  bool has_temperature{};
};

/// A segment of the torque's path: goes there at a rate, then holds.
struct PathLeg {
  double to_Nm{};
  double rate_Nm_per_s{1.0};
  double hold_s{};
};

/// A path of loops: the legs of the upper half, then the same below zero.
inline std::vector<PathLeg> Loops(int count, const std::vector<PathLeg>& upper_half) {
  std::vector<PathLeg> path;
  for (int loop = 0; loop < count; ++loop) {
    for (const double sign : {1.0, -1.0}) {
      for (const PathLeg& leg : upper_half) path.push_back({sign * leg.to_Nm, leg.rate_Nm_per_s, leg.hold_s});
    }
  }
  return path;
}

class SteppedGear {
 public:
  explicit SteppedGear(const GeneratedGear& gear)
      : gear_(gear), element_Nm_(gear.friction_Nm.size(), 0.0), creep_(gear.creep_share > 0.0 ? 1 : 3, 0.0) {}

  void Step(double torque_Nm, double step_s) {
    const double rate_Nm_per_s = (torque_Nm - torque_Nm_) / step_s;
    torque_Nm_ = torque_Nm;
    limit_scale_ = 1.0 + gear_.rise_with_rate * std::log1p(std::abs(rate_Nm_per_s)) +
                   gear_.linear_rise_with_rate * std::abs(rate_Nm_per_s);
    const double felt_Nm = torque_Nm - gear_.torque_lag_s * rate_Nm_per_s;
    double change_Nm = felt_Nm - felt_Nm_;
    felt_Nm_ = felt_Nm;
    // What an element can no longer carry the others take over.
    for (std::size_t j = 0; j < element_Nm_.size(); ++j) {
      const double limit_Nm = limit_scale_ * gear_.friction_Nm[j];
      const double carried_Nm = std::clamp(element_Nm_[j], -limit_Nm, limit_Nm);
      change_Nm += element_Nm_[j] - carried_Nm;
      element_Nm_[j] = carried_Nm;
    }
    if (gear_.damper_Nms_per_rad > 0.0) {
      constexpr int kParts = 16;
      for (int part = 0; part < kParts; ++part) {
        double left_Nm = torque_Nm - change_Nm * (1.0 - (part + 0.5) / kParts) - SpringTorque(twist_rad_);
        for (const double element_Nm : element_Nm_) left_Nm -= element_Nm;
        // Half-implicit: the stiffness there may be too much for the damper at this step.
        double stiffness = SpringSlope(twist_rad_);
        for (std::size_t j = 0; j < element_Nm_.size(); ++j) {
          const double way = left_Nm > 0.0 ? 1.0 : -1.0;
          if (way * element_Nm_[j] < gear_.friction_Nm[j])
            stiffness += gear_.friction_Nm[j] / gear_.yield_rad[j];
        }
        Twist(left_Nm / (gear_.damper_Nms_per_rad / step_s * kParts + 0.5 * stiffness));
      }
    } else {
      // In steps so small that no kink matters.
      constexpr double kMost_rad = 2e-8;
      const double way = change_Nm > 0.0 ? 1.0 : -1.0;
      change_Nm = std::abs(change_Nm);
      while (change_Nm > 0.0) {
        double stiffness = SpringSlope(twist_rad_);
        for (std::size_t j = 0; j < element_Nm_.size(); ++j) {
          if (way * element_Nm_[j] < limit_scale_ * gear_.friction_Nm[j])
            stiffness += gear_.friction_Nm[j] / gear_.yield_rad[j];
        }
        const double part_rad = std::min(change_Nm / stiffness, kMost_rad);
        Twist(way * part_rad);
        change_Nm -= part_rad * stiffness + 1e-15;
      }
    }
    yielded_rad_ += (gear_.creep_rad_per_Nm * torque_Nm - yielded_rad_) * step_s / gear_.creep_s;
    double time_constant_s = gear_.creep_s;
    for (double& part : creep_) {
      part += (twist_rad_ - part) * step_s / time_constant_s;
      time_constant_s *= 10.0;
    }
    const double beyond_Nm = std::abs(torque_Nm) - gear_.slip_from_Nm;
    if (beyond_Nm > 0.0) {
      slip_rad_ +=
          std::copysign(step_s, torque_Nm) * (gear_.slip_rad_per_s + gear_.slip_rad_per_Nms * beyond_Nm);
      if (!slipped_) slip_rad_ += std::copysign(gear_.slip_at_once_rad, torque_Nm);
      slipped_ = true;
    }
  }

  double Angle_rad() const {
    double creep_rad = 0.0;
    for (const double part : creep_) creep_rad += part;
    const double share = gear_.creep_share > 0.0 ? gear_.creep_share : gear_.creep_share_per_decade;
    return twist_rad_ + 0.5 * gear_.outside_dead_zone_rad * std::tanh(torque_Nm_ / 0.05) + share * creep_rad +
           slip_rad_ + yielded_rad_;
  }

 private:
  void Twist(double change_rad) {
    twist_rad_ += change_rad;
    for (std::size_t j = 0; j < element_Nm_.size(); ++j) {
      const double limit_Nm = limit_scale_ * gear_.friction_Nm[j];
      element_Nm_[j] = std::clamp(element_Nm_[j] + change_rad * gear_.friction_Nm[j] / gear_.yield_rad[j],
                                  -limit_Nm, limit_Nm);
    }
  }

  double Scale(double twist_rad) const {
    return twist_rad > 0.0 ? 1.0 + gear_.stiffer_share : 1.0 - gear_.stiffer_share;
  }

  double SpringSlope(double twist_rad) const {
    const double in_zone = 0.5 * gear_.dead_zone_rad;
    const double size = std::abs(twist_rad) - in_zone;
    const double scale = Scale(twist_rad);
    const double side = twist_rad > 0.0 ? 1.0 : -1.0;
    const double first_Nm_per_rad = gear_.k1_Nm_per_rad * scale * (1.0 + side * gear_.k1_stiffer_share);
    const double second_Nm_per_rad = gear_.k2_Nm_per_rad * scale * (1.0 + side * gear_.k2_stiffer_share);
    const double third_Nm_per_rad = gear_.k3_Nm_per_rad * scale * (1.0 + side * gear_.k3_stiffer_share);
    const double knee1 = gear_.t1_Nm / first_Nm_per_rad;
    const double knee2 = knee1 + (gear_.t2_Nm - gear_.t1_Nm) / second_Nm_per_rad;
    double slope = size < 0.0     ? 0.01 * gear_.k1_Nm_per_rad
                   : size < knee1 ? first_Nm_per_rad
                   : size < knee2 ? second_Nm_per_rad
                                  : third_Nm_per_rad;
    slope *= 1.0 + side * gear_.law_stiffer_share;
    return slope + 3.0 * gear_.hardening_Nm_per_rad3 * twist_rad * twist_rad;
  }

  // Midpoint sum of the slope: slow, and only used with a damper.
  double SpringTorque(double twist_rad) {
    spring_Nm_ += SpringSlope(0.5 * (spring_at_rad_ + twist_rad)) * (twist_rad - spring_at_rad_);
    spring_at_rad_ = twist_rad;
    return spring_Nm_;
  }

  GeneratedGear gear_;
  double torque_Nm_{};
  double felt_Nm_{};
  double limit_scale_{1.0};
  bool slipped_{};
  double twist_rad_{};
  double spring_Nm_{};
  double spring_at_rad_{};
  double slip_rad_{};
  double yielded_rad_{};
  std::vector<double> element_Nm_;
  std::vector<double> creep_;
};

/// Starts at rest without torque and goes along the path, sampled at equal times; `samples` in all, about.
inline HysteresisData GenerateLoop(const GeneratedGear& gear, const GeneratedSensors& sensors,
                                   const std::vector<PathLeg>& path, std::size_t samples,
                                   std::uint32_t seed) {
  double duration_s = 0.0;
  double at_Nm = 0.0;
  for (const PathLeg& leg : path) {
    duration_s += std::abs(leg.to_Nm - at_Nm) / leg.rate_Nm_per_s + leg.hold_s;
    at_Nm = leg.to_Nm;
  }
  constexpr int kSubsteps = 20;
  const double sample_s = duration_s / static_cast<double>(samples);
  const double step_s = sample_s / kSubsteps;
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  SteppedGear stepped(gear);
  HysteresisData record;
  double time_s = 0.0;
  double torque_Nm = 0.0;
  double noise = normal(engine);
  std::size_t leg = 0;
  double held_s = 0.0;
  bool rising = true;
  for (std::size_t i = 0; i < samples; ++i) {
    const double temperature_K =
        1.0 - std::exp(-time_s / (0.4 * duration_s)) + 0.3 * std::sin(5.0 * time_s / duration_s);
    double angle_rad = sensors.angle_offset_rad + stepped.Angle_rad();
    if (sensors.drift_rad) angle_rad += sensors.drift_rad(time_s, temperature_K);
    if (sensors.unlisted_rad)
      angle_rad += sensors.unlisted_rad(time_s, torque_Nm, stepped.Angle_rad(), rising);
    record.time_s.push_back(time_s);
    record.torque_Nm.push_back(torque_Nm + sensors.torque_offset_Nm +
                               sensors.torque_noise_Nm * normal(engine));
    record.output_angle_rad.push_back(angle_rad + sensors.angle_noise_rad * noise);
    noise = sensors.autoregression * noise +
            std::sqrt(1.0 - sensors.autoregression * sensors.autoregression) * normal(engine);
    if (sensors.has_temperature)
      record.temperature_degC.push_back(24.0 + temperature_K + 0.02 * normal(engine));
    for (int k = 0; k < kSubsteps; ++k) {
      if (leg < path.size()) {
        const double left_Nm = path[leg].to_Nm - torque_Nm;
        const double most_Nm = path[leg].rate_Nm_per_s * step_s;
        if (left_Nm != 0.0) rising = left_Nm > 0.0;
        if (std::abs(left_Nm) > most_Nm) {
          torque_Nm += std::copysign(most_Nm, left_Nm);
        } else {
          torque_Nm = path[leg].to_Nm;
          held_s += step_s;
          if (held_s >= path[leg].hold_s) {
            ++leg;
            held_s = 0.0;
          }
        }
      }
      stepped.Step(torque_Nm, step_s);
      time_s += step_s;
    }
  }
  return record;
}

}  // namespace strainwave::analysis::diagnosis
