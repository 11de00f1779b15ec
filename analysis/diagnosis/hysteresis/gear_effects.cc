// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/hysteresis/effects.h"
#include "analysis/diagnosis/hysteresis/law_number.h"
#include "analysis/diagnosis/hysteresis/phases.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Where the play lies, and how its flanks meet.
enum PlayForm { kOutside, kBesideFriction, kOutsideRounded };

// Numbers: form; width in arcmin; ln of the torque at the zone's ends.
class BacklashEffect final : public LoopEffect {
 public:
  explicit BacklashEffect(const LoopRecords& records) : start_torque_Nm_(0.02 * records.t1_Nm) {
    const double range_arcmin = ArcminFromRad(records.twist_range_rad);
    const double least_Nm = 1e-3 * records.t1_Nm;
    const double most_Nm = 0.15 * records.t1_Nm;
    rule = {
        .name = "backlash",
        .what_to_do = "move the encoder to the gear's own flange: play of a key or a coupling is gone there",
        .sentence =
            "a dead zone about zero torque, in which the output turns with next to no stiffness: worn teeth "
            "or a loose key or coupling",
        .where = Where::kUnit,
        .effect = "E4",
        .parameters = {{"backlash_arcmin", "arcmin", 0.0, 0.6 * range_arcmin, true},
                       {"dead_zone_torque_Nm", "Nm", 0.0, 1.001 * most_Nm, false},
                       {"beside_friction", "1", 0.0, 1.0, false}},
        .degrees_of_freedom = 2,
        .trials_factor = 6.0,
        .to_settle = TwoAngles(records)};
    numbers = {{kOutside, kOutsideRounded, 0.0, true, false},
               {0.0, 0.8 * range_arcmin, 1e-5 * range_arcmin, false, true},
               {std::log(least_Nm), std::log(most_Nm), 1e-4, false, false}};
    shapes_gear = true;
    needs_all_samples = true;
  }

  void ShapeGear(std::span<const double> v, GearLaw& law) const override {
    const auto form = static_cast<PlayForm>(std::lround(v[0]));
    law.backlash_beside_friction = form == kBesideFriction;
    law.backlash = {RadFromArcmin(v[1]), std::exp(v[2]), form == kOutsideRounded};
  }
  std::vector<std::vector<double>> Starts(const LoopResidual&) const override {
    const double start = std::log(start_torque_Nm_);
    return {{kOutside, 0.0, start}, {kBesideFriction, 0.0, start}, {kOutsideRounded, 0.0, start}};
  }
  // A fit does not come from a zone that fades away to one with sharp ends.
  std::vector<std::vector<double>> RicherForms(std::span<const double> v,
                                               const LoopResidual&) const override {
    return {{v[0], v[1], numbers[2].low}};
  }
  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    const std::vector<double> se = ErrorsOf(covariance);
    const double torque_Nm = std::exp(v[2]);
    return {{"backlash_arcmin", "arcmin", v[1], se[1]},
            {"dead_zone_torque_Nm", "Nm", torque_Nm, torque_Nm * se[2]},
            {"beside_friction", "1", std::lround(v[0]) == kBesideFriction ? 1.0 : 0.0, 0.0},
            {"rounded", "1", std::lround(v[0]) == kOutsideRounded ? 1.0 : 0.0, 0.0}};
  }
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    const double* torque_Nm = FindParameter(parameters, "dead_zone_torque_Nm");
    const double* beside = FindParameter(parameters, "beside_friction");
    const double* rounded = FindParameter(parameters, "rounded");
    const auto is_set = [](const double* flag) { return flag != nullptr && *flag > 0.5; };
    const PlayForm form = is_set(beside) ? kBesideFriction : is_set(rounded) ? kOutsideRounded : kOutside;
    return {static_cast<double>(form), RequireParameter(rule, parameters, "backlash_arcmin"),
            std::log(torque_Nm == nullptr ? start_torque_Nm_ : std::max(*torque_Nm, 1e-6))};
  }

 private:
  double start_torque_Nm_;
};

}  // namespace

void AppendGearEffects(const LoopRecords& records, LoopEffects& effects) {
  const double half_range_rad = 0.5 * records.twist_range_rad;
  const double peak_Nm = records.peak_torque_Nm;
  effects.push_back(std::make_unique<BacklashEffect>(records));

  CauseRule asymmetry{
      .name = "asymmetric_stiffness",
      .what_to_do = "measure how the mount itself bends, and repeat the loop at another lock angle",
      .sentence =
          "the gear is stiffer under torque of one sign: teeth that bear on one flank first, a "
          "flexspline that was overloaded one way; a mount that bends one way looks the same",
      .where = Where::kUnit,
      .effect = "E5",
      .degrees_of_freedom = 1,
      .trials_factor = 6.0,
      .to_settle = TwoAngles(records)};
  const auto of_segments = [](const char* name, std::vector<std::size_t> segments) {
    return LawForm{name, "1", -0.5, 0.5, [segments = std::move(segments)](double share, GearLaw& law) {
                     for (const std::size_t segment : segments) law.asymmetry_share[segment] = share;
                   }};
  };
  const LawForm of_law{"law_asymmetry_share", "1", -0.5, 0.5, [](double share, GearLaw& law) {
                         law.asymmetry_share.fill(share);
                         law.knees_at_twist = true;
                       }};
  std::vector<LawForm> asymmetries{
      of_segments("asymmetry_share", {0, 1, 2}),    of_segments("k1_asymmetry_share", {0}),
      of_segments("k2_asymmetry_share", {1}),       of_segments("k3_asymmetry_share", {2}),
      of_segments("k2_k3_asymmetry_share", {1, 2}), of_law};
  effects.push_back(std::make_unique<LawNumber>(std::move(asymmetry), std::move(asymmetries)));

  const double hardest = 0.8 * peak_Nm / (half_range_rad * half_range_rad * half_range_rad);
  CauseRule hardening{
      .name = "cubic_hardening",
      .what_to_do = "run the extended model in place of K1 to K3 near the peak torque",
      .sentence =
          "stiffness rises smoothly with the twist, beyond K1 to K3: more teeth come to bear as "
          "the flexspline winds up",
      .where = Where::kUnit,
      .effect = "E5",
      .degrees_of_freedom = 1,
      .to_settle = fmt::format("# further out, where the gear allows it\n{}",
                               PhaseText(records, {.name = "further", .peak_share = 1.4}))};
  const LawForm cubic{"hardening_Nm_per_rad3", "Nm/rad3", 0.0, hardest,
                      [](double amount, GearLaw& law) { law.hardening_Nm_per_rad3 = amount; }};
  effects.push_back(std::make_unique<LawNumber>(std::move(hardening), std::vector{cubic}));

  const double most_offset_Nm = 0.3 * records.t3_Nm;
  CauseRule offset{
      .name = "torque_zero_offset",
      .what_to_do = "zero the transducer unloaded, with couplings loose, and repeat the loop",
      .sentence =
          "the torque signal is shifted: the transducer was not zeroed, or something hangs on the "
          "output",
      .where = Where::kBench,
      .effect = "",
      .degrees_of_freedom = 1,
      .to_settle = fmt::format("# with the torque signal zeroed on the unloaded output\n{}",
                               PhaseText(records, {.name = "zeroed"}))};
  const LawForm shifted{"offset_Nm", "Nm", -most_offset_Nm, most_offset_Nm,
                        [](double offset_Nm, GearLaw& law) { law.torque_offset_Nm = offset_Nm; }};
  effects.push_back(std::make_unique<LawNumber>(std::move(offset), std::vector{shifted}));

  AppendDistributedFriction(records, effects);

  AppendRateDependence(records, effects);
}

}  // namespace strainwave::analysis::diagnosis
