// SPDX-License-Identifier: Apache-2.0
// A bench of metal, whose metal is the device side within the program: real protocols, real time.
#include "bench/devices/field/field_machine.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/campaign/campaign_error.h"
#include "bench/configuration/read_bench_file.h"
#include "tests/schedules/schedule_text.h"

namespace strainwave::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

std::filesystem::path Folder() {
  return std::filesystem::path(STRAINWAVE_SOURCE_DIR) / "tests/simulation/field";
}

std::string BenchText() {
  std::ifstream file(Folder() / "bench.yaml");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// Waits for what other threads bring about; the test's own time-out ends it where that never comes.
template <typename Condition>
void Until(Condition condition) {
  while (!condition()) std::this_thread::sleep_for(milliseconds(1));
}

TEST(FieldMachine, SetsUpDrivesAndReadsEveryChannel) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  Until([&] { return sampler.Read().bad_channels == 0; });
  const Readings readings = sampler.Read();
  EXPECT_NEAR(readings.gear_temperature_degC, 21.0, 3.0);
  EXPECT_NEAR(readings.output_torque_Nm, 0.0, 1.0);
  EXPECT_FALSE(readings.quick_stop_pressed);
  for (const auto& state : machine.States()) EXPECT_TRUE(state.good) << state.device << ": " << state.state;
  EXPECT_EQ(machine.Troubles(), "");
  EXPECT_EQ(machine.MissingForStart(), "");
  EXPECT_TRUE(machine.device_side()->StandsSafe());
}

TEST(FieldMachine, TurnsTheShaftAndSeesItTurn) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  BenchDevices devices = machine.Devices();
  Until([&] { return devices.sampler.Read().bad_channels == 0; });
  const double from_rad = devices.sampler.Read().input_angle_rad;
  devices.driving.Enable(DriveMode::kSpeed);
  devices.load.Enable(DriveMode::kTorque);
  Until([&] {
    const bool driving = BroughtUp(devices.driving);
    return BroughtUp(devices.load) && driving;
  });
  Until([&] {
    devices.driving.CommandSpeed(50.0);
    devices.load.CommandTorque(0.0);
    return devices.sampler.Read().input_angle_rad - from_rad > 40.0;
  });
  const Readings readings = devices.sampler.Read();
  EXPECT_NEAR(readings.input_speed_rad_per_s, 50.0, 2.0);
  EXPECT_NEAR(readings.output_angle_rad * 80.0, readings.input_angle_rad, 1.0);
  devices.driving.QuickStop();
  devices.load.QuickStop();
  Until([&] { return machine.device_side()->StandsSafe(); });
}

TEST(FieldMachine, RecordsVibrationWithoutALoss) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  Sampler& sampler = machine.Devices().sampler;
  VibrationBlock block;
  sampler.StartVibration(6400.0);
  Until([&] {
    sampler.DrainVibration(block);
    return block.accel_x_m_per_s2.size() >= 6400;
  });
  sampler.StopVibration();
  sampler.DrainVibration(block);
  EXPECT_EQ(block.lost_samples, 0U);
  EXPECT_EQ(block.accel_motor_z_m_per_s2.size(), block.accel_x_m_per_s2.size());
  double squares = 0.0;
  for (const float value : block.accel_x_m_per_s2)
    squares += static_cast<double>(value) * static_cast<double>(value);
  EXPECT_GT(squares, 0.0);
  EXPECT_THROW(sampler.StartVibration(5000.0), std::invalid_argument) << "not a whole part of 12.8 kHz";
}

TEST(FieldMachine, MountsTheBlankOfTheDeviceSideByItself) {
  FieldMachine machine(ReadBenchFile(Folder() / "bench.yaml"), 80.0, {});
  machine.MountBlank(true);
  machine.MountBlank(false);
}

std::string MessageOf(std::string_view from, std::string_view to) {
  try {
    const FieldMachine machine(ParseBenchFile(schedules::With(BenchText(), from, to), "real.yaml", Folder()),
                               80.0, {});
    return "";
  } catch (const CampaignError& error) {
    return error.what();
  }
}

TEST(FieldMachine, SaysWhatIsMissing) {
  EXPECT_EQ(MessageOf("interface: in_process", "interface: nocan7").substr(0, 17), "real.yaml: error:");
  EXPECT_EQ(
      MessageOf("source: torque_Nm", "source: torque_lbf"),
      "real.yaml: error: channel 'torque_lbf' does not end in its unit (must in _deg, _arcmin, _rad, _rpm, "
      "_rad_per_s, _Nm, _degC or _m_per_s2)");
  EXPECT_EQ(MessageOf("source: gear_temperature_degC", "source: oil_temperature_degC"),
            "real.yaml: error: line 50: device thermometers has no register oil_temperature_degC (must be "
            "one of its "
            "map)");
}

}  // namespace
}  // namespace strainwave::bench
