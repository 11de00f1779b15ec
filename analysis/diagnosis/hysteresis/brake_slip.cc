// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/hysteresis/formed_effect.h"
#include "analysis/diagnosis/hysteresis/phases.h"
#include "analysis/model/brake_slip.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// The ways in which a brake lets the input move, as the record's torque (beyond what it holds) drives it.
enum SlipForm { kOneSpeed, kSpeedOfExcess, kEachTime, kOnlyFurther, kOneJump };

// Further numbers: balance between the two directions of torque, −1 to 1 (1: slips under positive torque
// alone), and 1 where a fit moves it.
class BrakeSlip final : public FormedEffect {
 public:
  explicit BrakeSlip(const LoopRecords& records)
      : FormedEffect(records,
                     {{"slip_arcmin_per_s", "arcmin/s", 1.0},
                      {"slip_arcmin_per_Nms", "arcmin/(Nm s)", 1.0},
                      {"slip_each_time_arcmin_per_Nm", "arcmin/Nm", 1.0},
                      {"slip_arcmin_per_Nm", "arcmin/Nm", 1.0},
                      {"slip_arcmin", "arcmin", 1.0}},
                     "slip_rms_arcmin", "slip_torque_Nm", "Nm"),
        peak_Nm_(records.peak_torque_Nm) {
    const double range_arcmin = ArcminFromRad(records.twist_range_rad);
    rule = {.name = "brake_slip",
            .sentence =
                "the locked input moves beyond a torque level and does not come back: the holding brake "
                "slips (put a "
                "mark or a second encoder on the motor shaft; adjust or replace the brake)",
            .where = Where::kBench,
            .effect = "E17",
            .parameters = {{"slip_torque_Nm", "Nm", 0.3 * peak_Nm_, peak_Nm_, false},
                           {"slip_balance", "1", -1.0, 1.0, false}},
            .degrees_of_freedom = 2,
            .trials = 15.0,
            .to_settle = fmt::format(
                "# loops below the torque at which the angle stayed behind, then beyond it\n{}{}",
                PhaseText(records, {.name = "below"}),
                PhaseText(records, {.name = "beyond", .peak_share = 1.3, .hold_s = 20.0, .loops = 2}))};
    for (const Form& form : forms_)
      rule.parameters.push_back({form.name, form.unit, 0.0, 100.0 * range_arcmin, false});
    rule.parameters.push_back({size_name_, "arcmin", 0.0, 3.0 * range_arcmin, true});
    numbers = {{0.0, 4.0, 0.0, true, false},
               {0.0, 100.0 * range_arcmin, 1e-6 * range_arcmin, false, true},
               {std::log(0.3 * peak_Nm_), std::log(0.998 * peak_Nm_), 1e-4, false, false},
               {-1.0, 1.0, 1e-5, false, false},
               {0.0, 1.0, 0.0, true, false}};
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    if (v[1] == 0.0) return;
    const double amount_rad = RadFromArcmin(v[1]);
    const double holding_Nm = std::exp(v[2]);
    const auto form = static_cast<SlipForm>(std::lround(v[0]));
    for (std::size_t r = 0; r < grid.records(); ++r) {
      double slip = 0.0;
      Furthest furthest;
      for (std::size_t i = grid.starts[r] + 1; i < grid.starts[r + 1]; ++i) {
        const double from_Nm = grid.torque_Nm[i - 1];
        const double to_Nm = grid.torque_Nm[i];
        if (std::max(std::abs(from_Nm), std::abs(to_Nm)) > holding_Nm) {
          const double step =
              Step(form, from_Nm, to_Nm, holding_Nm, grid.time_s[i] - grid.time_s[i - 1], furthest);
          slip += (step > 0.0 ? 1.0 + v[3] : 1.0 - v[3]) * step;
        }
        total_rad(static_cast<Eigen::Index>(i)) += amount_rad * slip;
      }
    }
  }

  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    return FormedEffect::IsHeld(v, k) || k == 4 || (k == 3 && v[4] < 0.5);
  }

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    std::vector<ParameterValue> described = FormedEffect::Describe(v, covariance);
    described.push_back({"slip_balance", "1", v[3], v[4] < 0.5 ? 0.0 : ErrorsOf(covariance)[3]});
    return described;
  }

  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v = FormedEffect::Restore(parameters);
    const double* balance = FindParameter(parameters, "slip_balance");
    v.push_back(balance == nullptr ? 0.0 : *balance);
    v.push_back(0.0);
    return v;
  }

  std::vector<std::vector<double>> Starts(const LoopRemainder&) const override {
    std::vector<std::vector<double>> starts;
    for (int form = 0; form < static_cast<int>(forms_.size()); ++form) {
      for (const double share : {0.4, 0.6, 0.75, 0.87, 0.95}) {
        for (const double balance : {0.0, 1.0, -1.0}) {
          starts.push_back({static_cast<double>(form), 0.0, std::log(share * peak_Nm_), balance, 0.0});
        }
      }
    }
    return starts;
  }

  std::vector<std::vector<double>> RicherForms(std::span<const double> v,
                                               const LoopRemainder&) const override {
    std::vector<double> richer(v.begin(), v.end());
    richer[3] = std::clamp(richer[3], -0.5, 0.5);
    richer[4] = 1.0;
    return {richer};
  }

 private:
  // Largest excess so far under torque of either sign.
  struct Furthest {
    double positive_Nm{};
    double negative_Nm{};
  };

  static double Step(SlipForm form, double from_Nm, double to_Nm, double holding_Nm, double step_s,
                     Furthest& furthest) {
    const model::BeyondHolding beyond = model::StepBeyond(from_Nm, to_Nm, holding_Nm, step_s);
    const double begin_Nm = std::abs(model::TorqueBeyond_Nm(from_Nm, holding_Nm));
    const double end_Nm = std::abs(model::TorqueBeyond_Nm(to_Nm, holding_Nm));
    const double sign = to_Nm < 0.0 ? -1.0 : 1.0;
    double& furthest_Nm = to_Nm < 0.0 ? furthest.negative_Nm : furthest.positive_Nm;
    const double before_Nm = furthest_Nm;
    furthest_Nm = std::max(furthest_Nm, end_Nm);
    switch (form) {
      case kOneSpeed:
        return beyond.time_s;
      case kSpeedOfExcess:
        return beyond.impulse_Nms;
      case kEachTime:
        return sign * std::max(0.0, end_Nm - begin_Nm);
      case kOnlyFurther:
        return sign * (furthest_Nm - before_Nm);
      case kOneJump: {
        // Spread over a hundredth of the level, so that the fit can move it.
        const double spread_Nm = 0.01 * holding_Nm;
        return sign * (std::min(furthest_Nm / spread_Nm, 1.0) - std::min(before_Nm / spread_Nm, 1.0));
      }
    }
    return 0.0;
  }

  double peak_Nm_;
};

}  // namespace

void AppendBrakeSlip(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<BrakeSlip>(records));
}

}  // namespace strainwave::analysis::diagnosis
