// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "analysis/torsional_stiffness.h"
#include "tests/analysis/chance.h"
#include "tests/analysis/simulated_loop.h"

namespace strainwave::analysis::stiffness_errors_test {
namespace {

constexpr int kRecords = 300;

// How many of the records have a 95 % interval that holds the truth, for each slope.
std::array<double, 3> Coverage(StiffnessMethod method, double autoregression, double torque_noise_Nm,
                               double twist_noise_rad, const std::vector<double>& path_Nm) {
  const LoopTruth truth;
  std::array<double, 3> held{};
  for (std::uint32_t seed = 1; seed <= kRecords; ++seed) {
    const LoopNoise noise{torque_noise_Nm, twist_noise_rad, autoregression, seed};
    const SimulatedRecord record = SimulateLoop(truth, path_Nm, 1500, noise);
    const TorsionalStiffness fit = MeasureStiffness(record.View(), {7.0, 25.0, 34.0}, method);
    const Estimate* slopes[3] = {&fit.k1_Nm_per_rad, &fit.k2_Nm_per_rad, &fit.k3_Nm_per_rad};
    const double truths[3] = {truth.k1_Nm_per_rad, truth.k2_Nm_per_rad, truth.k3_Nm_per_rad};
    for (std::size_t k = 0; k < 3; ++k) {
      const bool holds = std::abs(slopes[k]->value - truths[k]) <= 1.96 * slopes[k]->standard_error;
      held[k] += holds ? 1.0 : 0.0;
    }
  }
  return held;
}

void ExpectTheTruthIn95Of100(const std::array<double, 3>& coverage) {
  for (const double held : coverage) ExpectCoverageOf95(held, kRecords);
}

const std::vector<double> kFromRest_Nm = {0, 34, -34, 0};
const std::vector<double> kFromPeak_Nm = {-34, 34, -34};

// The one that is hardest for the model, and the plain one of the backbone.
TEST(StiffnessStandardErrors, HoldForTheModel) {
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kModel, 0.7, 0.02, RadFromArcsec(0.2), kFromPeak_Nm));
}

TEST(StiffnessStandardErrors, HoldForTheBackbone) {
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kBackbone, 0.0, 0.02, RadFromArcsec(0.2), kFromRest_Nm));
}

TEST(StiffnessStandardErrorsAtLength, HoldForTheModelUnderWhiteNoise) {
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kModel, 0.0, 0.02, RadFromArcsec(0.2), kFromRest_Nm));
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kModel, 0.0, 0.02, RadFromArcsec(0.2), kFromPeak_Nm));
}

TEST(StiffnessStandardErrorsAtLength, HoldForTheModelUnderColouredNoise) {
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kModel, 0.5, 0.02, RadFromArcsec(0.2), kFromRest_Nm));
}

TEST(StiffnessStandardErrorsAtLength, HoldForTheModelUnderNoiseInOneChannel) {
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kModel, 0.0, 0.1, 0.0, kFromRest_Nm));
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kModel, 0.3, 0.0, RadFromArcsec(2.0), kFromRest_Nm));
}

TEST(StiffnessStandardErrorsAtLength, HoldForTheBackboneUnderColouredNoise) {
  ExpectTheTruthIn95Of100(Coverage(StiffnessMethod::kBackbone, 0.5, 0.02, RadFromArcsec(0.2), kFromPeak_Nm));
}

}  // namespace
}  // namespace strainwave::analysis::stiffness_errors_test
