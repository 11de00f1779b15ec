// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/hysteresis/gear.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/model/asymmetric_stiffness.h"
#include "analysis/model/cubic_hardening.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Of a step between points where a damper works, so that corners and kinks fall between parts.
constexpr int kPartsOfStep = 4;
constexpr double kMostStepsOfGap = 200.0;
// Of the usual rate: rounding of torques and times, and what is left of their noise.
constexpr double kSameRate = 0.02;

struct Tangent {
  double torque_Nm;
  double stiffness_Nm_per_rad;
};

// Weight of a step's end in the damper's mean force, between the backward difference and the mean of both
// ends, so that a straight spring's relaxation is exact (exponential fitting; Liniger & Willoughby, SIAM J.
// Numer. Anal. 7 (1970) 47). `decay` is the step over the time constant.
double EndWeight(double decay) {
  if (decay > 0.5) return -1.0 / std::expm1(-decay) - 1.0 / decay;
  const double square = decay * decay;
  return 0.5 + decay / 12.0 * (1.0 - square / 60.0 * (1.0 - square / 42.0 * (1.0 - square / 40.0)));
}

// The spring of one side in its pieces, dead zone, K1, K2 and K3: where each begins, and its slope.
struct Side {
  std::array<double, 4> start_rad;
  std::array<double, 4> start_Nm;
  std::array<double, 4> slope;

  double Torque_Nm(std::size_t piece, double size_rad) const {
    return start_Nm[piece] + slope[piece] * (size_rad - start_rad[piece]);
  }
};

Side MakeSide(const GearLaw& law, double sign) {
  const model::TorsionSpring& spring = law.spring;
  const auto on_side = [&](double usual, std::size_t segment) {
    return usual * model::StiffnessOnSide(law.asymmetry_share[segment], sign);
  };
  Side side{};
  side.slope = {on_side(spring.k1_Nm_per_rad, 0), on_side(spring.k1_Nm_per_rad, 0),
                on_side(spring.k2_Nm_per_rad, 1), on_side(spring.k3_Nm_per_rad, 2)};
  if (law.backlash_beside_friction && law.backlash.width_rad > 0.0) {
    const double edge_Nm = law.backlash.torque_Nm;
    side.start_Nm[1] = edge_Nm;
    side.start_rad[1] = edge_Nm / side.slope[1] + model::BacklashTwist_rad(law.backlash, edge_Nm);
    side.slope[0] = edge_Nm / side.start_rad[1];
  }
  const auto knee_Nm = [&](double torque_Nm) {
    return law.knees_at_twist ? on_side(torque_Nm, 0) : torque_Nm;
  };
  side.start_Nm[2] = knee_Nm(spring.t1_Nm);
  side.start_rad[2] = side.start_rad[1] + (side.start_Nm[2] - side.start_Nm[1]) / side.slope[1];
  side.start_Nm[3] = knee_Nm(spring.t2_Nm);
  side.start_rad[3] = side.start_rad[2] + (side.start_Nm[3] - side.start_Nm[2]) / side.slope[2];
  return side;
}

// The law with everything worked out that does not change along a record.
class Gear {
 public:
  Gear(const GearLaw& law, double mean_step_s)
      : law_(law),
        mean_step_s_(mean_step_s),
        positive_(MakeSide(law, 1.0)),
        negative_(MakeSide(law, -1.0)),
        friction_(law.friction) {
    for (std::size_t j = 0; j < law.friction_elements; ++j)
      stiffness_[j] = law.friction[j].stiffness_Nm_per_rad();
  }

  Tangent Spring(double twist_rad) const {
    const bool turned = twist_rad < 0.0;
    const Side& side = turned ? negative_ : positive_;
    const double size = std::abs(twist_rad);
    std::size_t piece = 0;
    while (piece < 3 && size > side.start_rad[piece + 1]) ++piece;
    double torque = side.Torque_Nm(piece, size);
    double slope = side.slope[piece];
    if (law_.hardening_Nm_per_rad3 != 0.0) {
      torque += model::CubicTorque_Nm(law_.hardening_Nm_per_rad3, size);
      slope += model::CubicStiffness_Nm_per_rad(law_.hardening_Nm_per_rad3, size);
    }
    return {turned ? -torque : torque, slope};
  }

  // Goes from one torque to another in a straight line.
  void GoTo(double from_Nm, double to_Nm, double step_s) {
    const bool damped = law_.viscous_Nms_per_rad > 0.0;
    if (!std::exchange(balanced_, true)) return TakeTo(to_Nm, step_s);
    if (damped ? GoStraightDamped(from_Nm, to_Nm, step_s) : GoStraight(from_Nm, to_Nm)) return;
    LeaveStraight();
    // A gap counts as the steps that it lasts.
    const double steps = std::clamp(step_s / mean_step_s_, 1.0, kMostStepsOfGap);
    const int parts = damped ? static_cast<int>(kPartsOfStep * steps) : 1;
    for (int part = 1; part < parts; ++part)
      TakeTo(from_Nm + (to_Nm - from_Nm) * part / parts, step_s / parts);
    TakeTo(to_Nm, step_s / parts);
  }

  // At a torque with the elements in given states.
  void StartAt(double torque_Nm, const std::array<double, kFrictionElements>& share) {
    friction_ = law_.friction;
    rate_Nm_per_s_ = 0.0;
    balanced_ = true;
    double carried_Nm = 0.0;
    for (std::size_t j = 0; j < law_.friction_elements; ++j) carried_Nm += share[j] * friction_[j].limit_Nm;
    twist_rad_ = Solve(0.0, [&](double twist) {
      Tangent at = Spring(twist);
      at.torque_Nm += carried_Nm - torque_Nm;
      return at;
    });
    for (std::size_t j = 0; j < law_.friction_elements; ++j) {
      anchor_rad_[j] = twist_rad_ - share[j] * friction_[j].yield_rad;
    }
    damper_Nm_ = 0.0;
    straight_.direction = 0.0;
  }

  double twist_rad() const { return twist_rad_; }

  // The torque is to change at this rate from here on: friction that rises with it yields further out.
  void SetRate(double rate_Nm_per_s) {
    if (law_.friction_rise_share == 0.0 ||
        std::abs(rate_Nm_per_s - rate_Nm_per_s_) <= kSameRate * law_.usual_rate_Nm_per_s)
      return;
    rate_Nm_per_s_ = rate_Nm_per_s;
    LeaveStraight();
    const double usual_rates = std::abs(rate_Nm_per_s) / law_.usual_rate_Nm_per_s;
    const double scale = 1.0 + law_.friction_rise_share *
                                   (law_.friction_rises_linearly ? usual_rates : std::log1p(usual_rates));
    for (std::size_t j = 0; j < law_.friction_elements; ++j) {
      friction_[j] = {scale * law_.friction[j].limit_Nm, scale * law_.friction[j].yield_rad};
      anchor_rad_[j] = model::MovedAnchor(friction_[j], twist_rad_, anchor_rad_[j]);
    }
    balanced_ = false;
  }

 private:
  // Even steps on one piece of the law ask for the same one again.
  double EndWeightOf(double decay) {
    if (decay != decay_) {
      decay_ = decay;
      end_weight_ = EndWeight(decay);
    }
    return end_weight_;
  }

  // A way in one direction without a kink: no knee of the spring, and no element that begins to slip. Most
  // steps stay on one, and cost then no look at the elements. A cubic term comes on top of it.
  struct Straight {
    double direction{};  // 0: none
    double from_rad{};
    double from_Nm{};  // spring and elements there
    double stiffness_Nm_per_rad{};
    double end_rad{};

    double Torque_Nm(double twist_rad) const {
      return from_Nm + stiffness_Nm_per_rad * (twist_rad - from_rad);
    }
    bool Holds(double twist_rad) const { return twist_rad * direction <= end_rad * direction; }
  };

  // Sets out in a direction, if not on the way in it already.
  void Head(double direction) {
    if (straight_.direction == direction) return;
    LeaveStraight();
    const double sign = twist_rad_ * direction < 0.0 ? -direction : direction;
    const bool outward = sign == direction;
    const Side& side = sign > 0.0 ? positive_ : negative_;
    const double size = std::abs(twist_rad_);
    std::size_t piece = 0;
    while (piece < 3 && (outward ? size >= side.start_rad[piece + 1] : size > side.start_rad[piece + 1]))
      ++piece;
    double way_rad = size - side.start_rad[piece];
    if (outward)
      way_rad = piece < 3 ? side.start_rad[piece + 1] - size : std::numeric_limits<double>::infinity();
    straight_ = {direction, twist_rad_, sign * side.Torque_Nm(piece, size), side.slope[piece], 0.0};
    for (std::size_t j = 0; j < law_.friction_elements; ++j) {
      const model::ElastoPlasticElement& element = friction_[j];
      straight_.from_Nm += model::ElementTorque(element, twist_rad_, anchor_rad_[j]);
      const double before_slip_rad = element.yield_rad - direction * (twist_rad_ - anchor_rad_[j]);
      if (before_slip_rad < 1e-9 * element.yield_rad) continue;
      straight_.stiffness_Nm_per_rad += stiffness_[j];
      way_rad = std::min(way_rad, before_slip_rad);
    }
    straight_.end_rad = twist_rad_ + direction * way_rad;
  }

  // Drags along the elements that slipped on the way.
  void LeaveStraight() {
    if (straight_.direction == 0.0) return;
    straight_.direction = 0.0;
    for (std::size_t j = 0; j < law_.friction_elements; ++j)
      anchor_rad_[j] = model::MovedAnchor(friction_[j], twist_rad_, anchor_rad_[j]);
  }

  // Goes to a torque without a damper. False, and nothing done, where a kink lies on the way.
  bool GoStraight(double from_Nm, double to_Nm) {
    if (to_Nm == from_Nm) return true;
    Head(to_Nm > from_Nm ? 1.0 : -1.0);
    const double hardening = law_.hardening_Nm_per_rad3;
    double twist_rad = straight_.from_rad + (to_Nm - straight_.from_Nm) / straight_.stiffness_Nm_per_rad;
    if (hardening != 0.0) {
      twist_rad = Solve(twist_rad_, [&](double twist) {
        return Tangent{straight_.Torque_Nm(twist) + model::CubicTorque_Nm(hardening, twist) - to_Nm,
                       straight_.stiffness_Nm_per_rad + model::CubicStiffness_Nm_per_rad(hardening, twist)};
      });
    }
    if (!straight_.Holds(twist_rad)) return false;
    twist_rad_ = twist_rad;
    return true;
  }

  // Goes to a torque with a damper and without a cubic term: in one step, the same way.
  bool GoStraightDamped(double from_Nm, double to_Nm, double step_s) {
    const double way = damper_Nm_ + to_Nm - from_Nm;
    if (law_.hardening_Nm_per_rad3 != 0.0 || !(step_s > 0.0) || way == 0.0) return false;
    Head(way > 0.0 ? 1.0 : -1.0);
    const double stiffness = straight_.stiffness_Nm_per_rad;
    const double end_weight = EndWeightOf(step_s * stiffness / law_.viscous_Nms_per_rad);
    const double damper = law_.viscous_Nms_per_rad / step_s / end_weight;
    const double carried_over_Nm = (1.0 - end_weight) / end_weight * damper_Nm_;
    const double step_rad =
        (to_Nm + carried_over_Nm - straight_.Torque_Nm(twist_rad_)) / (damper + stiffness);
    if (step_rad * way < 0.0 || !straight_.Holds(twist_rad_ + step_rad)) return false;
    twist_rad_ += step_rad;
    damper_Nm_ = damper * step_rad - carried_over_Nm;
    return true;
  }

  // Goes to a torque after `step_s`.
  void TakeTo(double torque_Nm, double step_s) {
    if (law_.viscous_Nms_per_rad > 0.0 && !(step_s > 0.0)) return;  // a damper does not jump
    const double before_rad = twist_rad_;
    double damper = 0.0;
    double carried_over_Nm = 0.0;
    if (law_.viscous_Nms_per_rad > 0.0) {
      const double end_weight =
          EndWeightOf(step_s * Spring(before_rad).stiffness_Nm_per_rad / law_.viscous_Nms_per_rad);
      damper = law_.viscous_Nms_per_rad / step_s / end_weight;
      carried_over_Nm = (1.0 - end_weight) / end_weight * damper_Nm_;
    }
    twist_rad_ = Solve(before_rad, [&](double twist) {
      Tangent at = Spring(twist);
      at.torque_Nm += damper * (twist - before_rad) - torque_Nm - carried_over_Nm;
      at.stiffness_Nm_per_rad += damper;
      for (std::size_t j = 0; j < law_.friction_elements; ++j) {
        const double stuck_Nm = (twist - anchor_rad_[j]) * stiffness_[j];
        const double limit_Nm = friction_[j].limit_Nm;
        if (std::abs(stuck_Nm) < limit_Nm) {
          at.torque_Nm += stuck_Nm;
          at.stiffness_Nm_per_rad += stiffness_[j];
        } else {
          at.torque_Nm += std::copysign(limit_Nm, stuck_Nm);
        }
      }
      return at;
    });
    damper_Nm_ = damper * (twist_rad_ - before_rad) - carried_over_Nm;
    for (std::size_t j = 0; j < law_.friction_elements; ++j) {
      anchor_rad_[j] = model::MovedAnchor(friction_[j], twist_rad_, anchor_rad_[j]);
    }
  }

  // Zero of a rising function; Newton's method, exact in one step where no kink lies between, kept in a
  // bracket.
  template <typename Function>
  static double Solve(double start_rad, const Function& function) {
    constexpr double kTolerance_Nm = 1e-11;
    constexpr int kMostSteps = 60;
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    double x = start_rad;
    for (int step = 0; step < kMostSteps; ++step) {
      const Tangent at = function(x);
      if (std::abs(at.torque_Nm) < kTolerance_Nm) break;
      (at.torque_Nm > 0.0 ? high : low) = x;
      double next = x - at.torque_Nm / at.stiffness_Nm_per_rad;
      if (next == x) break;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      x = next;
    }
    return x;
  }

  const GearLaw& law_;
  double mean_step_s_;
  Side positive_;
  Side negative_;
  std::array<model::ElastoPlasticElement, kFrictionElements> friction_;  // as they are at the torque's rate
  double rate_Nm_per_s_{};
  bool balanced_{true};  // the twist is that of the torque
  std::array<double, kFrictionElements> stiffness_{};
  std::array<double, kFrictionElements> anchor_rad_{};
  double twist_rad_{};
  double damper_Nm_{};
  Straight straight_;
  double decay_{-1.0};
  double end_weight_{};
};

}  // namespace

void FillTwist(const GearLaw& law, const LoopGrid& grid, Eigen::VectorXd& twist_rad) {
  twist_rad.resize(static_cast<Eigen::Index>(grid.size()));
  const bool outside = !law.backlash_beside_friction && law.backlash.width_rad > 0.0;
  double duration_s = 0.0;
  for (std::size_t r = 0; r < grid.records(); ++r)
    duration_s += grid.time_s[grid.starts[r + 1] - 1] - grid.time_s[grid.starts[r]];
  Gear gear(law, std::max(duration_s / static_cast<double>(grid.size()), 1e-300));
  const auto felt_Nm = [&](double torque_Nm, std::size_t rate_at) {
    return torque_Nm - law.torque_offset_Nm - law.torque_lag_s * grid.rate_Nm_per_s[rate_at];
  };
  for (std::size_t r = 0; r < grid.records(); ++r) {
    for (std::size_t i = grid.starts[r]; i < grid.starts[r + 1]; ++i) {
      const double torque_Nm = felt_Nm(grid.torque_Nm[i], i);
      double mean_rate_Nm_per_s = 0.0;
      if (i == grid.starts[r]) {
        gear.StartAt(torque_Nm, law.start_share[r]);
      } else {
        const double before_Nm = felt_Nm(grid.torque_Nm[i - 1], i - 1);
        const double step_s = grid.time_s[i] - grid.time_s[i - 1];
        mean_rate_Nm_per_s = grid.rate_Nm_per_s[i];
        if (std::isnan(grid.turn_Nm[i])) {
          gear.SetRate(grid.rate_Nm_per_s[i]);
          gear.GoTo(before_Nm, torque_Nm, step_s);
        } else {
          const double turn_Nm = felt_Nm(grid.turn_Nm[i], i - 1);
          const double share = grid.turn_share[i];
          mean_rate_Nm_per_s = std::lerp(grid.rate_Nm_per_s[i], grid.rate_Nm_per_s[i - 1], share);
          gear.SetRate(grid.rate_Nm_per_s[i - 1]);
          gear.GoTo(before_Nm, turn_Nm, share * step_s);
          gear.SetRate(grid.rate_Nm_per_s[i]);
          gear.GoTo(turn_Nm, torque_Nm, (1.0 - share) * step_s);
        }
      }
      double twist = gear.twist_rad() - law.lag_rad_s_per_Nm * mean_rate_Nm_per_s;
      if (outside) twist += model::BacklashTwist_rad(law.backlash, torque_Nm);
      twist_rad(static_cast<Eigen::Index>(i)) = twist;
    }
  }
}

}  // namespace strainwave::analysis::diagnosis
