// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/generated_loop.h"

// Fits of a loop that end in the wrong local minimum.
namespace strainwave::analysis::diagnosis::diagnosis_loop_local_minima_test {
namespace {

// What a gear that is stiffer one way leaves the nominal model makes up for by friction that yields over most
// of the range; beside that friction the asymmetry would bring next to nothing.
TEST(LoopLocalMinima, OfTheNominalModelHideNoAsymmetry) {
  std::vector<PathLeg> stairs;
  for (const double to_Nm : {6.0, 12.0, 18.0, 24.0, 30.0, 35.0, 30.0, 24.0, 18.0, 12.0, 6.0, 0.0})
    stairs.push_back({to_Nm, 12.0, 2.5});
  for (const std::uint32_t seed : {1U, 2U}) {
    const Diagnosed answer = DiagnoseLoop({.k1_Nm_per_rad = 1.8e4,
                                           .k2_Nm_per_rad = 2.5e4,
                                           .k3_Nm_per_rad = 2.6e4,
                                           .friction_Nm = {1.4},
                                           .yield_rad = {0.25e-4},
                                           .law_stiffer_share = 0.06},
                                          {.torque_noise_Nm = 0.002, .angle_noise_rad = RadFromArcmin(0.08)},
                                          Loops(5, stairs), 800, seed);
    ASSERT_EQ(answer.names(), Names{"asymmetric_stiffness"}) << seed;
    const ParameterValue share = answer.value("law_asymmetry_share");
    EXPECT_NEAR(share.value, 0.06, 4.0 * share.standard_error) << seed;
  }
}

// Knees that are at one twist are at two torques: taken for one, they would be a torque that is not zero.
TEST(LoopLocalMinima, OfKneesAtOneTwistAreNoOffsetOfTheTorque) {
  const Diagnosed answer =
      DiagnoseLoop({.law_stiffer_share = 0.03}, {.angle_noise_rad = RadFromArcmin(0.03)},
                   {{34.0, 1.0}, {-34.0, 1.0}, {34.0, 1.0}, {-34.0, 1.0}, {0.0, 1.0}}, 4000, 5);
  EXPECT_EQ(answer.names(), Names{"asymmetric_stiffness"});
}

// Stiffer one way from the first knee on; with all three segments alike a shelf would be named beside it.
TEST(LoopAsymmetry, MayBeginBeyondTheFirstSegment) {
  const Diagnosed answer = DiagnoseLoop({.k2_stiffer_share = 0.011, .k3_stiffer_share = 0.011},
                                        {.angle_noise_rad = RadFromArcmin(0.036), .autoregression = 0.22},
                                        Loops(4, {{42.0, 0.42}, {0.0, 0.42}}), 8000, 7);
  EXPECT_EQ(answer.names(), Names{"asymmetric_stiffness"});
  const ParameterValue share = answer.value("k2_k3_asymmetry_share");
  EXPECT_NEAR(share.value, 0.011, 4.0 * share.standard_error);
}

// A zone beside the friction with sharp ends, in a loop of so many samples that a fit would rather take means
// of several: these see a zone that fades away.
TEST(LoopLocalMinima, OfAZoneThatFadesAwayHideNoneWithSharpEnds) {
  const Diagnosed answer =
      DiagnoseLoop({.k1_Nm_per_rad = 1.4e4,
                    .k2_Nm_per_rad = 2.9e4,
                    .k3_Nm_per_rad = 3.2e4,
                    .friction_Nm = {1.1},
                    .yield_rad = {0.37e-4},
                    .dead_zone_rad = RadFromArcmin(0.08)},
                   {.torque_noise_Nm = 0.002, .angle_noise_rad = RadFromArcmin(0.02), .autoregression = 0.45},
                   Loops(7, {{34.0, 1.6}}), 6000, 6);
  ASSERT_EQ(answer.names(), Names{"backlash"});
  EXPECT_NEAR(answer.value("backlash_arcmin").value, 0.08, 0.01);
  EXPECT_EQ(answer.value("beside_friction").value, 1.0);
  EXPECT_LT(answer.value("dead_zone_torque_Nm").value, 0.1);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_loop_local_minima_test
