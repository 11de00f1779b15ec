// SPDX-License-Identifier: Apache-2.0
// Effects so large that what a formula leaves of them would do for another one.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "analysis/units.h"
#include "tests/analysis/diagnosed_loop.h"

namespace strainwave::analysis::diagnosis::diagnosis_noisy_loop_test {
namespace {

const std::vector<PathLeg>& Held() {
  static const std::vector<PathLeg> path = Loops(2, {{34.0, 10.0, 20.0}, {0.0, 10.0, 0.0}});
  return path;
}

// A mount that yields with time constants from 0.2 to 12.8 s, each twice the last, in step with the samples.
class YieldingMount {
 public:
  double operator()(double time_s, double torque_Nm, double, bool) {
    const double step_s = time_s - time_s_;
    double yielded_rad = 0.0;
    double time_constant_s = 0.2;
    for (double& part_Nm : parts_Nm_) {
      const double gone = -std::expm1(-step_s / time_constant_s);
      part_Nm += gone * (0.5 * (torque_Nm + torque_Nm_) - part_Nm);
      yielded_rad += 4e-7 * part_Nm;
      time_constant_s *= 2.0;
    }
    time_s_ = time_s;
    torque_Nm_ = torque_Nm;
    return yielded_rad;
  }

 private:
  double time_s_{};
  double torque_Nm_{};
  std::array<double, 7> parts_Nm_{};
};

// Neither one of them nor a logarithm that goes on: what these leave would do for a drift or a slip.
TEST(NoisyLoop, NamesOnlyACreepThatEnds) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Diagnosed found = DiagnoseLoop(
        {}, {.angle_noise_rad = RadFromArcmin(0.008), .unlisted_rad = YieldingMount()}, Held(), 2500, seed);
    EXPECT_EQ(found.names(), Names{"creep"}) << seed;
    // Half an octave more to either side.
    const ParameterValue from_s = found.value("time_constant_s");
    const ParameterValue to_s = found.value("longest_time_constant_s");
    const ParameterValue all = found.value("creep_arcmin_per_Nm");
    EXPECT_NEAR(from_s.value, 0.2 / std::sqrt(2.0), 3.0 * from_s.standard_error) << seed;
    EXPECT_NEAR(to_s.value, 12.8 * std::sqrt(2.0), 3.0 * to_s.standard_error) << seed;
    EXPECT_NEAR(all.value, ArcminFromRad(2.8e-6), 3.0 * all.standard_error) << seed;
    EXPECT_LT(to_s.standard_error, 0.1 * to_s.value) << seed;
  }
}

// A gap beside its place: neither the gap in the middle nor the shift alone explains any of it.
TEST(NoisyLoop, NamesABacklashBesideAShiftedTorque) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    const Diagnosed found = DiagnoseLoop(
        {.friction_Nm = {1.3}, .yield_rad = {1.5e-4}, .outside_dead_zone_rad = RadFromArcmin(1.2)},
        {.torque_offset_Nm = -0.4, .angle_noise_rad = RadFromArcmin(0.03)},
        Loops(2, {{32.0, 12.0, 0.0}, {0.0, 12.0, 0.0}}), 6000, seed);
    Names names = found.names();
    std::ranges::sort(names);
    EXPECT_EQ(names, (Names{"backlash", "torque_zero_offset"})) << seed;
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_noisy_loop_test
