// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "bench/diagnosis/diagnosis_report.h"

/// A diagnosis that is made up: of a study that answers without fitting anything.
namespace strainwave::bench {

namespace diagnosis = analysis::diagnosis;
using diagnosis::ParameterValue;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kArcminPerRad = 3437.746770784939;

/// 720 samples over one turn whose response follows the angle; answers without fitting anything.
class MadeUpStudy final : public diagnosis::Study {
 public:
  MadeUpStudy() {
    for (int i = 0; i < 720; ++i) {
      const double angle = i * 6.283185307179586 / 720.0;
      angle_.push_back(angle);
      measured_.push_back((0.4 * std::cos(angle) + 0.02 * std::sin(911.0 * i)) / kArcminPerRad);
    }
    regressors_.push_back({"output_angle", "output angle / deg", 57.29577951308232, angle_, true});
    rules_.push_back(
        {.name = "output_eccentricity",
         .what_to_do = "turn the encoder by half a turn",
         .sentence = "an error once per turn",
         .where = diagnosis::Where::kUndecided,
         .effect = "E3",
         .parameters = {{"amplitude_arcmin", "arcmin", 0.0, 60.0, true}},
         .to_settle = "# remount the encoder\n- kind: transmission_error\n  input_speed: 300 rpm\n"});
    rules_.push_back({.name = "backlash", .sentence = "lost motion", .where = diagnosis::Where::kUnit});
    rules_.push_back({.name = "line over output angle", .sentence = "", .named = false});
  }
  std::span<const double> measured() const override { return measured_; }
  std::span<const std::size_t> segments() const override { return segments_; }
  const std::vector<diagnosis::CauseRule>& causes() const override { return rules_; }
  const std::vector<diagnosis::Regressor>& regressors() const override { return regressors_; }
  std::string unit() const override { return "arcmin"; }
  double unit_per_si() const override { return kArcminPerRad; }
  diagnosis::ModelFit Fit(std::span<const std::size_t>, std::span<const double>, const diagnosis::ModelFit*,
                          diagnosis::FitPurpose) const override {
    return {};
  }
  double NoiseFloor() const override { return 0.02 / kArcminPerRad; }
  std::size_t BlockLength() const override { return 36; }
  std::vector<diagnosis::UserQuantity> Quantities(const Eigen::VectorXd& predicted) const override {
    return {{"e_max_arcmin", 0.84, (predicted.maxCoeff() - predicted.minCoeff()) * kArcminPerRad}};
  }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  Eigen::VectorXd Predict(std::span<const ParameterValue>, std::span<const NamedCause>) const override {
    return {};
  }

  const std::vector<double>& angle() const { return angle_; }

 private:
  std::vector<double> angle_;
  std::vector<double> measured_;
  std::vector<std::size_t> segments_{0};
  std::vector<diagnosis::CauseRule> rules_;
  std::vector<diagnosis::Regressor> regressors_;
  std::vector<std::string> warnings_;
};

struct MadeUp {
  MadeUp() {
    auto made_up = std::make_unique<MadeUpStudy>();
    const std::size_t samples = made_up->angle().size();
    input.kind = StudyKind::kTransmissionError;
    input.records.push_back({"/somewhere/sweep.csv", "", std::string(64, 'a'), samples});
    input.warnings.push_back({"", 0, "3.0 % of the time stamps repeat the one before"});
    result.nominal.nominal = {{"offset_arcmin", "arcmin", 0.0, 0.01}};
    result.nominal.predicted = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples));
    result.extended = result.nominal;
    result.weights.assign(samples, 1.0);
    result.noise_floor = 0.02 / kArcminPerRad;
    result.nominal_heldout_rmse = result.extended_heldout_rmse = 0.28 / kArcminPerRad;
    for (std::size_t i = 0; i < samples; ++i)
      once_.push_back(0.4 * std::cos(made_up->angle()[i]) / kArcminPerRad);
    input.study = std::move(made_up);
  }

  DiagnosisReport Report() const { return {input, result, "", {{"offset_arcmin", "arcmin", 0.1, 0.0}}, {}}; }

  void Find() {
    result.verdict = diagnosis::Verdict::kEffectFound;
    const std::vector<ParameterValue> parameters{{"amplitude_arcmin", "arcmin", 0.4, 0.002},
                                                 {"phase_deg", "deg", -0.1, kNaN}};
    result.causes.push_back({0, parameters, {812.5, 0.0, 400.0}, 0.99, {"backlash"}});
    result.extended.causes = {0};
    result.extended.cause_parameters = {parameters};
    result.extended.predicted =
        Eigen::Map<Eigen::VectorXd>(once_.data(), static_cast<Eigen::Index>(once_.size()));
    result.extended_heldout_rmse = 0.021 / kArcminPerRad;
    result.candidates = {{0, {812.5, 0.0, 400.0}, true, ""},
                         {1, {-2.0, 0.3, kNaN}, false, "not away from zero"}};
    result.gain = {0.925, 0.91, 0.94};
    result.residual.share_of_residual_variance = 0.01;
  }

  void FindUnnamed() {
    result.verdict = diagnosis::Verdict::kUnnamedStructure;
    result.nuisance_terms.push_back({2,
                                     {{"order_per_output_turn", "1/turn", 7.0, 0.01},
                                      {"amplitude_arcmin", "arcmin", 0.2134, 0.004},
                                      {"phase_deg", "deg", 12.0, 1.0}},
                                     {99.0, 1e-20, 50.0},
                                     0.9,
                                     {}});
    result.extended.causes = {2};
    result.extended.cause_parameters = {result.nuisance_terms[0].parameters};
  }

  StudyInput input;
  diagnosis::Diagnosis result;

 private:
  std::vector<double> once_;
};

inline MadeUp Found() {
  MadeUp made_up;
  made_up.Find();
  return made_up;
}

inline MadeUp Unnamed() {
  MadeUp made_up;
  made_up.FindUnnamed();
  return made_up;
}

}  // namespace strainwave::bench
