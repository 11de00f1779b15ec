// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/generated_loop.h"

// Under torque of one sign a brake that slips leaves the angle behind in steps, which over a loop or two go
// much as a drift by time goes.
namespace strainwave::analysis::diagnosis::diagnosis_slip_or_drift_test {
namespace {

constexpr double kPeak_Nm = 34.0;

Diagnosed Ask(GeneratedSensors sensors, int loops, std::uint32_t seed) {
  sensors.torque_noise_Nm = 0.0;
  std::vector<PathLeg> path = Loops(loops, {{.to_Nm = kPeak_Nm, .rate_Nm_per_s = 1.5}});
  path.push_back({.to_Nm = kPeak_Nm, .rate_Nm_per_s = 1.5});
  return DiagnoseLoop({}, sensors, path, 3000, seed);
}

// Slips under positive torque alone, the faster the more it is loaded beyond a level.
struct Slip {
  double level_Nm{};
  double fastest_rad_per_s{};  // at the peak
};

Diagnosed AskOfSlip(const Slip& slip, int loops, std::uint32_t seed, bool has_temperature = true) {
  const double speed_rad_per_Nms = slip.fastest_rad_per_s / (kPeak_Nm - slip.level_Nm);
  double before_s = 0.0;
  double slip_rad = 0.0;
  GeneratedSensors sensors;
  sensors.has_temperature = has_temperature;
  sensors.unlisted_rad = [&](double time_s, double torque_Nm, double, bool) {
    slip_rad += speed_rad_per_Nms * (time_s - before_s) * std::max(torque_Nm - slip.level_Nm, 0.0);
    before_s = time_s;
    return slip_rad;
  };
  return Ask(sensors, loops, seed);
}

// The fit ends where the range of its level begins.
TEST(SlipOrDrift, NamesASlipThatBeginsEarly) {
  for (const std::uint32_t seed : {2U, 3U, 4U})
    EXPECT_EQ(AskOfSlip({12.0, 2.8e-7}, 1, seed).names(), Names{"brake_slip"}) << seed;
}

// So small that a drift by time does as well; but what warms up would go with the temperature.
TEST(SlipOrDrift, NamesASlipWhereTheTemperatureGoesAnotherWay) {
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U, 5U}) {
    const Diagnosed found = AskOfSlip({24.0, 0.8e-7}, 2, seed);
    ASSERT_EQ(found.names(), Names{"brake_slip"}) << seed;
    EXPECT_EQ(found.diagnosis.causes.front().indistinguishable_from, Names{"thermal_drift"}) << seed;
  }
}

// Where nobody kept the temperature both explain nearly the same. A slip that grows with the excess is what
// brakes do, so that it need not be much ahead; one that only a rarer form explains would have to be.
TEST(SlipOrDrift, TellsThemApartWithoutATemperature) {
  for (const std::uint32_t seed : {1U, 2U, 3U, 4U}) {
    EXPECT_EQ(AskOfSlip({24.0, 0.8e-7}, 2, seed, false).names(), Names{"brake_slip"}) << seed;
    GeneratedSensors sensors;
    sensors.drift_rad = [](double time_s, double) { return 0.3e-7 * time_s; };
    EXPECT_EQ(Ask(sensors, 2, seed).names(), Names{"thermal_drift"}) << seed;
  }
}

// A part that is warmed elsewhere than where the temperature was taken.
TEST(SlipOrDrift, NamesADriftByTimeBesideATemperature) {
  GeneratedSensors sensors;
  sensors.has_temperature = true;
  sensors.drift_rad = [](double time_s, double) { return 2e-7 * time_s; };
  EXPECT_EQ(Ask(sensors, 2, 1).names(), Names{"thermal_drift"});
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_slip_or_drift_test
