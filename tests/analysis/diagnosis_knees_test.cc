// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/generated_loop.h"

namespace strainwave::analysis::diagnosis::diagnosis_knees_test {
namespace {

// Knees at 7.5 and 24 Nm in a gear whose record says 7 and 25 Nm.
constexpr double kT1_Nm = 7.5;
constexpr double kT2_Nm = 24.0;

Diagnosed AskWithOtherKnees(GeneratedGear gear, double t1_Nm = kT1_Nm, double t2_Nm = kT2_Nm) {
  gear.t1_Nm = t1_Nm;
  gear.t2_Nm = t2_Nm;
  const auto path = Loops(3, {{.to_Nm = 34.0, .rate_Nm_per_s = 1.0, .hold_s = 4.0}});
  return DiagnoseLoop(gear, {.angle_noise_rad = RadFromArcmin(0.003)}, path, 4000, 5);
}

void ExpectTheKnees(const Diagnosed& found) {
  ASSERT_EQ(found.diagnosis.nuisance_terms.size(), 1U);
  const Finding& knees = found.diagnosis.nuisance_terms.front();
  EXPECT_EQ(found.study->causes()[knees.index].name, "other knees");
  ASSERT_EQ(knees.parameters.size(), 2U);
  EXPECT_EQ(knees.parameters[0].name, "t1_Nm");
  EXPECT_NEAR(knees.parameters[0].value, kT1_Nm, 4.0 * knees.parameters[0].standard_error);
  EXPECT_NEAR(knees.parameters[1].value, kT2_Nm, 4.0 * knees.parameters[1].standard_error);
}

// A wrong number of the record is no missing effect.
TEST(HysteresisKnees, BesideTheRecordsOwnAreNoCause) {
  const Diagnosed found = AskWithOtherKnees({});
  EXPECT_EQ(found.names(), Names());
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect);
  ExpectTheKnees(found);
}

// A second element of friction that yields only at the knees does the same as knees that lie higher.
TEST(HysteresisKnees, ThatLieHigherAreNoFriction) {
  for (const double higher : {1.05, 1.08, 1.14}) {
    const Diagnosed found = AskWithOtherKnees({}, 7.0 * higher, 25.0 * higher);
    EXPECT_EQ(found.names(), Names()) << higher;
    EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect) << higher;
  }
}

TEST(HysteresisKnees, BesideTheRecordsOwnHideNoCause) {
  const Diagnosed found = AskWithOtherKnees({.hardening_Nm_per_rad3 = 4e8});
  EXPECT_EQ(found.names(), Names{"cubic_hardening"});
  ExpectTheKnees(found);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_knees_test
