// SPDX-License-Identifier: Apache-2.0
// Any traffic at the master of an enabled drive: after a trouble nothing moves the drive any more.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "tests/protocols/canopen/scripted_drive.h"

using namespace strainwave::protocols;
using namespace strainwave::protocols::canopen;
using namespace std::chrono_literals;

namespace {

const std::vector<DriveBench>& EnabledInEachMode() {
  static const std::vector<DriveBench> benches = [] {
    std::vector<DriveBench> all;
    for (const OperationMode mode : EasyProfile().modes) {
      if (!all.emplace_back().BringUp(mode)) std::abort();
    }
    return all;
  }();
  return benches;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span<const std::uint8_t> input(data, size);
  if (input.empty()) return 0;
  const std::vector<DriveBench>& ready = EnabledInEachMode();
  DriveBench bench = ready[input[0] % ready.size()];
  bench.master.CommandSpeed(50.0);
  bench.master.CommandTorque(0.5);
  bench.master.CommandPosition(1.0);
  input = input.subspan(1);
  constexpr std::uint32_t kIds[] = {0x000, 0x080, 0x083, 0x183, 0x283, 0x383, 0x583, 0x703};
  while (input.size() >= 10) {
    const std::uint8_t kind = input[0];
    CanFrame frame{.id = kIds[kind % 8], .length = static_cast<std::uint8_t>(input[1] % 16)};
    frame.error = kind >= 0xF0;
    frame.remote = kind / 8 % 16 == 15;
    std::copy_n(input.begin() + 2, 8, frame.data.begin());
    bench.master.OnFrame(frame, bench.now);
    if (kind / 8 % 4 == 3) bench.Cycle();
    input = input.subspan(10);
    if (bench.master.trouble() == DriveTrouble::kNone) continue;
    bench.Forget();
    bench.Deliver();
    bench.Cycle();
    if (bench.master.stage() == DriveStage::kEnabled) std::abort();
    for (const std::string& text : bench.sent) {
      // Neither operation enabled (bit 3) nor a fault reset, nor a speed or torque.
      const CanFrame sent = Frame(text);
      if (sent.id == 0x203 && (sent.data[0] & 0x88) != 0) std::abort();
      if (sent.id == 0x303 &&
          std::any_of(sent.data.begin() + 4, sent.data.end(), [](auto b) { return b != 0; })) {
        std::abort();
      }
      if (sent.id == 0x403 && (sent.data[0] != 0 || sent.data[1] != 0)) std::abort();
    }
  }
  return 0;
}
