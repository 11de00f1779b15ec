// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/model/measuring_chain.h"
#include "analysis/model/vibration.h"
#include "analysis/units.h"

namespace strainwave::analysis::model::model_measuring_chain_test {
namespace {

TEST(OutputEncoder, StaysWithinItsAccuracyButForEccentricity) {
  Encoder encoder = DefaultOutputEncoder();
  encoder.eccentricity_rad = 0.0;
  double worst = 0.0;
  for (int i = 0; i < 3600; ++i) {
    const double angle = kTwoPi * i / 3600.0;
    worst = std::max(worst, std::abs(EncoderTurnError_rad(encoder, angle)) + encoder.interpolation_rad);
  }
  EXPECT_LT(ArcsecFromRad(worst), 2.5);
  EXPECT_GT(ArcsecFromRad(worst), 1.0);
}

TEST(TorqueTransducer, StaysWithinThreePerMilleOfFullScale) {
  TorqueTransducer transducer;
  for (const double gain : {-1e-3, 1e-3}) {  // two standard deviations
    transducer.gain_error = gain;
    for (double torque = -100.0; torque <= 100.0; torque += 1.0) {
      EXPECT_LT(std::abs(TransducerReading_Nm(transducer, torque, 22.0) - torque), 0.3);
    }
  }
}

TEST(TorqueTransducer, ShiftsItsZeroWithTemperature) {
  EXPECT_NEAR(TransducerReading_Nm({}, 0.0, 42.0) - TransducerReading_Nm({}, 0.0, 22.0), 0.08, 1e-12);
}

TEST(Vibration, RisesWithSpeedLoadAndWear) {
  const Vibration vibration;
  const auto level = [&](double speed, double torque, const WearState& wear) {
    return StrongestRms_m_per_s2(vibration, SourcesAt(vibration, {speed, torque, 40.0}, wear));
  };
  const double base = level(150.0, 20.0, {});
  EXPECT_GT(level(250.0, 20.0, {}), base);
  EXPECT_GT(level(150.0, 40.0, {}), base);
  EXPECT_GT(level(150.0, 20.0, {1.0, 0.8, 0.8, 0.6}), 1.1 * base);
  EXPECT_EQ(level(0.0, 40.0, {}), vibration.sensor_noise_m_per_s2);
}

}  // namespace
}  // namespace strainwave::analysis::model::model_measuring_chain_test
