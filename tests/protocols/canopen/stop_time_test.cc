// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/stop_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace strainwave::protocols::canopen::stop_time_test {
namespace {

using namespace std::chrono_literals;
using State = StopTimeMeasurement::State;

// docs/requirements.md R14.
TEST(StopTimeMeasurement, TellsWhenTheDriveLeftOperationEnabledAndWhenItStood) {
  StopTimeMeasurement measurement(1s, 1.0, 50ms, 2s);
  measurement.OnPower(PowerState::kSwitchOnDisabled, 990ms);  // before
  for (int ms = 0; ms <= 500; ms += 10) {
    const auto time = 1s + ms * 1ms;
    measurement.OnPower(ms < 150 ? PowerState::kOperationEnabled : PowerState::kQuickStopActive, time);
    // From 100 rad/s down to zero between 150 and 350 ms: below 1 rad/s from 350 ms on in steps of 10 ms.
    measurement.OnSpeed(ms < 150 ? 100.0 : ms < 350 ? 100.0 * (350 - ms) / 200.0 : 0.0, time);
    EXPECT_EQ(measurement.Poll(time), ms < 400 ? State::kWaiting : State::kDone) << ms;
  }
  EXPECT_EQ(measurement.left_enabled_after(), 150ms);
  EXPECT_EQ(measurement.stood_after(), 350ms);
}

TEST(StopTimeMeasurement, TakesAPassThroughZeroForNoStandstill) {
  StopTimeMeasurement measurement(0s, 1.0, 50ms, 2s);
  measurement.OnPower(PowerState::kFault, 10ms);
  for (int ms = 0; ms <= 100; ms += 10) measurement.OnSpeed(50.0 - ms, ms * 1ms);
  EXPECT_EQ(measurement.Poll(100ms), State::kWaiting);
  for (int ms = 110; ms <= 200; ms += 10) measurement.OnSpeed(std::nan(""), ms * 1ms);
  EXPECT_EQ(measurement.Poll(200ms), State::kWaiting);
  measurement.OnSpeed(0.0, 210ms);  // through zero a second time
  EXPECT_EQ(measurement.Poll(210ms), State::kWaiting);
}

TEST(StopTimeMeasurement, SaysThatADriveDidNotStop) {
  StopTimeMeasurement measurement(0s, 1.0, 50ms, 2s);
  measurement.OnPower(PowerState::kOperationEnabled, 1s);
  for (int ms = 0; ms <= 1990; ms += 10) measurement.OnSpeed(0.0, ms * 1ms);
  EXPECT_EQ(measurement.Poll(1999ms), State::kWaiting);  // it stands, but is still enabled
  EXPECT_EQ(measurement.Poll(2s), State::kDidNotStop);
  EXPECT_FALSE(measurement.left_enabled_after().has_value());
}

TEST(StopTimeMeasurement, RefusesAThresholdThatIsNone) {
  EXPECT_THROW(StopTimeMeasurement(0s, 0.0, 50ms, 2s), std::invalid_argument);
  EXPECT_THROW(StopTimeMeasurement(0s, 1.0, 0ms, 2s), std::invalid_argument);
}

}  // namespace
}  // namespace strainwave::protocols::canopen::stop_time_test
