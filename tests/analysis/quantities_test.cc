// SPDX-License-Identifier: Apache-2.0
#include "analysis/quantities.h"

#include <set>

#include <gtest/gtest.h>

namespace strainwave::analysis::quantities_test {
namespace {

TEST(Quantities, AreFoundByTheNamesThatDatabaseAndJsonHave) {
  std::set<std::string_view> names;
  for (const Quantity& quantity : kQuantities) {
    EXPECT_TRUE(names.insert(quantity.name).second) << quantity.name << " stands there twice";
    ASSERT_NE(FindUnit(quantity.name), nullptr) << quantity.name;
    EXPECT_FALSE(quantity.title.empty() || quantity.meaning.empty()) << quantity.name;
    EXPECT_EQ(FindQuantity(quantity.name)->meaning, quantity.meaning);
  }
  EXPECT_EQ(FindQuantity("k2_Nm_per_rad")->symbol, "K2");
  EXPECT_EQ(FindQuantity("k2_Nm_per_rad")->title, "K₂");
  EXPECT_EQ(FindQuantity("k2_Nm_per_rad")->unit(), "Nm/rad");
  EXPECT_EQ(FindQuantity("k2"), nullptr);
}

TEST(UnitOf, IsTheLongestThatTheNameEndsIn) {
  EXPECT_EQ(UnitOf("k2_loading_Nm_per_rad"), "Nm/rad");
  EXPECT_EQ(UnitOf("friction_rad"), "rad");
  EXPECT_EQ(UnitOf("efficiency_percent"), "%");
  EXPECT_EQ(UnitOf("starting_torque_Nm"), "Nm");
  EXPECT_EQ(UnitOf("vibration_rms_accel_x_m_per_s2"), "m/s2");
  EXPECT_EQ(UnitOf("load_run_vibration_crest_accel_x"), "");
  EXPECT_EQ(UnitOf("torqueNm"), "");
  EXPECT_EQ(UnitOf("_Nm"), "");
  EXPECT_EQ(UnitOf(""), "");
}

TEST(WithoutUnit, LeavesTheNameAsItIsWhereItHasNone) {
  EXPECT_EQ(WithoutUnit("lost_motion_arcmin"), "lost_motion");
  EXPECT_EQ(WithoutUnit("k1_Nm_per_rad"), "k1");
  EXPECT_EQ(WithoutUnit("kurtosis"), "kurtosis");
}

TEST(NameByMethod, PutsTheMethodBeforeTheUnit) {
  EXPECT_EQ(NameByMethod(quantities::kK3, "backbone"), "k3_backbone_Nm_per_rad");
}

TEST(Listed, JoinsWhatIsAskedFor) {
  EXPECT_EQ(Listed(kPredictedQuantities, &Quantity::symbol), "e_max, e_avg, K1, K2, K3");
  EXPECT_EQ(Listed(kStiffnesses, &Quantity::name), "k1_Nm_per_rad, k2_Nm_per_rad, k3_Nm_per_rad");
}

}  // namespace
}  // namespace strainwave::analysis::quantities_test
