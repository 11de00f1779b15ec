// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/modbus/modbus_channels.h"

#include <gtest/gtest.h>

#include <array>

#include "bench/configuration/read_register_map.h"
#include "bench/machines/device_side/modbus_device.h"
#include "tests/bench/modbus/modbus_helpers.h"
#include "tests/checkout.h"

namespace strainwave::bench::modbus_channels_test {
namespace {

using namespace std::chrono_literals;

// A device of a shipped profile, whose registers hold what the test says.
struct Shipped {
  explicit Shipped(const std::string& file)
      : map(ReadModbusProfile(SourceFolder() + "/bench/devices/profiles/" + file).map) {
    settings.port = ModbusTcpPort{"127.0.0.1", device.port()};
  }

  SteadyBenchClock clock;
  protocols::modbus::RegisterMap map;
  std::array<std::atomic<double>, 8> values{};
  ModbusDevice device{map,
                      1,
                      {[this](std::size_t index) { return values[index].load(); },
                       [this](std::size_t index, double value) { return values[index] = value, true; }},
                      ModbusDevice::Tcp{}};
  ModbusSettings settings;
};

TEST(ModbusTorqueAmplifier, GivesATorqueOnlyWhileItsStatusIsGood) {
  Shipped shipped("modbus_torque_amplifier.yaml");
  shipped.values[0] = -41.5;
  shipped.device.Set({ModbusDeviceFault::Kind::kSilence});
  ModbusTorqueAmplifier amplifier(shipped.settings, shipped.map, shipped.clock);
  EXPECT_FALSE(amplifier.Torque().good);
  shipped.device.Set({});
  ASSERT_TRUE(Until([&] { return amplifier.Torque().good; })) << amplifier.trouble();
  EXPECT_EQ(amplifier.Torque().value, -41.5);
  EXPECT_LE(amplifier.Torque().time, shipped.clock.Now());
  shipped.values[0] = 150.0;  // beyond what the transducer can show
  EXPECT_TRUE(Until([&] { return !amplifier.Torque().good; }));
  shipped.values[0] = 3.25;
  ASSERT_TRUE(Until([&] { return amplifier.Torque().good; }));
  shipped.device.Set({ModbusDeviceFault::Kind::kException});
  EXPECT_TRUE(Until([&] { return !amplifier.Torque().good; }));
}

TEST(ModbusTorqueAmplifier, BelievesNoTorqueBesideABadStatus) {
  Shipped shipped("modbus_torque_amplifier.yaml");
  protocols::modbus::RegisterMap any_status = shipped.map;
  any_status.registers[1].most.reset();
  ModbusDevice device(any_status, 1,
                      {[&](std::size_t index) { return shipped.values[index].load(); },
                       [](std::size_t, double) { return false; }},
                      ModbusDevice::Tcp{});
  shipped.settings.port = ModbusTcpPort{"127.0.0.1", device.port()};
  ModbusTorqueAmplifier amplifier(shipped.settings, shipped.map, shipped.clock);
  ASSERT_TRUE(Until([&] { return amplifier.Torque().good; }));
  shipped.values[1] = 4;  // a wire of the bridge is broken
  EXPECT_TRUE(Until([&] { return !amplifier.Torque().good; }));
}

TEST(ModbusTemperatureController, HeatsWhenToldAndNeverAfterwards) {
  Shipped shipped("modbus_temperature_controller.yaml");
  shipped.values[0] = 24.5;
  shipped.values[1] = 20.0;
  shipped.values[2] = 1.0;
  {
    ModbusTemperatureController controller(shipped.settings, shipped.map, shipped.clock, 10ms);
    ASSERT_TRUE(Until([&] { return shipped.values[2] == 0.0; })) << "off at the start";
    ASSERT_TRUE(Until([&] { return controller.Temperature().good; })) << controller.trouble();
    EXPECT_EQ(controller.Temperature().value, 24.5);
    controller.Heat(60.5);
    ASSERT_TRUE(Until([&] { return shipped.values[2] == 1.0 && shipped.values[1] == 60.5; }));
    ASSERT_TRUE(Until([&] { return controller.SetPoint().value == 60.5; }));
    controller.Stop();
    ASSERT_TRUE(Until([&] { return shipped.values[2] == 0.0; }));
    controller.Heat(60.5);
    ASSERT_TRUE(Until([&] { return shipped.values[2] == 1.0; }));
    try {
      controller.Heat(130.0);
      FAIL();
    } catch (const std::invalid_argument& error) {
      EXPECT_STREQ(error.what(), "set_point_degC = 130 is not one that generic temperature controller takes");
    }
  }
  EXPECT_EQ(shipped.values[2], 0.0) << "gone, and still heating";
}

TEST(ModbusTemperatureController, RefusesTheMapOfAnotherDevice) {
  Shipped shipped("modbus_torque_amplifier.yaml");
  try {
    ModbusTemperatureController controller(shipped.settings, shipped.map, shipped.clock);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "map of generic torque-transducer amplifier has no register 'temperature' (expected one in 'degC' "
        "that is polled)");
  }
}

}  // namespace
}  // namespace strainwave::bench::modbus_channels_test
