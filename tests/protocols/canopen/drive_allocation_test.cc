// SPDX-License-Identifier: Apache-2.0
// In an executable of its own, as it counts every allocation in it.
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "tests/protocols/canopen/scripted_drive.h"

namespace {
std::size_t allocations = 0;
}

void* operator new(std::size_t size) {
  ++allocations;
  if (void* const memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace strainwave::protocols::canopen::drive_allocation_test {
namespace {

TEST(DriveMaster, AllocatesNothingInACycleFromEnableOverAStopToAReset) {
  using namespace std::chrono_literals;
  for (const OperationMode mode : EasyProfile().modes) {
    DriveBench bench;
    ASSERT_TRUE(bench.BringUp());
    DriveMaster& master = bench.master;
    std::chrono::nanoseconds now = bench.now;
    const CanFrame emergency = Frame("083#1086210102030405");
    const std::size_t before = allocations;
    bool was_enabled = false;
    master.Enable(mode, now);
    for (int i = 0; i < 400; ++i) {
      now += 4ms;
      if (i % 10 == 0) master.OnFrame(bench.drive.Heartbeat(), now);
      master.OnFrame(bench.drive.Status(), now);
      master.OnFrame(bench.drive.Motion(), now);
      master.OnFrame(bench.drive.Torque(), now);
      master.CommandSpeed(10.0);
      master.CommandPosition(1.0);
      master.CommandTorque(0.1);
      was_enabled = was_enabled || master.stage() == DriveStage::kEnabled;
      if (i == 100) master.OnFrame(emergency, now);
      if (i == 300) master.ResetFault(now);
      master.OnSync(now);
      master.Poll(now);
      while (const auto frame = master.NextFrame(now)) bench.drive.OnFrame(*frame);
    }
    const std::size_t after = allocations;
    EXPECT_EQ(after, before) << Name(mode);
    EXPECT_TRUE(was_enabled);
    EXPECT_EQ(master.stage(), DriveStage::kDisabled);
  }
}

}  // namespace
}  // namespace strainwave::protocols::canopen::drive_allocation_test
