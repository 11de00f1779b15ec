// SPDX-License-Identifier: Apache-2.0
// What a person says to the devices wrongly is answered with what was expected.
#include <filesystem>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "bench/configuration/read_bench_file.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/machines/field/field_machine.h"
#include "tests/checkout.h"

namespace strainwave::bench::device_commands_test {
namespace {

TEST(DeviceCommands, SayWhatWasExpected) {
  FieldMachine machine(
      ReadBenchFile(std::filesystem::path(SourceFolder()) / "tests/simulation/field/bench.yaml"), 80.0, {});
  DeviceSide& devices = *machine.device_side();
  const auto answer = [&](const std::string& command) -> std::string {
    try {
      return devices.Do(command);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  EXPECT_EQ(answer("drive 1 position"), "expected counts from -2147483648 to 2147483647");
  EXPECT_EQ(answer("drive 1 position far"), "expected counts from -2147483648 to 2147483647");
  EXPECT_EQ(answer("drive 1 position 2147483648"), "expected counts from -2147483648 to 2147483647");
  EXPECT_EQ(answer("sensor drift 3 quickly"), "expected an amount a second");
  EXPECT_EQ(answer("sensor drift 3 0.5x"), "expected an amount a second");
  EXPECT_EQ(answer("drive 1 heartbeat maybe"), "expected on or off");
  EXPECT_EQ(answer("drive 9 silent on"), "expected a drive's node or name, not 9");
  EXPECT_EQ(answer("turn"), "expected drive, modbus, stream, sensor, gear, blank or load");
  EXPECT_EQ(answer("drive 1 position -2147483648"), "done");
  EXPECT_EQ(answer("sensor drift 3 -0.5"), "done");
}

}  // namespace
}  // namespace strainwave::bench::device_commands_test
