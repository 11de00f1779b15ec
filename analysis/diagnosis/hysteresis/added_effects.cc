// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/hysteresis/formed_effect.h"
#include "analysis/diagnosis/hysteresis/phases.h"
#include "analysis/model/creep_chain.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// What settles in less of a loop's time is the torque rate's doing, as any record without a hold shows it.
constexpr double kShortestShare = 0.01;
// A logarithmic law, or a band, begins where its parts are as short as that: its onset is earlier by as much.
constexpr double kOnset = 0.1;

// Logarithmic or exponential, of the gear's wind-up with all its bends and friction (docs/effects.md E22) or
// of a part that yields in proportion to the torque (a glued joint, the mount). A band lies between: a box
// spectrum of time constants (Neubert, Aeronaut. Q. 14 (1963) 187).
enum CreepForm { kLogOfTwist, kOneOfTwist, kLogOfTorque, kOneOfTorque, kBandOfTwist, kBandOfTorque };

bool IsLogarithmic(CreepForm form) { return form == kLogOfTwist || form == kLogOfTorque; }
bool IsBand(CreepForm form) { return form == kBandOfTwist || form == kBandOfTorque; }
bool IsOfTorque(CreepForm form) {
  return form == kLogOfTorque || form == kOneOfTorque || form == kBandOfTorque;
}

// Further number: ln of a band's longest time constant; its shape is that of the shortest.
class CreepEffect final : public FormedEffect {
 public:
  explicit CreepEffect(const LoopRecords& records)
      : FormedEffect(records, FormsOf(records), "creep_rms_arcmin", "time_constant_s", "s"),
        shortest_s_(
            std::max(2.0 * records.step_s, kShortestShare * 2.0 * records.duration_s / records.passes())),
        longest_s_(0.6 * records.duration_s),
        duration_s_(records.duration_s) {
    const double range_arcmin = ArcminFromRad(records.twist_range_rad);
    rule = {
        .name = "creep",
        .what_to_do =
            "hold the torque, then take it off and wait: what comes back is the gear's, what stays the "
            "brake's",
        .sentence =
            "twist goes on at constant torque: after-effect of the flexspline or of glued joints; a brake "
            "that gives way slowly looks the same within one loop",
        .where = Where::kUnit,
        .effect = "E22",
        .parameters = {{"creep_share_per_decade", "1", 0.0, kMostPerDecade, false},
                       {"creep_share", "1", 0.0, kMost, false},
                       {"creep_arcmin_per_Nm_per_decade", "arcmin/Nm", 0.0,
                        kMostPerDecade * ArcminFromRad(records.compliance_rad_per_Nm()), false},
                       {"creep_arcmin_per_Nm", "arcmin/Nm", 0.0,
                        kMost * ArcminFromRad(records.compliance_rad_per_Nm()), false},
                       {"creep_rms_arcmin", "arcmin", 0.0, range_arcmin, true},
                       {"time_constant_s", "s", 0.0, 1.01 * longest_s_, false}},
        .degrees_of_freedom = 2,
        .trials_factor = 4.0,
        .to_settle = fmt::format(
            "# long holds at each end\n{}",
            PhaseText(records, {.name = "holds", .torque_rate_Nm_per_s = 3.0, .hold_s = 120.0, .loops = 2}))};
    numbers = {{kLogOfTwist, kBandOfTorque, 0.0, true, false},
               {0.0, 1.0, 1e-6, false, true},
               {std::log(shortest_s_), std::log(longest_s_), 1e-4, false, false},
               {std::log(shortest_s_), std::log(kLongestOfBand * duration_s_), 1e-4, false, false}};
    follows_gear = true;
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd& gear_rad,
           Eigen::VectorXd& total_rad) const override {
    if (v[1] == 0.0) return;
    const CreepForm form = FormOf(v);
    const double time_s = forms_[form].nonlinear_parameter_per_number * std::exp(v[2]);
    const model::CreepChain chain = IsBand(form)          ? model::BandOfCreep(time_s, std::exp(v[3]))
                                    : IsLogarithmic(form) ? model::LogarithmicCreep(time_s, duration_s_)
                                                          : model::ExponentialCreep(time_s);
    const bool of_torque = IsOfTorque(form);
    const double straight_rad_per_Nm = records_.compliance_rad_per_Nm();
    const auto driver_rad = [&](std::size_t i) {
      return of_torque ? straight_rad_per_Nm * grid.torque_Nm[i] : gear_rad(static_cast<Eigen::Index>(i));
    };
    std::vector<model::ElementStep> steps(chain.elements.size());
    std::vector<double> state(chain.elements.size());
    for (std::size_t r = 0; r < grid.records(); ++r) {
      // At rest at the first sample's twist, whatever that came from: the rest is in the record's offset.
      std::fill(state.begin(), state.end(), 0.0);
      double last_step_s = -1.0;
      const double rest_rad = driver_rad(grid.starts[r]);
      for (std::size_t i = grid.starts[r] + 1; i < grid.starts[r + 1]; ++i) {
        const double step_s = grid.time_s[i] - grid.time_s[i - 1];
        // Equal steps share their exponentials.
        if (!(std::abs(step_s - last_step_s) <= 1e-3 * step_s)) {
          last_step_s = step_s;
          for (std::size_t k = 0; k < steps.size(); ++k) {
            steps[k] = model::StepOf(chain.elements[k].time_constant_s, step_s);
          }
        }
        const double from = driver_rad(i - 1) - rest_rad;
        const double to = driver_rad(i) - rest_rad;
        double sum = 0.0;
        for (std::size_t k = 0; k < steps.size(); ++k) {
          state[k] = model::AdvanceElement(steps[k], state[k], from, to);
          sum += chain.elements[k].weight * state[k];
        }
        total_rad(static_cast<Eigen::Index>(i)) += v[1] * sum;
      }
    }
  }

  std::vector<std::vector<double>> Starts(const LoopResidual&) const override {
    std::vector<std::vector<double>> starts;
    for (const CreepForm form : {kLogOfTwist, kOneOfTwist, kLogOfTorque, kOneOfTorque}) {
      // One time constant alone is sharper than a whole chain of them.
      const int starts_of_form = IsLogarithmic(form) ? 5 : 15;
      for (int k = 0; k < starts_of_form; ++k) {
        const double share = (k + 0.5) / starts_of_form;
        starts.push_back({static_cast<double>(form), 0.0,
                          std::log(shortest_s_) + share * std::log(longest_s_ / shortest_s_), longest()});
      }
    }
    return starts;
  }

  // The band that goes as what was fitted does.
  std::vector<std::vector<double>> RicherForms(std::span<const double> v,
                                               const LoopResidual&) const override {
    const CreepForm form = FormOf(v);
    if (IsBand(form)) return {};
    const double time_s = forms_[form].nonlinear_parameter_per_number * std::exp(v[2]);
    // Of a logarithmic law ln(1 + t/t₀), that late is as ln(t/τ) + 0.577.
    const double from_s = IsLogarithmic(form) ? kBandOverOnset * time_s : time_s / kNarrowBand;
    const double to_s = IsLogarithmic(form) ? kLongestOfBand * duration_s_ : time_s * kNarrowBand;
    const double amount = IsLogarithmic(form) ? v[1] * std::log10(to_s / from_s) : v[1];
    const double band = IsOfTorque(form) ? kBandOfTorque : kBandOfTwist;
    return {{band, amount, std::log(from_s / kOnset), std::log(to_s)}};
  }

  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    return FormedEffect::IsHeld(v, k) || (k == 3 && !IsBand(FormOf(v)));
  }

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    std::vector<ParameterValue> described = FormedEffect::Describe(v, covariance);
    if (!IsBand(FormOf(v))) return described;
    const double to_s = std::exp(v[3]);
    described.insert(described.begin() + 2, {kLongest, "s", to_s, to_s * StandardErrorOf(covariance(3, 3))});
    return described;
  }

  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v = FormedEffect::Restore(parameters);
    v.push_back(longest());
    if (const double* to_s = FindParameter(parameters, kLongest)) {
      v[0] = IsOfTorque(FormOf(v)) ? kBandOfTorque : kBandOfTwist;
      v[2] -= std::log(kOnset);
      v[3] = std::log(std::max(*to_s, 1e-9));
    }
    return v;
  }

 private:
  static constexpr double kMostPerDecade = 0.2;  // of the wind-up
  static constexpr double kMost = 0.5;
  static constexpr double kLongestOfBand = 3.0;  // of the record: slower is a straight line
  static constexpr double kNarrowBand = 1.5;
  static constexpr double kBandOverOnset = 1.78;  // e^0.577
  static constexpr const char* kLongest = "longest_time_constant_s";

  static CreepForm FormOf(std::span<const double> v) { return static_cast<CreepForm>(std::lround(v[0])); }
  double longest() const { return std::log(longest_s_); }

  static std::vector<Form> FormsOf(const LoopRecords& records) {
    const double arcmin_per_Nm = ArcminFromRad(records.compliance_rad_per_Nm());
    return {{"creep_share_per_decade", "1", 1.0, kOnset},
            {"creep_share", "1", 1.0},
            {"creep_arcmin_per_Nm_per_decade", "arcmin/Nm", arcmin_per_Nm, kOnset},
            {"creep_arcmin_per_Nm", "arcmin/Nm", arcmin_per_Nm},
            {"creep_share", "1", 1.0, kOnset},
            {"creep_arcmin_per_Nm", "arcmin/Nm", arcmin_per_Nm, kOnset}};
  }

  double shortest_s_;
  double longest_s_;
  double duration_s_;
};

// As the temperature goes, in proportion to time, saturating, or up and down about once: a room by day and
// night, of which nobody kept the temperature.
enum DriftForm { kOfTemperature, kOfTime, kSaturating, kSwing };

// Further number: of a swing its sine, beside the cosine.
class ThermalDrift final : public FormedEffect {
 public:
  explicit ThermalDrift(const LoopRecords& records)
      : FormedEffect(records,
                     {{"drift_arcmin_per_K", "arcmin/K", 1.0},
                      {"drift_arcmin_per_min", "arcmin/min", 60.0},
                      {"drift_arcmin", "arcmin", 1.0},
                      {"drift_swing_arcmin", "arcmin", 1.0}},
                     "drift_rms_arcmin", "time_constant_s", "s"),
        has_temperature_(!records.samples.temperature_K.empty()),
        may_swing_(records.samples.records() == 1 && records.passes() >= kFewestPasses),
        duration_s_(records.duration_s) {
    const double range_arcmin = ArcminFromRad(records.twist_range_rad);
    rule = {
        .name = "thermal_drift",
        .what_to_do = "let the bench soak, or measure at rest without torque for as long",
        .sentence =
            "the angle follows temperature or time, not torque: mount, encoder or gear grow as they warm up",
        .where = Where::kUndecided,
        .effect = "E10",
        .parameters = {{"time_constant_s", "s", 0.0, 3.0 * duration_s_, false}},
        .degrees_of_freedom = 1,
        .trials_factor = 4.0,
        .to_settle = fmt::format("# after a soak: drift goes with time and temperature, creep with torque\n"
                                 "- {{kind: soak, below_temperature: 25 degC, at_most: 2 h}}\n{}",
                                 PhaseText(records, {.name = "after-soak", .loops = 4}))};
    for (const Form& form : forms_) {
      rule.parameters.push_back({form.name, form.unit, -100.0 * range_arcmin, 100.0 * range_arcmin, false});
    }
    rule.parameters.push_back({size_name_, "arcmin", 0.0, 3.0 * range_arcmin, true});
    numbers = {{kOfTemperature, kSwing, 0.0, true, false},
               {-100.0 * range_arcmin, 100.0 * range_arcmin, 1e-6 * range_arcmin, false, true},
               {std::log(0.1 * duration_s_), std::log(2.0 * duration_s_), 1e-4, false, false},
               {-100.0 * range_arcmin, 100.0 * range_arcmin, 1e-6 * range_arcmin, false, true}};
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    const double amount_rad = RadFromArcmin(v[1]);
    const double sine_rad = RadFromArcmin(v[3]);
    const auto form = static_cast<DriftForm>(std::lround(v[0]));
    const double nonlinear_parameter_s = std::exp(v[2]);
    const auto at = [&](std::size_t i) {
      switch (form) {
        case kOfTemperature:
          return grid.temperature_K.empty() ? 0.0 : amount_rad * grid.temperature_K[i];
        case kOfTime:
          return amount_rad * grid.time_s[i];
        case kSaturating:
          return amount_rad * -std::expm1(-grid.time_s[i] / nonlinear_parameter_s);
        case kSwing: {
          const double phase =
              kTwoPi * grid.time_s[i] / (kPeriodPerNonlinearParameter * nonlinear_parameter_s);
          return amount_rad * std::cos(phase) + sine_rad * std::sin(phase);
        }
      }
      return 0.0;
    };
    for (std::size_t i = 0; i < grid.size(); ++i) total_rad(static_cast<Eigen::Index>(i)) += at(i);
  }

  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    return FormedEffect::IsHeld(v, k) || (k == 3 && std::lround(v[0]) != kSwing);
  }

  // What warms up follows the temperature, where that was recorded: a drift that does not is likelier to be
  // something else.
  double LogSearchLocations(std::span<const double> v) const override {
    return has_temperature_ && std::lround(v[0]) != kOfTemperature ? std::log(kLessLikely) : 0.0;
  }

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    std::vector<ParameterValue> described = FormedEffect::Describe(v, covariance);
    if (std::lround(v[0]) != kSwing) return described;
    const double amplitude = std::hypot(v[1], v[3]);
    const Eigen::Vector2d slope = Eigen::Vector2d(v[1], v[3]) / std::max(amplitude, 1e-300);
    Eigen::Matrix2d errors;
    errors << covariance(1, 1), covariance(1, 3), covariance(3, 1), covariance(3, 3);
    described[0].value = amplitude;
    described[0].standard_error = StandardErrorOf(slope.dot(errors * slope));
    const double period_s = kPeriodPerNonlinearParameter * std::exp(v[2]);
    described[1] = {"period_s", "s", period_s, period_s * StandardErrorOf(covariance(2, 2))};
    described.push_back({"phase_deg", "deg", DegFromRad(std::atan2(v[3], v[1])), 0.0});
    return described;
  }

  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    const double* swing = FindParameter(parameters, "drift_swing_arcmin");
    if (swing == nullptr) {
      std::vector<double> v = FormedEffect::Restore(parameters);
      v.push_back(0.0);
      return v;
    }
    const double phase = RadFromDeg(RequireParameter(rule, parameters, "phase_deg"));
    const double period_s = std::max(RequireParameter(rule, parameters, "period_s"), 1e-9);
    return {kSwing, *swing * std::cos(phase), std::log(period_s / kPeriodPerNonlinearParameter),
            *swing * std::sin(phase)};
  }

  std::vector<std::vector<double>> Starts(const LoopResidual&) const override {
    std::vector<std::vector<double>> starts;
    const double whole = std::log(duration_s_);
    if (has_temperature_) starts.push_back({kOfTemperature, 0.0, whole, 0.0});
    starts.push_back({kOfTime, 0.0, whole, 0.0});
    for (const double share : {0.15, 0.4, 1.0})
      starts.push_back({kSaturating, 0.0, std::log(share * duration_s_), 0.0});
    if (!may_swing_) return starts;
    for (const double periods : {0.4, 0.8, 1.2})
      starts.push_back({kSwing, 0.0, std::log(duration_s_ / periods / kPeriodPerNonlinearParameter), 0.0});
    return starts;
  }

 private:
  // A period of 0.7 to 14 records, in the range in which a time constant is looked for.
  static constexpr double kPeriodPerNonlinearParameter = 7.0;
  static constexpr double kLessLikely = 10.0;
  // With fewer loops each torque comes by too seldom: a swing would stand in for any shape of the loop.
  static constexpr double kFewestPasses = 4.0;

  bool HasNonlinearParameter(double form) const override { return form > 1.5; }

  bool has_temperature_;
  bool may_swing_;
  double duration_s_;
};

}  // namespace

void AppendAddedEffects(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<CreepEffect>(records));
  AppendBrakeSlip(records, effects);
  effects.push_back(std::make_unique<ThermalDrift>(records));
}

}  // namespace strainwave::analysis::diagnosis
