// SPDX-License-Identifier: Apache-2.0
#include "analysis/bearing_life.h"

#include <cmath>

#include "analysis/arguments.h"

namespace strainwave::analysis {
namespace {

void RequireRating(const GearRating& rating) {
  RequirePositive("rated_torque_Nm", rating.rated_torque_Nm);
  RequirePositive("rated_speed_rad_per_s", rating.rated_speed_rad_per_s);
  RequirePositive("l10_s", rating.l10_s);
  RequirePositive("ratcheting_torque_Nm", rating.ratcheting_torque_Nm);
  RequirePositive("buckling_torque_Nm", rating.buckling_torque_Nm);
}

void RequireBlock(const LoadBlock& block) {
  RequireFinite("output_torque_Nm", block.output_torque_Nm);
  RequireFinite("input_speed_rad_per_s", block.input_speed_rad_per_s);
  RequireNotNegative("duration_s", block.duration_s);
}

}  // namespace

double LifeAtLoad_s(const GearRating& rating, double output_torque_Nm, double input_speed_rad_per_s) {
  RequireRating(rating);
  RequireFinite("output_torque_Nm", output_torque_Nm);
  RequireFinite("input_speed_rad_per_s", input_speed_rad_per_s);
  const double torque_share = rating.rated_torque_Nm / std::abs(output_torque_Nm);
  const double speed_share = rating.rated_speed_rad_per_s / std::abs(input_speed_rad_per_s);
  return rating.l10_s * torque_share * torque_share * torque_share * speed_share;
}

double AverageTorque_Nm(std::span<const LoadBlock> blocks) {
  double wear = 0.0;
  double angle_rad = 0.0;
  for (const LoadBlock& block : blocks) {
    RequireBlock(block);
    const double turned_rad = std::abs(block.input_speed_rad_per_s) * block.duration_s;
    const double torque_Nm = std::abs(block.output_torque_Nm);
    wear += turned_rad * torque_Nm * torque_Nm * torque_Nm;
    angle_rad += turned_rad;
  }
  return angle_rad > 0.0 ? std::cbrt(wear / angle_rad) : 0.0;
}

double AverageSpeed_rad_per_s(std::span<const LoadBlock> blocks) {
  double angle_rad = 0.0;
  double time_s = 0.0;
  for (const LoadBlock& block : blocks) {
    RequireBlock(block);
    angle_rad += std::abs(block.input_speed_rad_per_s) * block.duration_s;
    time_s += block.duration_s;
  }
  return time_s > 0.0 ? angle_rad / time_s : 0.0;
}

double LifeConsumed(const GearRating& rating, std::span<const LoadBlock> blocks) {
  double consumed = 0.0;
  for (const LoadBlock& block : blocks) {
    RequireBlock(block);
    consumed += block.duration_s / LifeAtLoad_s(rating, block.output_torque_Nm, block.input_speed_rad_per_s);
  }
  return consumed;
}

OverloadMargins MarginsAtPeak(const GearRating& rating, double peak_output_torque_Nm) {
  RequireRating(rating);
  RequireFinite("peak_output_torque_Nm", peak_output_torque_Nm);
  const double peak_Nm = std::abs(peak_output_torque_Nm);
  return {rating.ratcheting_torque_Nm / peak_Nm, rating.buckling_torque_Nm / peak_Nm};
}

}  // namespace strainwave::analysis
