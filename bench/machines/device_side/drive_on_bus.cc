// SPDX-License-Identifier: Apache-2.0
#include "bench/machines/device_side/drive_on_bus.h"

namespace strainwave::bench {

void DriveOnBus::Cycle(std::chrono::nanoseconds now) noexcept {
  TakeFrames(now);
  node_.Poll(now);
  GiveFrames();
}

void DriveOnBus::TakeFrames(std::chrono::nanoseconds now) noexcept {
  ReceivedFrame received;
  while (bus_.Receive(received)) {
    if (received.frame.error) continue;
    ++received_;
    node_.OnFrame(received.frame, now);
    // An answer goes out before the next request is looked at, as the server has one only.
    GiveFrames();
  }
  const CanState state = bus_.state();
  node_.SetBusOff(state == CanState::kBusOff || state == CanState::kGone);
}

void DriveOnBus::GiveFrames() noexcept {
  if (!waits_) waits_ = node_.Next(waiting_);
  while (waits_ && bus_.Send(waiting_) == CanBus::Sent::kQueued) {
    ++sent_;
    waits_ = node_.Next(waiting_);
  }
}

}  // namespace strainwave::bench
