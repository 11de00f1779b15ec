// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daq/acquisition/calibration.h"

namespace strainwave::bench {

/// The calibration that a channel of the bench is read with.
struct ChannelCalibration {
  std::string channel;        // "output_torque", "accel_x", …
  std::string sensor_serial;  // of the sensor that is mounted
  std::string unit;           // of the calibrated value: "Nm", "deg", "m/s^2"
  daq::acquisition::Calibration calibration;
};

}  // namespace strainwave::bench
