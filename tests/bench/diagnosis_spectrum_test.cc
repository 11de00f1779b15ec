// SPDX-License-Identifier: Apache-2.0
// The order spectrum of a diagnosis that is made up.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/records.h"
#include "bench/diagnosis/diagnosis_pictures.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::bench::diagnosis_spectrum_test {
namespace {

namespace diagnosis = analysis::diagnosis;

constexpr std::size_t kSamples = 16000;

/// Forty turns in two seconds, with a line at the thirteenth harmonic of order 9.231; answers without
/// fitting.
class RingingStudy final : public diagnosis::Study {
 public:
  RingingStudy() {
    std::vector<double> angle;
    std::vector<double> time_s;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(kSamples);
      angle.push_back(40.0 * 6.283185307179586 * share);
      time_s.push_back(2.0 * share);
      measured_.push_back(0.4 * std::cos(13.0 * 9.231 * angle.back()));
    }
    regressors_ = {{"input_angle", "input angle / deg", 57.29577951308232, std::move(angle), true},
                   {"time", "time / s", 1.0, std::move(time_s), false}};
    rules_.push_back({.name = "bearing_defect", .sentence = "", .where = diagnosis::Where::kUndecided});
  }
  std::span<const double> measured() const override { return measured_; }
  std::span<const std::size_t> segments() const override { return segments_; }
  const std::vector<diagnosis::CauseRule>& causes() const override { return rules_; }
  const std::vector<diagnosis::Regressor>& regressors() const override { return regressors_; }
  std::string unit() const override { return "m/s^2"; }
  double unit_per_si() const override { return 1.0; }
  diagnosis::ModelFit Fit(std::span<const std::size_t>, std::span<const double>, const diagnosis::ModelFit*,
                          diagnosis::FitPurpose) const override {
    return {};
  }
  double NoiseFloor() const override { return 0.02; }
  std::size_t BlockLength() const override { return 400; }
  std::vector<diagnosis::UserQuantity> Quantities(const Eigen::VectorXd&) const override { return {}; }
  const std::vector<std::string>& warnings() const override { return warnings_; }
  Eigen::VectorXd Predict(std::span<const diagnosis::ParameterValue>,
                          std::span<const NamedCause>) const override {
    return {};
  }

 private:
  std::vector<double> measured_;
  std::vector<std::size_t> segments_{0};
  std::vector<diagnosis::CauseRule> rules_;
  std::vector<diagnosis::Regressor> regressors_;
  std::vector<std::string> warnings_;
};

std::string SpectrumWith(std::vector<diagnosis::ParameterValue> parameters) {
  const daq::ScratchFolder folder;
  StudyInput input;
  input.kind = StudyKind::kVibration;
  input.study = std::make_unique<RingingStudy>();
  diagnosis::Diagnosis result;
  result.weights.assign(kSamples, 1.0);
  result.nominal.predicted = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(kSamples));
  result.extended = result.nominal;
  result.causes.push_back({0, std::move(parameters), {812.5, 0.0, 400.0}, 0.99, {}});
  DrawResidualSpectrum({input, result, "", {}, {}}, folder / "spectrum");
  return daq::BytesOf(folder / "spectrum.svg");
}

// 2360 Hz at 20 turns a second is order 118; the spectrum of so long a record would end at 25.
TEST(DiagnosisSpectrum, ShowsTheOrdersAtWhichABearingRings) {
  const std::string svg =
      SpectrumWith({{"defect_order", "1/turn", 9.231, 0.001}, {"ring_Hz", "Hz", 2360.0, 5.0}});
  EXPECT_NE(svg.find("bearing_defect rings, a line every 9.231"), std::string::npos);
  EXPECT_NE(svg.find(" 120</"), std::string::npos) << "of the axis";
}

TEST(DiagnosisSpectrum, StaysWhereAnOrderIsJustInView) {
  const std::string svg = SpectrumWith({{"defect_order", "1/turn", 24.3, 0.001}});
  EXPECT_NE(svg.find("bearing_defect (found)"), std::string::npos);
  EXPECT_NE(svg.find("shaft, twice"), std::string::npos);
}

}  // namespace
}  // namespace strainwave::bench::diagnosis_spectrum_test
