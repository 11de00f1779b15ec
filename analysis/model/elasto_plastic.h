// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "analysis/model/torsion_spring.h"

namespace strainwave::analysis::model {

/// Elasto-plastic friction (one Jenkins element): a spring that slips at ±`limit_Nm`. It is the gear's own
/// hysteresis beside the torsion spring (docs/effects.md E6), presliding at the input (E12), and the drag of
/// the load train. Its one state is the anchor: the deflection at which it carries nothing.
struct ElastoPlasticElement {
  double limit_Nm{};
  double yield_rad{};  // deflection from the anchor at which it slips; > 0

  double stiffness_Nm_per_rad() const noexcept { return limit_Nm / yield_rad; }
};

/// Torque at a deflection; does not move the anchor.
inline double ElementTorque(const ElastoPlasticElement& element, double deflection_rad,
                            double anchor_rad) noexcept {
  return std::clamp((deflection_rad - anchor_rad) * element.stiffness_Nm_per_rad(), -element.limit_Nm,
                    element.limit_Nm);
}

/// The anchor after the deflection has come here: dragged along where the element slips.
inline double MovedAnchor(const ElastoPlasticElement& element, double deflection_rad,
                          double anchor_rad) noexcept {
  return std::clamp(anchor_rad, deflection_rad - element.yield_rad, deflection_rad + element.yield_rad);
}

/// Width of the loop at zero torque of a spring with the element in parallel, for loops that slip both ways.
inline double HysteresisWidth_rad(const TorsionSpring& spring, const ElastoPlasticElement& element) noexcept {
  return 2.0 * SpringTwist(spring, element.limit_Nm);
}

}  // namespace strainwave::analysis::model
