// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "analysis/diagnosis/hysteresis/effects.h"
#include "analysis/diagnosis/hysteresis/phases.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// What lies beside the nominal element: one further element, two, or a band of elements with equal torques
// and yield twists in equal ratios.
enum FrictionForm { kOneMore = 1, kTwoMore = 2, kBand = 3 };
constexpr std::size_t kElementsOfBand = kFrictionElements - 1;

// Numbers: form; then two blocks, each of a torque in Nm, ln of a yield twist in arcmin, and the state at the
// start of each record. A band takes torque, least yield twist and state from the first block, its largest
// from the second.
class DistributedFriction final : public LoopEffect {
 public:
  explicit DistributedFriction(const LoopRecords& records) : records_(records.samples.records()) {
    const double range_arcmin = ArcminFromRad(records.twist_range_rad);
    const double most_Nm = records.t2_Nm;
    least_yield_ = std::log(5e-4 * range_arcmin);
    most_yield_ = std::log(0.6 * range_arcmin);
    rule = {
        .name = "distributed_friction",
        .what_to_do =
            "clamp the couplings anew and repeat the loop: what stays is the gear's, and the extended model "
            "has it",
        .sentence =
            "the loop needs friction that yields at several twists (Maxwell slip), one element is not "
            "enough: "
            "tooth pairs that slide one after the other; couplings that creep in their hubs look the same",
        .where = Where::kUnit,
        .effect = "E6",
        // Torques and yield twists may stand for each other, so that none of them is known where their curve
        // is: it is for the likelihood to say whether there is one.
        .parameters = {{"second_friction_torque_Nm", "Nm", 0.0, most_Nm, false},
                       {"second_yield_twist_arcmin", "arcmin", 0.0, 0.59 * range_arcmin, false},
                       {"spread_friction_torque_Nm", "Nm", 0.0, most_Nm, false}},
        .degrees_of_freedom = 2 + static_cast<int>(records_),
        .trials_factor = 4.0,
        .to_settle = TwoAngles(records)};
    numbers.push_back({1.0, 3.0, 0.0, true, false});
    for (int block = 0; block < 2; ++block) {
      numbers.push_back({0.0, most_Nm, 1e-5 * records.t1_Nm, false, true});
      numbers.push_back({least_yield_, most_yield_, 1e-5, false, false});
      for (std::size_t r = 0; r < records_; ++r) {
        numbers.push_back({-1.0, 1.0, 1e-5, false, false, static_cast<int>(r)});
      }
    }
    shapes_gear = true;
  }

  void ShapeGear(std::span<const double> v, GearLaw& law) const override {
    const int form = FormOf(v);
    const std::size_t count = form == kBand ? kElementsOfBand : static_cast<std::size_t>(form);
    law.friction_elements = 1 + count;
    for (std::size_t e = 0; e < count; ++e) {
      const std::size_t block = form == kTwoMore ? FirstOf(e) : FirstOf(0);
      double torque_Nm = v[block];
      double ln_yield = v[block + 1];
      if (form == kBand) {
        torque_Nm /= static_cast<double>(count);
        ln_yield += (v[FirstOf(1) + 1] - ln_yield) * static_cast<double>(e) / static_cast<double>(count - 1);
      }
      law.friction[e + 1] = {torque_Nm, RadFromArcmin(std::exp(ln_yield))};
      for (std::size_t r = 0; r < records_; ++r) law.start_share[r][e + 1] = v[block + 2 + r];
    }
  }

  bool IsHeld(std::span<const double> v, std::size_t k) const override {
    if (k == 0) return true;
    if (k < FirstOf(1) || FormOf(v) == kTwoMore) return false;
    return FormOf(v) == kOneMore || k != FirstOf(1) + 1;
  }

  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override {
    std::vector<std::vector<double>> starts;
    const double own = std::log(ArcminFromRad(residual.law.friction[0].yield_rad));
    for (const double share : {0.0, -0.95, 0.95}) {
      for (const double factor : {0.08, 0.3, 3.0, 10.0, 30.0}) {
        const double yield = own + std::log(factor);
        if (yield < least_yield_ + 0.1 || yield > most_yield_ - 0.1) continue;
        starts.push_back(Numbers(kOneMore, yield, most_yield_, share));
      }
      for (const auto& [least, largest] : {std::pair{0.15, 2.0}, {0.4, 5.0}, {1.5, 15.0}}) {
        starts.push_back(Numbers(kBand, std::clamp(own + std::log(least), least_yield_, most_yield_),
                                 std::clamp(own + std::log(largest), least_yield_, most_yield_), share));
      }
    }
    return starts;
  }

  std::vector<std::vector<double>> RicherForms(std::span<const double> v,
                                               const LoopResidual& residual) const override {
    std::vector<std::vector<double>> forms;
    if (FormOf(v) != kOneMore) return forms;
    for (const std::vector<double>& start : Starts(residual)) {
      if (FormOf(start) != kOneMore) continue;
      // The one that is there goes behind the new one, whose torque is to be found.
      std::vector<double> form(v.begin(), v.end());
      const auto block = static_cast<std::ptrdiff_t>(2 + records_);
      std::copy_n(v.begin() + 1, block, form.begin() + 1 + block);
      std::copy_n(start.begin() + 1, block, form.begin() + 1);
      form[0] = kTwoMore;
      forms.push_back(std::move(form));
    }
    return forms;
  }

  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    const std::vector<double> se = ErrorsOf(covariance);
    std::vector<ParameterValue> described;
    const auto torque = [&](const char* name, std::size_t block) {
      described.push_back({fmt::format("{}_friction_torque_Nm", name), "Nm", v[block], se[block]});
    };
    const auto yield = [&](const std::string& name, std::size_t block) {
      const double yield_arcmin = std::exp(v[block + 1]);
      described.push_back({name, "arcmin", yield_arcmin, yield_arcmin * se[block + 1]});
    };
    const auto starts = [&](const char* name, std::size_t block) {
      for (std::size_t r = 0; r < records_; ++r) {
        described.push_back({StartName(name, r), "1", v[block + 2 + r], se[block + 2 + r]});
      }
    };
    if (FormOf(v) == kBand) {
      torque("spread", FirstOf(0));
      yield("spread_from_arcmin", FirstOf(0));
      yield("spread_to_arcmin", FirstOf(1));
      starts("spread", FirstOf(0));
      return described;
    }
    for (std::size_t e = 0; e < static_cast<std::size_t>(FormOf(v)); ++e) {
      torque(kNames[e], FirstOf(e));
      yield(fmt::format("{}_yield_twist_arcmin", kNames[e]), FirstOf(e));
      starts(kNames[e], FirstOf(e));
    }
    return described;
  }

  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v = Numbers(kOneMore, most_yield_, most_yield_, 0.0);
    const auto yield = [&](const std::string& name) {
      return std::log(std::max(1e-9, RequireParameter(rule, parameters, name)));
    };
    const auto fill = [&](const char* name, std::size_t block) {
      v[block] = RequireParameter(rule, parameters, fmt::format("{}_friction_torque_Nm", name));
      for (std::size_t r = 0; r < records_; ++r) {
        const double* share = FindParameter(parameters, StartName(name, r));
        v[block + 2 + r] = share == nullptr ? 0.0 : *share;
      }
    };
    if (FindParameter(parameters, "spread_friction_torque_Nm") != nullptr) {
      v[0] = kBand;
      fill("spread", FirstOf(0));
      v[FirstOf(0) + 1] = yield("spread_from_arcmin");
      v[FirstOf(1) + 1] = yield("spread_to_arcmin");
      return v;
    }
    if (FindParameter(parameters, "third_friction_torque_Nm") != nullptr) v[0] = kTwoMore;
    for (std::size_t e = 0; e < static_cast<std::size_t>(FormOf(v)); ++e) {
      fill(kNames[e], FirstOf(e));
      v[FirstOf(e) + 1] = yield(fmt::format("{}_yield_twist_arcmin", kNames[e]));
    }
    return v;
  }

 private:
  static constexpr const char* kNames[] = {"second", "third"};

  static int FormOf(std::span<const double> v) { return static_cast<int>(std::lround(v[0])); }
  std::size_t FirstOf(std::size_t block) const { return 1 + block * (2 + records_); }
  std::vector<double> Numbers(FrictionForm form, double first_yield, double second_yield,
                              double share) const {
    std::vector<double> v(numbers.size(), share);
    v[0] = form;
    v[FirstOf(0)] = 0.0;
    v[FirstOf(0) + 1] = first_yield;
    v[FirstOf(1)] = 0.0;
    v[FirstOf(1) + 1] = second_yield;
    return v;
  }
  static std::string StartName(const char* element, std::size_t record) {
    return record == 0 ? fmt::format("{}_start_share", element)
                       : fmt::format("{}_start_share_{}", element, record + 1);
  }

  std::size_t records_;
  double least_yield_{};
  double most_yield_{};
};

}  // namespace

void AppendDistributedFriction(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<DistributedFriction>(records));
}

}  // namespace strainwave::analysis::diagnosis
