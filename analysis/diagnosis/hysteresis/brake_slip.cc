// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analysis/diagnosis/hysteresis/formed_effect.h"
#include "analysis/diagnosis/hysteresis/phases.h"
#include "analysis/model/brake_slip.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kJumpSpread = 0.01;  // of the level
constexpr double kRarer = 10.0;       // forms than the usual one
constexpr double kLeastShare = 0.3;   // of the peak: where a brake may begin to slip

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
            .what_to_do = "put a mark or a second encoder on the motor shaft; adjust or replace the brake",
            .sentence =
                "the locked input moves beyond a torque level and does not come back: the holding brake "
                "slips",
            .where = Where::kBench,
            .effect = "E17",
            // A level at which a fit stops since its range begins there is within it, however its logarithm
            // was rounded.
            .parameters = {{"slip_torque_Nm", "Nm", 0.999 * kLeastShare * peak_Nm_, peak_Nm_, false},
                           {"slip_balance", "1", -1.0, 1.0, false}},
            .degrees_of_freedom = 2,
            .trials_factor = 6.0,
            .to_settle = fmt::format(
                "# loops below the torque at which the angle stayed behind, then beyond it\n{}{}",
                PhaseText(records, {.name = "below"}),
                PhaseText(records, {.name = "beyond", .peak_share = 1.3, .hold_s = 20.0, .loops = 2}))};
    for (const Form& form : forms_)
      rule.parameters.push_back({form.name, form.unit, 0.0, 100.0 * range_arcmin, false});
    rule.parameters.push_back({size_name_, "arcmin", 0.0, 3.0 * range_arcmin, true});
    numbers = {{0.0, 4.0, 0.0, true, false},
               {0.0, 100.0 * range_arcmin, 1e-6 * range_arcmin, false, true},
               {std::log(kLeastShare * peak_Nm_), std::log(0.998 * peak_Nm_), 1e-4, false, false},
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

  // A brake that is loaded beyond what it holds turns the faster the more it is: its friction grows with
  // speed. The other forms are rarer.
  double LogSearchLocations(std::span<const double> v) const override {
    return std::lround(v[0]) == kSpeedOfExcess ? 0.0 : std::log(kRarer);
  }

  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    return FormedEffect::IsHeld(v, k) || k == 4 || (k == 3 && v[4] < 0.5);
  }

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    std::vector<ParameterValue> described = FormedEffect::Describe(v, covariance);
    // Under torque of the sign that slips more.
    const double larger = 1.0 + std::abs(v[3]);
    described.front().value *= larger;
    described.front().standard_error *= larger;
    described.push_back({"slip_balance", "1", v[3], v[4] < 0.5 ? 0.0 : ErrorsOf(covariance)[3]});
    return described;
  }

  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v = FormedEffect::Restore(parameters);
    const double* balance = FindParameter(parameters, "slip_balance");
    v.push_back(balance == nullptr ? 0.0 : *balance);
    v[1] /= 1.0 + std::abs(v[3]);
    v.push_back(0.0);
    return v;
  }

  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override {
    std::vector<std::vector<double>> starts;
    for (const double side : {1.0, -1.0}) {
      for (const double level_Nm : LevelsOfJump_Nm(residual, side))
        starts.push_back({kOneJump, 0.0, std::log(level_Nm), side, 0.0});
    }
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
                                               const LoopResidual&) const override {
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

  // Torques at which a jump, once one is reached for the first time under torque of this sign, takes most off
  // the residual: off all of it, and off the points next to it, where a model without the jump has not bent
  // to follow it. A fit does not find it from afar: beside the level nothing says which way to go.
  std::vector<double> LevelsOfJump_Nm(const LoopResidual& residual, double side) const {
    struct JumpAt {
      double gain{};
      double level_Nm{};
    };
    JumpAt far;
    std::vector<JumpAt> near;
    const LoopGrid& grid = residual.grid;
    for (std::size_t r = 0; r < grid.records(); ++r) {
      const std::size_t first = grid.starts[r];
      const std::size_t end = grid.starts[r + 1];
      // Weights and weighted residuals up to each point.
      std::vector<double> weight{0.0};
      std::vector<double> sum{0.0};
      for (std::size_t i = first; i < end; ++i) {
        weight.push_back(weight.back() + grid.weight[i]);
        sum.push_back(sum.back() + grid.weight[i] * residual.residual_rad[i]);
      }
      // Of a step before point i, between points a and b.
      const auto gain_of = [&](std::size_t a, std::size_t i, std::size_t b) {
        const double before = weight[i] - weight[a];
        const double after = weight[b] - weight[i];
        if (!(before > 0.0) || !(after > 0.0)) return 0.0;
        const double step = (sum[b] - sum[i]) / after - (sum[i] - sum[a]) / before;
        return step * step * before * after / (before + after);
      };
      const std::size_t count = end - first;
      const std::size_t reach = std::max<std::size_t>(5, count / 100);
      double furthest_Nm = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        const double torque_Nm = side * grid.torque_Nm[first + i];
        if (!(torque_Nm > furthest_Nm)) continue;
        const double level_Nm = std::max(furthest_Nm, torque_Nm / (1.0 + 0.5 * kJumpSpread));
        furthest_Nm = torque_Nm;
        if (level_Nm < kLeastShare * peak_Nm_ || level_Nm > 0.998 * peak_Nm_) continue;
        const double of_all = gain_of(0, i, count);
        const double of_next = gain_of(i - std::min(i, reach), i, std::min(i + reach, count));
        if (of_all > far.gain) far = {of_all, level_Nm};
        near.push_back({of_next, level_Nm});
      }
    }
    constexpr std::size_t kMostNear = 4;
    constexpr double kApart = 0.02;  // of the level: neighbours show the same step
    std::vector<double> levels_Nm;
    if (far.gain > 0.0) levels_Nm.push_back(far.level_Nm);
    std::ranges::stable_sort(near, std::greater<>(), &JumpAt::gain);
    for (const JumpAt& step : near) {
      if (levels_Nm.size() > kMostNear) break;
      if (std::ranges::all_of(levels_Nm, [&](double level_Nm) {
            return std::abs(level_Nm - step.level_Nm) > kApart * level_Nm;
          }))
        levels_Nm.push_back(step.level_Nm);
    }
    return levels_Nm;
  }

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
        // Spread over a share of the level, so that the fit can move it.
        const double spread_Nm = kJumpSpread * holding_Nm;
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
