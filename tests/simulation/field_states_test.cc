// SPDX-License-Identifier: Apache-2.0
// What a bench of metal says of itself, in its table and in notes. Its metal is the device side within the
// program.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "bench/configuration/read_bench_file.h"
#include "bench/machines/device_side/device_side.h"
#include "bench/machines/field/field_machine.h"
#include "tests/checkout.h"
#include "tests/simulation/bench_fixture.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_states_test {
namespace {

BenchDescription Bench() {
  return ReadBenchFile(std::filesystem::path(SourceFolder()) / "tests/simulation/field/bench.yaml");
}

TEST(FieldStates, TellsOfFramesThatAreNotAsTheyMustBe) {
  FieldMachine machine(Bench(), 80.0, {});
  machine.device_side()->Do("drive 1 short-pdo on");
  constexpr const char* kWords = "PDOs of its drives were not as long as their mapping is";
  const auto bus = [&] { return machine.States().front(); };
  Until([&] { return !bus().good; });
  EXPECT_EQ(bus().device, "can");
  EXPECT_NE(bus().state.find(kWords), std::string::npos) << bus().state;
  const auto told = [&] {
    return std::ranges::count_if(machine.TakeNotes(), [](const std::string& note) {
      return note.starts_with("can: ") && note.ends_with(kWords);
    });
  };
  EXPECT_EQ(told(), 1);
  EXPECT_EQ(told(), 0) << "once a campaign";
}

// Point 8 of the master's requirements.
TEST(FieldStates, NotesHowFarApartItsSyncsWere) {
  FieldMachine machine(Bench(), 80.0, {});
  const auto next = [&] {
    std::vector<std::string> notes;
    Until([&] {
      notes = machine.TakeNotes();
      return !notes.empty();
    });
    return notes;
  };
  for (int phases = 0; phases < 2; ++phases) {
    const std::vector<std::string> notes = next();
    ASSERT_EQ(notes.size(), 1U) << notes.back();
    unsigned syncs = 0;
    double mean_ms = 0.0;
    double min_ms = 0.0;
    double max_ms = 0.0;
    double asked_ms = 0.0;
    ASSERT_EQ(std::sscanf(notes[0].c_str(),
                          "can: %u SYNCs, %lf ms apart (mean; from %lf to %lf ms; %lf ms asked for)", &syncs,
                          &mean_ms, &min_ms, &max_ms, &asked_ms),
              5)
        << notes[0];
    EXPECT_GT(syncs, 0U);
    EXPECT_EQ(asked_ms, 4.0);
    EXPECT_LE(min_ms, mean_ms);
    EXPECT_LE(mean_ms, max_ms);
  }
}

// Point 14 of the master's requirements.
TEST(FieldStates, ShowsBrakeAndSafeTorqueOffOfItsDrives) {
  FieldMachine machine(Bench(), 80.0, {});
  BenchDevices devices = machine.Devices();
  using Facts = std::vector<std::pair<std::string, std::string>>;
  const auto facts = [&] {
    const auto states = machine.States();
    const auto driving =
        std::ranges::find_if(states, [](const auto& row) { return row.device.starts_with("driving servo"); });
    const Facts& all = driving->facts;
    return Facts{all.begin(), all.begin() + 2};
  };
  const auto become = [&](const char* brake, const char* torque_off) {
    Until([&] { return facts() == Facts{{"brake", brake}, {"safe_torque_off", torque_off}}; });
  };
  become("on", "closed");
  devices.driving.Enable(DriveMode::kSpeed);
  Until([&] { return BroughtUp(devices.driving); });
  become("off", "closed");
  machine.device_side()->Do("drive 1 sto on");
  become("on", "open");
  machine.device_side()->Do("drive 1 silent on");
  become("not known", "not known");
}

}  // namespace
}  // namespace strainwave::bench::field_states_test
