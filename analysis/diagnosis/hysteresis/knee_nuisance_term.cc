// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "analysis/diagnosis/hysteresis/correction.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Units differ by so much, and a table in a catalogue is rounded. Knees never cross.
constexpr double kFurthest = 0.2;

double FurthestShare(const LoopRecords& records) {
  constexpr double kRoom = 0.8;
  const double crossing = (records.t2_Nm - records.t1_Nm) / (records.t2_Nm + records.t1_Nm);
  return std::min(kFurthest, kRoom * crossing);
}

// Knees of the spring beside those that the record's metadata has. The law fits slopes between given knees:
// what is left of knees that lie elsewhere would pass for friction, for a dead zone or for hardening.
class Knees final : public NuisanceTerm {
 public:
  explicit Knees(const LoopRecords& records) : t1_Nm_(records.t1_Nm), t2_Nm_(records.t2_Nm) {
    const double most = FurthestShare(records);
    shapes_gear = true;
    Number("t1_Nm", "Nm", {-most * t1_Nm_, most * t1_Nm_, 1e-4 * t1_Nm_, false, true});
    // Beyond the peak the second one does nothing.
    if (records.peak_torque_Nm > (1.0 + most) * t2_Nm_)
      Number("t2_Nm", "Nm", {-most * t2_Nm_, most * t2_Nm_, 1e-4 * t2_Nm_, false, true});
    rule = {.name = "other knees",
            .sentence =
                "the stiffness changes at other torques than the record's t1_Nm and t2_Nm say (put the "
                "numbers of this unit there)",
            .degrees_of_freedom = static_cast<int>(numbers.size()),
            .named = false,
            .stated_number = true};
  }

  void ShapeGear(std::span<const double> v, GearLaw& law) const override {
    law.spring.t1_Nm += v[0];
    if (v.size() > 1) law.spring.t2_Nm += v[1];
  }

  std::vector<std::vector<double>> Starts(const LoopResidual&) const override {
    return {std::vector<double>(numbers.size(), 0.0)};
  }

  // The knees themselves, as the record would have to state them.
  std::vector<ParameterValue> Describe(std::span<const double> v,
                                       const Eigen::MatrixXd& covariance) const override {
    std::vector<ParameterValue> described = NuisanceTerm::Describe(v, covariance);
    for (std::size_t k = 0; k < described.size(); ++k) described[k].value += Stated_Nm(k);
    return described;
  }
  std::vector<double> Restore(std::span<const ParameterValue> parameters) const override {
    std::vector<double> v = NuisanceTerm::Restore(parameters);
    for (std::size_t k = 0; k < v.size(); ++k) v[k] -= Stated_Nm(k);
    return v;
  }

 private:
  double Stated_Nm(std::size_t k) const { return k == 0 ? t1_Nm_ : t2_Nm_; }

  double t1_Nm_;
  double t2_Nm_;
};

}  // namespace

void AppendKneeNuisanceTerm(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<Knees>(records));
}

}  // namespace strainwave::analysis::diagnosis
