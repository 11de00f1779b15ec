// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "analysis/torsional_stiffness.h"
#include "analysis/units.h"

/// The loop model solved the other way round from the fit: torque is commanded, and the twist follows event
/// by event (a break of the spring, the yield of the element, a reversal), with tangent stiffnesses only.
namespace strainwave::analysis {

struct LoopTruth {
  double k1_Nm_per_rad = 1.6e4;
  double k2_Nm_per_rad = 2.5e4;
  double k3_Nm_per_rad = 2.9e4;
  double friction_Nm = 0.6;
  double yield_rad = RadFromArcsec(30.0);
  double t1_Nm = 7.0;
  double t2_Nm = 25.0;
};

class SimulatedGear {
 public:
  explicit SimulatedGear(const LoopTruth& truth) : truth_(truth) {}

  /// Takes the torque there in one direction and returns the twist.
  double TakeTo(double torque_Nm) {
    double left_Nm = torque_Nm - (spring_Nm_ + friction_Nm_);
    const double way = left_Nm > 0.0 ? 1.0 : -1.0;
    while (std::abs(left_Nm) > 0.0) {
      const bool slides = truth_.friction_Nm == 0.0 || way * friction_Nm_ >= truth_.friction_Nm;
      const double element = slides ? 0.0 : truth_.friction_Nm / truth_.yield_rad;
      double to_break_Nm = 0.0;
      const double spring = SpringTangent(way, &to_break_Nm);
      double step_rad = std::abs(left_Nm) / (spring + element);
      double event_rad = to_break_Nm / spring;
      bool yields = false;
      if (!slides) {
        const double to_yield_rad = (truth_.friction_Nm - way * friction_Nm_) / element;
        yields = to_yield_rad < event_rad;
        event_rad = std::fmin(event_rad, to_yield_rad);
      }
      const bool arrives = step_rad <= event_rad;
      step_rad = std::fmin(step_rad, event_rad);
      twist_rad_ += way * step_rad;
      spring_Nm_ += way * spring * step_rad;
      friction_Nm_ = !arrives && yields ? way * truth_.friction_Nm : friction_Nm_ + way * element * step_rad;
      if (!arrives && !yields) {
        spring_Nm_ = break_Nm_;  // land on the break exactly
      }
      if (arrives) {
        break;
      }
      left_Nm = torque_Nm - (spring_Nm_ + friction_Nm_);
      if (way * left_Nm <= 0.0) {
        break;
      }
    }
    return twist_rad_;
  }

 private:
  // Slope of the spring when moving that way, and the torque left until it changes.
  double SpringTangent(double way, double* to_break_Nm) {
    const double breaks_Nm[] = {-truth_.t2_Nm, -truth_.t1_Nm, truth_.t1_Nm, truth_.t2_Nm};
    const double slopes[] = {truth_.k3_Nm_per_rad, truth_.k2_Nm_per_rad, truth_.k1_Nm_per_rad,
                             truth_.k2_Nm_per_rad, truth_.k3_Nm_per_rad};
    std::size_t segment = 0;  // number of breaks that lie behind
    for (double break_Nm : breaks_Nm) {
      segment += way > 0.0 ? (spring_Nm_ >= break_Nm ? 1 : 0) : (spring_Nm_ > break_Nm ? 1 : 0);
    }
    const bool last = way > 0.0 ? segment == 4 : segment == 0;
    break_Nm_ = last ? way * 1e9 : breaks_Nm[way > 0.0 ? segment : segment - 1];
    *to_break_Nm = std::abs(break_Nm_ - spring_Nm_);
    return slopes[segment];
  }

  LoopTruth truth_;
  double twist_rad_ = 0.0;
  double spring_Nm_ = 0.0;
  double friction_Nm_ = 0.0;
  double break_Nm_ = 0.0;
};

struct LoopNoise {
  double torque_Nm = 0.0;
  double twist_rad = 0.0;
  double autoregression = 0.0;  // of first order, in both channels
  std::uint32_t seed = 1;
};

struct SimulatedRecord {
  std::vector<double> time_s;
  std::vector<double> torque_Nm;
  std::vector<double> twist_rad;

  TorsionLoop View() const { return {time_s, torque_Nm, twist_rad}; }
};

/// Ramps through the corner torques in equal steps, `samples` in all; the corners are sampled. The gear
/// starts at rest with no torque and is first taken to the first corner.
inline SimulatedRecord SimulateLoop(const LoopTruth& truth, const std::vector<double>& corners_Nm,
                                    std::size_t samples, const LoopNoise& noise = {},
                                    double series_compliance_rad_per_Nm = 0.0) {
  double way_Nm = 0.0;
  for (std::size_t k = 1; k < corners_Nm.size(); ++k) {
    way_Nm += std::abs(corners_Nm[k] - corners_Nm[k - 1]);
  }
  SimulatedGear gear(truth);
  SimulatedRecord record;
  const auto add = [&](double torque_Nm) {
    record.time_s.push_back(0.01 * static_cast<double>(record.time_s.size()));
    record.twist_rad.push_back(gear.TakeTo(torque_Nm) + series_compliance_rad_per_Nm * torque_Nm);
    record.torque_Nm.push_back(torque_Nm);
  };
  add(corners_Nm.front());
  for (std::size_t k = 1; k < corners_Nm.size(); ++k) {
    const double from_Nm = corners_Nm[k - 1];
    const double to_Nm = corners_Nm[k];
    const auto steps =
        static_cast<int>(std::lround(std::abs(to_Nm - from_Nm) / way_Nm * static_cast<double>(samples)));
    for (int i = 1; i <= steps; ++i) {
      add(i == steps ? to_Nm : from_Nm + (to_Nm - from_Nm) * i / steps);
    }
  }
  std::mt19937 engine(noise.seed);
  std::normal_distribution<double> normal;
  const double innovation = std::sqrt(1.0 - noise.autoregression * noise.autoregression);
  double torque_state = normal(engine);
  double twist_state = normal(engine);
  for (std::size_t i = 0; i < record.torque_Nm.size(); ++i) {
    record.torque_Nm[i] += noise.torque_Nm * torque_state;
    record.twist_rad[i] += noise.twist_rad * twist_state;
    torque_state = noise.autoregression * torque_state + innovation * normal(engine);
    twist_state = noise.autoregression * twist_state + innovation * normal(engine);
  }
  return record;
}

}  // namespace strainwave::analysis
