// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/analysis/diagnosed_campaign.h"

namespace strainwave::analysis::diagnosis::diagnosis_campaign_power_test {
namespace {

int CountOnly(const std::string& name, unsigned first_seed, unsigned seeds, std::size_t cycles,
              const Hide& hide) {
  int count = 0;
  std::map<std::string, int> others;
  for (unsigned seed = first_seed; seed < first_seed + seeds; ++seed) {
    const Case result = DiagnosedCampaign(seed, cycles, hide);
    if (result.Only(name)) {
      ++count;
    } else {
      std::string named = result.diagnosis.verdict == Verdict::kNoEffect ? "no effect" : "unnamed";
      for (const std::string& other : result.Names()) named += ", " + other;
      ++others[named];
    }
  }
  for (const auto& [named, times] : others) {
    ::testing::Test::RecordProperty(name + " taken for " + named, times);
  }
  return count;
}

int CountFindingsInWearAlone(unsigned first_seed, unsigned seeds) {
  int anything = 0;
  for (unsigned seed = first_seed; seed < first_seed + seeds; ++seed) {
    const Case result = DiagnosedCampaign(seed, 100, [](CampaignDrawing&, double, std::size_t, Random&) {});
    anything += result.diagnosis.verdict == Verdict::kNoEffect ? 0 : 1;
  }
  return anything;
}

// The family error is 0.5 %; two of 20 would be met once in 200 times at that rate.
TEST(CampaignPower, FindsNothingInWearAlone) { EXPECT_LE(CountFindingsInWearAlone(2001, 20), 1); }

// Four of 120 would be met once in 2000 times.
TEST(CampaignPowerAtLength, FindsNothingInWearAlone) { EXPECT_LE(CountFindingsInWearAlone(2001, 120), 3); }

TEST(CampaignPowerAtLength, FindsNothingWhereASensorWasReplacedOrARunPausedWithoutAMark) {
  int anything = 0;
  for (unsigned seed = 2201; seed <= 2240; ++seed) {
    const Case result =
        DiagnosedCampaign(seed, 100, [](CampaignDrawing& drawing, double from, std::size_t, Random&) {
          drawing.ReplaceSensor(static_cast<std::size_t>(from) - 1);
          drawing.AddPause(0, static_cast<std::size_t>(0.5 * from), 30.0, 0.0, 1.0);
        });
    anything += result.diagnosis.verdict == Verdict::kNoEffect ? 0 : 1;
  }
  EXPECT_LE(anything, 2);
}

TEST(CampaignPowerAtLength, NamesAStepOfOneSeriesWithItsCycleAndSize) {
  int named = 0;
  int at_cycle = 0;
  int size_inside = 0;
  constexpr int kSeeds = 30;
  const double size = 4.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Case result =
        DiagnosedCampaign(seed, 120, [&](CampaignDrawing& drawing, double from, std::size_t series, Random&) {
          drawing.AddStep(series, from, size);
        });
    if (!result.Only("step_change")) continue;
    ++named;
    const std::string name = "step_" + CampaignDrawing(1, 12).data.series[result.series].name;
    const ParameterValue cycle = result.Parameter("cycle");
    const ParameterValue step = result.Parameter(name);
    at_cycle +=
        std::abs(cycle.value - result.from_cycle) <= std::max(1.0, 2.0 * cycle.standard_error) ? 1 : 0;
    size_inside += std::abs(step.value - size * result.scatter) < 1.96 * step.standard_error ? 1 : 0;
  }
  EXPECT_GE(named, kSeeds - 1);
  EXPECT_GE(at_cycle, named - 2);
  EXPECT_GE(size_inside, named - 5);  // 95 % of 30: five misses are met once in 60 times
}

TEST(CampaignPowerAtLength, NamesAStepOfManySeriesInOneCycle) {
  EXPECT_GE(CountOnly("step_change", 1, 24, 120,
                      [](CampaignDrawing& drawing, double from, std::size_t, Random& random) {
                        for (std::size_t s = 0; s < 6; ++s)
                          drawing.AddStep(s, from, Uniform(random, -5.0, 5.0));
                      }),
            23);
}

TEST(CampaignPower, NamesAChangeOfSlope) {
  EXPECT_GE(CountOnly("slope_change", 1, 24, 150,
                      [](CampaignDrawing& drawing, double from, std::size_t, Random& random) {
                        for (std::size_t s = 0; s < 6; ++s) {
                          drawing.AddSlope(s, from, (s < 3 ? -1.0 : 1.0) * Uniform(random, 15.0, 40.0));
                        }
                      }),
            20);
}

TEST(CampaignPower, NamesWhatFollowsTheTemperature) {
  int inside = 0;
  constexpr int kSeeds = 24;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Case result =
        DiagnosedCampaign(seed, 120, [](CampaignDrawing& drawing, double, std::size_t series, Random&) {
          drawing.AddTemperature(series, 0.8);
        });
    EXPECT_TRUE(result.Only("daily_temperature")) << "seed " << seed;
    const std::string name = CampaignDrawing(1, 12).data.series[result.series].name + "_per_K";
    const ParameterValue slope = result.Parameter(name);
    inside += std::abs(slope.value - 0.8 * result.scatter) < 1.96 * slope.standard_error ? 1 : 0;
  }
  EXPECT_GE(inside, 20);
}

TEST(CampaignPowerAtLength, NamesADailySwingWithoutAThermometer) {
  EXPECT_GE(CountOnly("daily_temperature", 1, 24, 120,
                      [](CampaignDrawing& drawing, double, std::size_t, Random& random) {
                        for (std::size_t s = 0; s < 6; ++s)
                          drawing.AddTemperature(s, Uniform(random, 0.4, 1.0));
                        drawing.data.temperature_degC.clear();
                      }),
            23);
}

TEST(CampaignPower, TellsAReplacedSensorFromAStepThreeCyclesLater) {
  const auto with_step_after = [](double cycles) {
    return [cycles](CampaignDrawing& drawing, double from, std::size_t series, Random&) {
      drawing.ReplaceSensor(static_cast<std::size_t>(from) - 1);
      drawing.AddStep(series, from + cycles, 5.0);
    };
  };
  EXPECT_GE(CountOnly("sensor_replaced", 1, 24, 120, with_step_after(0.0)), 23);
  EXPECT_GE(CountOnly("step_change", 1, 24, 120, with_step_after(3.0)), 22);
  const Case result = DiagnosedCampaign(1, 120, with_step_after(0.0));
  ASSERT_FALSE(result.diagnosis.causes.empty());
  const CauseRule& rule = result.study->causes()[result.diagnosis.causes[0].index];
  EXPECT_EQ(rule.where, Where::kBench);
  EXPECT_NE(rule.sentence.find("from torque 17, encoder 4 to torque 23, encoder 4"), std::string::npos)
      << rule.sentence;
}

TEST(CampaignPower, NamesWhatALongPauseLeaves) {
  EXPECT_GE(CountOnly("pause_recovery", 1, 24, 120,
                      [](CampaignDrawing& drawing, double from, std::size_t, Random& random) {
                        const auto row = static_cast<std::size_t>(0.5 * from);
                        const double size = Uniform(random, 5.0, 8.0);
                        for (std::size_t s = 0; s < 6; ++s) {
                          drawing.AddPause(s, row, 30.0, size, 3.0);
                          drawing.AddPause(s, row + 35, 40.0, size, 3.0);
                        }
                      }),
            21);
}

TEST(CampaignPower, LeavesADeviationThatPassesWithoutAName) {
  int unnamed = 0;
  constexpr int kSeeds = 24;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Case result =
        DiagnosedCampaign(seed, 120, [](CampaignDrawing& drawing, double from, std::size_t series, Random&) {
          drawing.AddStep(series, from, 5.0);
          drawing.AddStep(series, from + 12.0, -5.0);
        });
    unnamed += result.diagnosis.verdict == Verdict::kUnnamedStructure ? 1 : 0;
  }
  EXPECT_GE(unnamed, 20);
}

TEST(CampaignPower, TakesCyclesWithoutAValueAsGaps) {
  int named = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Case result = DiagnosedCampaign(
        seed, 120, [](CampaignDrawing& drawing, double from, std::size_t series, Random& random) {
          drawing.AddStep(series, from, 5.0);
          for (CampaignSeries& one : drawing.data.series) {
            for (double& value : one.value) {
              if (Uniform(random, 0.0, 1.0) < 0.15) value = std::numeric_limits<double>::quiet_NaN();
            }
          }
        });
    named += result.Only("step_change") ? 1 : 0;
  }
  EXPECT_GE(named, 9);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_campaign_power_test
