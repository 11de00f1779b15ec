// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>

/// What is measured of a reducer: one table that database, JSON, text and pictures read.
namespace strainwave::analysis {

/// As the name of a quantity ends in it, and as people write it.
struct QuantityUnit {
  std::string_view in_names;
  std::string_view symbol;
  int width{8};     // of a column of text
  int decimals{3};  // in it
};

// The longer ones first: "Nm_per_rad" ends in "rad".
inline constexpr QuantityUnit kQuantityUnits[] = {{"Nm_per_rad", "Nm/rad", 10, 0},
                                                  {"m_per_s2", "m/s2"},
                                                  {"arcmin", "arcmin"},
                                                  {"arcsec", "arcsec"},
                                                  {"percent", "%"},
                                                  {"degC", "degC", 7, 1},
                                                  {"Nms", "Nms"},
                                                  {"ppm", "ppm"},
                                                  {"Nm", "Nm"},
                                                  {"rad", "rad"},
                                                  {"deg", "deg"},
                                                  {"mm", "mm"},
                                                  {"rpm", "rpm"},
                                                  {"Hz", "Hz"},
                                                  {"us", "us"},
                                                  {"W", "W"},
                                                  {"s", "s"},
                                                  {"K", "K"}};

/// Null where the name has no unit, or nothing before it.
constexpr const QuantityUnit* FindUnit(std::string_view name) {
  for (const QuantityUnit& unit : kQuantityUnits) {
    if (name.size() <= unit.in_names.size() + 1 || !name.ends_with(unit.in_names)) continue;
    if (name[name.size() - unit.in_names.size() - 1] == '_') return &unit;
  }
  return nullptr;
}

/// "Nm/rad" of "k1_Nm_per_rad"; empty where the name has no unit.
constexpr std::string_view UnitOf(std::string_view name) {
  const QuantityUnit* const unit = FindUnit(name);
  return unit == nullptr ? std::string_view() : unit->symbol;
}

/// "k1" of "k1_Nm_per_rad".
constexpr std::string_view WithoutUnit(std::string_view name) {
  const QuantityUnit* const unit = FindUnit(name);
  return unit == nullptr ? name : name.substr(0, name.size() - unit->in_names.size() - 1);
}

struct Quantity {
  std::string_view name;     // in database, JSON and metadata; ends in its unit
  std::string_view symbol;   // in text; empty: the unit says it
  std::string_view title;    // in pictures
  std::string_view meaning;  // in words

  constexpr const QuantityUnit& units() const { return *FindUnit(name); }
  constexpr std::string_view unit() const { return units().symbol; }
};

namespace quantities {

// Transmission error, clockwise where nothing else is said (docs/contract.md#transmission-error).
inline constexpr Quantity kEAvg{"e_avg_arcmin", "e_avg", "e_avg", "mean error over a turn"};
inline constexpr Quantity kEMax{"e_max_arcmin", "e_max", "e_max", "largest less smallest error"};
inline constexpr Quantity kEAvgCcw{"e_avg_ccw_arcmin", "e_avg ccw", "e_avg_ccw",
                                   "mean error over a turn counter-clockwise"};
inline constexpr Quantity kEMaxCcw{"e_max_ccw_arcmin", "e_max ccw", "e_max_ccw",
                                   "largest less smallest error counter-clockwise"};
inline constexpr Quantity kLostMotion{"lost_motion_arcmin", "lost", "lost_motion",
                                      "difference between the directions"};
inline constexpr Quantity kEncoderSkew{"encoder_skew_us", "skew", "encoder_skew",
                                       "by how much the output encoder is read later"};

// Lock test (docs/contract.md#stiffness).
inline constexpr Quantity kK1{"k1_Nm_per_rad", "K1", "K₁", "stiffness up to T1"};
inline constexpr Quantity kK2{"k2_Nm_per_rad", "K2", "K₂", "stiffness from T1 to T2"};
inline constexpr Quantity kK3{"k3_Nm_per_rad", "K3", "K₃", "stiffness above T2"};
inline constexpr Quantity kHysteresis{"hysteresis_arcmin", "hyst", "hysteresis",
                                      "width of the loop at zero torque"};
inline constexpr Quantity kHysteresisLostMotion{"hysteresis_lost_motion_arcmin", "lost of loop",
                                                "hysteresis_lost_motion",
                                                "width of the loop's mid-line at ±4 % of the rated torque"};
inline constexpr Quantity kFrictionTorque{"friction_torque_Nm", "friction", "friction_torque",
                                          "friction beside the spring"};
inline constexpr Quantity kYieldTwist{"yield_twist_arcmin", "yield", "yield_twist",
                                      "twist at which the friction slides"};
inline constexpr Quantity kStiffnessResidual{"rms_residual_Nm", "residual", "rms_residual",
                                             "RMS of the torque less that of the fitted loop"};
inline constexpr Quantity kGearTemperature{"gear_temperature_degC", "", "gear_temperature",
                                           "temperature of the gear"};

// Measurement rotation.
inline constexpr Quantity kEfficiency{"efficiency_percent", "efficiency", "efficiency",
                                      "power at the output over that at the input"};
inline constexpr Quantity kStartingTorque{"starting_torque_Nm", "starting", "starting_torque",
                                          "torque at which the unloaded input breaks away"};

}  // namespace quantities

inline constexpr std::array kQuantities{quantities::kEAvg,
                                        quantities::kEMax,
                                        quantities::kEAvgCcw,
                                        quantities::kEMaxCcw,
                                        quantities::kLostMotion,
                                        quantities::kEncoderSkew,
                                        quantities::kK1,
                                        quantities::kK2,
                                        quantities::kK3,
                                        quantities::kHysteresis,
                                        quantities::kHysteresisLostMotion,
                                        quantities::kFrictionTorque,
                                        quantities::kYieldTwist,
                                        quantities::kStiffnessResidual,
                                        quantities::kGearTemperature,
                                        quantities::kEfficiency,
                                        quantities::kStartingTorque};

/// Of a measurement rotation each accelerometer's, whose name and unit follow:
/// "vibration_rms_accel_x_m_per_s2".
inline constexpr std::string_view kVibrationRms = "vibration_rms_";

inline constexpr std::array kStiffnesses{quantities::kK1, quantities::kK2, quantities::kK3};

/// Those that a predictor may learn from vibration.
inline constexpr std::array kPredictedQuantities{quantities::kEMax, quantities::kEAvg, quantities::kK1,
                                                 quantities::kK2, quantities::kK3};

/// What it is called where several methods give it: "k1_loading_Nm_per_rad" of "k1_Nm_per_rad" and "loading".
inline std::string NameByMethod(const Quantity& quantity, std::string_view method) {
  const std::string_view stem = WithoutUnit(quantity.name);
  return std::string(stem).append("_").append(method).append(quantity.name.substr(stem.size()));
}

/// Null for a name that is not in the table.
constexpr const Quantity* FindQuantity(std::string_view name) {
  const auto* const found = std::ranges::find(kQuantities, name, &Quantity::name);
  return found == std::end(kQuantities) ? nullptr : found;
}

/// "K1, K2, K3" of `&Quantity::symbol`.
template <std::size_t count>
std::string Listed(const std::array<Quantity, count>& of, std::string_view Quantity::*member) {
  std::string text;
  for (const Quantity& quantity : of) text.append(text.empty() ? "" : ", ").append(quantity.*member);
  return text;
}

}  // namespace strainwave::analysis
