// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/drive_bus_thread.h"

#include <vector>

#include <fmt/format.h>

#include "bench/realtime/realtime.h"

namespace strainwave::bench {

using protocols::canopen::DriveStage;
using protocols::canopen::DriveTrouble;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

namespace {

constexpr milliseconds kLook{5};            // how often a person's wait looks again
constexpr nanoseconds kToRest{seconds(3)};  // at the end of the program

}  // namespace

DriveBusThread::DriveBusThread(DriveBus& bus, const BenchClock& clock)
    : bus_(bus), clock_(clock), thread_([this] { Run(); }) {
  for (std::size_t i = 0; i < bus_.size(); ++i) bus_.servo(i).CallOnStop(&wake_);
}

DriveBusThread::~DriveBusThread() { End(); }

void DriveBusThread::End() noexcept {
  if (!thread_.joinable()) return;
  ending_ = true;
  wake_.Call();
  thread_.join();
  for (std::size_t i = 0; i < bus_.size(); ++i) bus_.servo(i).CallOnStop(nullptr);
}

bool DriveBusThread::AtRest() const noexcept {
  for (std::size_t i = 0; i < bus_.size(); ++i) {
    switch (bus_.servo(i).report().stage) {
      case DriveStage::kOff:
      case DriveStage::kCommissioning:
      case DriveStage::kStarting:
      case DriveStage::kDisabled:
      case DriveStage::kStopped:
      case DriveStage::kSilent:
        break;
      case DriveStage::kChangingMode:
      case DriveStage::kRaising:
      case DriveStage::kEnabled:
      case DriveStage::kStopping:
      case DriveStage::kResetting:
        return false;
    }
  }
  return true;
}

void DriveBusThread::Run() noexcept {
  timing_.trouble = BecomeRealtime(RealtimeRank::kBus);
  nanoseconds last = clock_.Now();
  nanoseconds next = last;
  nanoseconds give_up = nanoseconds::max();
  while (true) {
    nanoseconds now = clock_.Now();
    while (now < next) {
      wake_.Wait(next - now);
      now = clock_.Now();
      if (wake_.Take() && now < next) bus_.TakeOrders(now);
    }
    timing_.lateness.Add(now - next);
    timing_.periods.Add(now - last);
    last = now;
    bus_.Cycle(now);
    if (ending_ && give_up == nanoseconds::max()) {
      for (std::size_t i = 0; i < bus_.size(); ++i)
        bus_.servo(i).Hold(CanopenServo::Holder::kEndOfProgram, true);
      give_up = now + kToRest;
      bus_.TakeOrders(now);
    }
    if (ending_ && (AtRest() || now > give_up)) return;
    // After a hold-up one cycle runs at once, not all that were missed: SYNC keeps its raster.
    next += bus_.sync_period();
    if (next < now) next += (now - next) / bus_.sync_period() * bus_.sync_period();
  }
}

std::string DriveBusThread::Commission(nanoseconds patience, Faults faults) {
  const nanoseconds give_up = clock_.Now() + patience;
  std::vector<std::uint32_t> asked;
  for (std::size_t i = 0; i < bus_.size(); ++i) asked.push_back(bus_.servo(i).Commission());
  std::string troubles;
  for (std::size_t i = 0; i < bus_.size(); ++i) {
    CanopenServo& servo = bus_.servo(i);
    ServoReport report = servo.report();
    const auto begun = [&] { return report.commissions == asked[i]; };
    bool may_reset = faults == Faults::kReset;
    while (!(begun() && (report.stage == DriveStage::kDisabled || report.stage == DriveStage::kOff)) &&
           clock_.Now() < give_up) {
      // In the drive's own state it is seen first when it has been set up. One that lasts comes back.
      if (may_reset && begun() && report.stage == DriveStage::kStopped &&
          report.trouble == DriveTrouble::kFault) {
        servo.ResetFault();
        may_reset = false;
      }
      std::this_thread::sleep_for(kLook);
      report = servo.report();
    }
    if (begun() && report.stage == DriveStage::kDisabled) continue;
    const std::string words = report.words.data();
    if (!troubles.empty()) troubles += '\n';
    troubles += fmt::format("{}: {}", servo.name(),
                            words.empty() ? fmt::format("not ready after {} of {} steps of its set-up",
                                                        report.steps_done, report.steps)
                                          : words);
  }
  return troubles;
}

}  // namespace strainwave::bench
