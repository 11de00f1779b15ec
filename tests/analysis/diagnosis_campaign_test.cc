// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "tests/analysis/diagnosed_campaign.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis::diagnosis_campaign_test {
namespace {

TEST(MakeCampaignStudy, NamesAStepWithItsSizeAndCycle) {
  const Case result = DiagnosedCampaign(
      1, 100, [](CampaignDrawing& drawing, double, std::size_t, Random&) { drawing.AddStep(1, 41.0, -6.0); });
  ASSERT_EQ(result.Names(), std::vector<std::string>{"step_change"});
  EXPECT_EQ(result.Parameter("cycle").value, 41.0);
  const ParameterValue step = result.Parameter("step_k2_Nm_per_rad");
  EXPECT_EQ(step.unit, "Nm/rad");
  EXPECT_NEAR(step.value, -6.0 * 75.0, 4.0 * step.standard_error);  // scatter: 0.3 % of 25000
  // One level of 120 against the other, beside a trend: a few tenths of the scatter.
  EXPECT_LT(step.standard_error, 0.7 * 75.0);
  const CauseRule& rule = result.study->causes()[result.diagnosis.causes[0].index];
  EXPECT_EQ(rule.where, Where::kUndecided);
  EXPECT_NE(rule.to_settle.find("- kind: blank_test"), std::string::npos);
}

TEST(MakeCampaignStudy, PredictsFromParametersByNameWhatItFitted) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Case result =
        DiagnosedCampaign(seed, 100, [](CampaignDrawing& drawing, double from, std::size_t series, Random&) {
          drawing.AddStep(series, from, 6.0);
          drawing.AddTemperature((series + 1) % 6, 1.0);
        });
    std::vector<Study::NamedCause> causes;
    for (const Finding& finding : result.diagnosis.causes) {
      causes.push_back({result.study->causes()[finding.index].name, finding.parameters});
    }
    EXPECT_EQ(causes.size(), 2U);
    const Eigen::VectorXd again = result.study->Predict(result.diagnosis.extended.nominal, causes);
    EXPECT_LT((again - result.diagnosis.extended.predicted).cwiseAbs().maxCoeff(), 1e-6);
  }
}

TEST(MakeCampaignStudy, ReportsTheLastResultsInTheirOwnUnit) {
  const CampaignDrawing drawing(5, 60);
  const auto study = MakeCampaignStudy(drawing.data);
  const Eigen::Map<const Eigen::VectorXd> measured(study->measured().data(),
                                                   static_cast<Eigen::Index>(study->measured().size()));
  const std::vector<UserQuantity> quantities = study->Quantities(measured);
  ASSERT_EQ(quantities.size(), 6U);
  for (std::size_t s = 0; s < 6; ++s) {
    double mean = 0.0;
    for (std::size_t c = 55; c < 60; ++c) mean += drawing.data.series[s].value[c] / 5.0;
    EXPECT_EQ(quantities[s].name, "last_" + drawing.data.series[s].name);
    EXPECT_NEAR(quantities[s].measured, mean, 1e-9 * mean);
    EXPECT_NEAR(quantities[s].predicted, mean, 1e-9 * mean);
  }
}

TEST(MakeCampaignStudy, WarnsOfScatterBeyondTheStandardErrors) {
  CampaignDrawing drawing(5, 60);
  for (double& error : drawing.data.series[3].standard_error) error *= 0.2;
  const auto study = MakeCampaignStudy(drawing.data);
  ASSERT_EQ(study->warnings().size(), 1U);
  EXPECT_TRUE(study->warnings()[0].starts_with("e_max_arcmin scatters ")) << study->warnings()[0];
  EXPECT_TRUE(study->warnings()[0].ends_with("times as much from cycle to cycle as its standard errors say"));
}

TEST(MakeCampaignStudy, SaysWhatIsWrongWithACampaign) {
  const auto message = [](const std::function<void(CampaignData&)>& spoil) {
    CampaignData data = CampaignDrawing(1, 20).data;
    spoil(data);
    return MessageOf([&] { (void)MakeCampaignStudy(data); });
  };
  EXPECT_EQ(MessageOf([] { (void)MakeCampaignStudy(CampaignDrawing(1, 11).data); }),
            "the campaign has 11 cycles with results (expected at least 12)");
  EXPECT_EQ(message([](CampaignData& data) { data.series[1].value.pop_back(); }),
            "k2_Nm_per_rad has 19 values, cycle has 20 (expected the same number)");
  EXPECT_EQ(message([](CampaignData& data) { data.load_time_s[4] = 0.0; }),
            "load_time_s[4] = 0 is less than 7200 before it (expected not to fall)");
  EXPECT_EQ(message([](CampaignData& data) { data.load_time_s.assign(20, 5.0); }),
            "load_time_s is 5 in all 20 cycles (expected to grow)");
  EXPECT_EQ(message([](CampaignData& data) {
              for (CampaignSeries& series : data.series) series.value.assign(20, std::nan(""));
            }),
            "no result of the campaign has a value in 12 cycles or more (expected at least one series)");
  EXPECT_EQ(message([](CampaignData& data) { data.sensor_serials.pop_back(); }),
            "sensor_serials has 19 values, cycle has 20 (expected the same number)");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_campaign_test
