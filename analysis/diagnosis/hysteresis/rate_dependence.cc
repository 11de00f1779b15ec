// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <utility>

#include "analysis/diagnosis/hysteresis/effects.h"
#include "analysis/diagnosis/hysteresis/law_number.h"
#include "analysis/diagnosis/hysteresis/phases.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Half of the median of what the torque moves at, so that rates of the record lie where ln(1 + rate / usual)
// is curved.
double UsualRate_Nm_per_s(const LoopRecords& records) {
  std::vector<double> rates;
  for (const double rate : records.torque_rate_Nm_per_s) {
    if (rate != 0.0) rates.push_back(std::abs(rate));
  }
  return rates.empty() ? 1.0 : 0.5 * Median(std::move(rates));
}

// As a law of the friction it goes with a rate that the record has, which has to be told beside its number.
class RateDependence final : public LawNumber {
 public:
  RateDependence(CauseRule the_rule, std::vector<LawForm> forms, double usual_rate_Nm_per_s)
      : LawNumber(std::move(the_rule), std::move(forms)), usual_rate_Nm_per_s_(usual_rate_Nm_per_s) {}

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    std::vector<ParameterValue> described = LawNumber::Describe(v, covariance);
    if (FindParameter(described, "friction_rise_share") != nullptr ||
        FindParameter(described, "linear_friction_rise_share") != nullptr)
      described.push_back({"usual_rate_Nm_per_s", "Nm/s", usual_rate_Nm_per_s_, 0.0});
    return described;
  }
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v = LawNumber::Restore(parameters);
    const double* usual = FindParameter(parameters, "usual_rate_Nm_per_s");
    if (usual == nullptr) return v;
    // Of another record: between the two rates the logarithm is nearly a straight line.
    const double rates = *usual / usual_rate_Nm_per_s_;
    v.back() *= FindParameter(parameters, "friction_rise_share") != nullptr
                    ? std::log1p(1.0) / std::log1p(rates)
                    : 1.0 / rates;
    return v;
  }

 private:
  double usual_rate_Nm_per_s_;
};

}  // namespace

void AppendRateDependence(const LoopRecords& records, LoopEffects& effects) {
  const double rate_Nm_per_s = UsualRate_Nm_per_s(records);
  const double most_lag_rad_s_per_Nm = 0.5 * records.twist_range_rad / (2.0 * rate_Nm_per_s);
  // As much damping as takes all the torque at the mean rate of the twist.
  const double twist_rad_per_s = records.twist_range_rad * records.passes() / records.duration_s;
  const double most_viscous = 0.5 * records.peak_torque_Nm / twist_rad_per_s;
  CauseRule rule{
      .name = "rate_dependence",
      .what_to_do =
          "repeat the loop at a tenth of the torque rate, and check that angle and torque are sampled "
          "together",
      .sentence =
          "the loop widens with the torque rate, as with viscous friction: stiff grease or cold; an "
          "angle that is sampled later than the torque looks the same",
      .where = Where::kUnit,
      .effect = "E22",
      .degrees_of_freedom = 1,
      .trials_factor = 5.0,
      .to_settle = fmt::format(
          "# the same loop slowly and fast: what is the rate's doing grows ten times\n{}{}",
          PhaseText(records, {.name = "slow", .torque_rate_Nm_per_s = 0.5, .hold_s = 30.0, .loops = 2}),
          PhaseText(records, {.name = "fast", .torque_rate_Nm_per_s = 5.0, .hold_s = 30.0, .loops = 2}))};
  const auto friction_rise = [rate_Nm_per_s](bool linearly) {
    return [=](double share, GearLaw& law) {
      law.friction_rise_share = share;
      law.friction_rises_linearly = linearly;
      law.usual_rate_Nm_per_s = rate_Nm_per_s;
    };
  };
  // As much as a lag of the twist at its mean stiffness.
  const double most_lag_s = most_lag_rad_s_per_Nm * 2.0 * records.peak_torque_Nm / records.twist_range_rad;
  std::vector<LawForm> forms{
      {"viscous_Nms_per_rad", "Nm s/rad", 0.0, most_viscous,
       [](double viscous, GearLaw& law) { law.viscous_Nms_per_rad = viscous; }},
      {"lag_rad_s_per_Nm", "rad s/Nm", 0.0, most_lag_rad_s_per_Nm,
       [](double lag, GearLaw& law) { law.lag_rad_s_per_Nm = lag; }},
      {"friction_rise_share", "1", 0.0, 3.0, friction_rise(false)},
      {"linear_friction_rise_share", "1", 0.0, 3.0, friction_rise(true)},
      {"torque_lag_s", "s", 0.0, most_lag_s, [](double lag_s, GearLaw& law) { law.torque_lag_s = lag_s; }}};
  effects.push_back(std::make_unique<RateDependence>(std::move(rule), std::move(forms), rate_Nm_per_s));
}

}  // namespace strainwave::analysis::diagnosis
