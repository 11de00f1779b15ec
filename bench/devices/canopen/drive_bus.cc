// SPDX-License-Identifier: Apache-2.0
#include "bench/devices/canopen/drive_bus.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace strainwave::bench {

using protocols::CanFrame;
using protocols::canopen::NmtState;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

namespace {

const std::vector<CanopenServoSettings>& Checked(const std::vector<CanopenServoSettings>& drives) {
  if (drives.empty()) throw std::invalid_argument("drives is empty (a bus must have at least one)");
  for (std::size_t i = 1; i < drives.size(); ++i) {
    const CanopenServoSettings& first = drives.front();
    const CanopenServoSettings& drive = drives[i];
    for (std::size_t j = 0; j < i; ++j) {
      if (drives[j].node_id == drive.node_id) {
        throw std::invalid_argument(fmt::format("node_id = {} of the {} is that of the {} (must be its own)",
                                                drive.node_id, drive.name, drives[j].name));
      }
    }
    if (drive.profile.timing.sync_period != first.profile.timing.sync_period) {
      throw std::invalid_argument(fmt::format(
          "sync_period of the {} differs from that of the {} (must be the same)", drive.name, first.name));
    }
    if (drive.profile.supervision.master_node_id != first.profile.supervision.master_node_id) {
      throw std::invalid_argument(fmt::format(
          "master_node_id of the {} differs from that of the {} (must be the same)", drive.name, first.name));
    }
  }
  return drives;
}

// Twice in the shortest period that a drive was told to expect: one lost heartbeat stops nothing.
nanoseconds HeartbeatPeriod(const std::vector<CanopenServoSettings>& drives) {
  nanoseconds shortest = nanoseconds::max();
  for (const CanopenServoSettings& drive : drives) {
    shortest = std::min<nanoseconds>(shortest, milliseconds(drive.profile.supervision.master_heartbeat_ms));
  }
  return shortest;
}

}  // namespace

DriveBus::DriveBus(CanBus& bus, const BenchClock& clock, std::vector<CanopenServoSettings> drives,
                   std::function<bool()> held, std::function<bool()> others_supervised)
    : bus_(bus),
      held_(std::move(held)),
      others_supervised_(std::move(others_supervised)),
      sync_period_(Checked(drives).front().profile.timing.sync_period),
      heartbeat_(drives.front().profile.supervision.master_node_id, HeartbeatPeriod(drives)) {
  for (CanopenServoSettings& drive : drives) {
    servos_.push_back(std::make_unique<CanopenServo>(std::move(drive), clock));
  }
}

void DriveBus::ReceiveAll() noexcept {
  ReceivedFrame received;
  while (bus_.Receive(received)) {
    ++next_counts_.received;
    for (const auto& servo : servos_) servo->master().OnFrame(received.frame, received.time);
  }
}

bool DriveBus::Send(const CanFrame& frame, nanoseconds now) noexcept {
  switch (bus_.Send(frame)) {
    case CanBus::Sent::kQueued:
      ++next_counts_.sent;
      return true;
    case CanBus::Sent::kFull:
      for (const auto& servo : servos_) servo->master().OnTransmitFull(now);
      return false;
    case CanBus::Sent::kDown:
      for (const auto& servo : servos_) servo->master().OnBusOff(now);
      return false;
  }
  return false;
}

void DriveBus::SendAll(nanoseconds now) noexcept {
  // Purged before anything new goes out, whichever drive it was that stopped.
  bool purge = false;
  for (const auto& servo : servos_) purge = servo->master().TakePurge() || purge;
  if (purge) bus_.PurgeTransmit();
  for (const auto& servo : servos_) {
    while (const auto frame = servo->master().NextFrame(now)) {
      if (!Send(*frame, now)) return;
    }
  }
}

void DriveBus::TakeOrdersOfAll(nanoseconds now) noexcept {
  const bool held = held_ && held_();
  bool supervised = !others_supervised_ || others_supervised_();
  for (const auto& servo : servos_) supervised = supervised && servo->master().is_supervised();
  for (const auto& servo : servos_) {
    servo->Hold(CanopenServo::Holder::kPendant, held);
    servo->TakeOrders(now, supervised);
  }
}

bool DriveBus::IsSupervised() const noexcept {
  return std::ranges::all_of(servos_, [](const auto& servo) { return servo->report().supervised; });
}

void DriveBus::TakeOrders(nanoseconds now) noexcept {
  ReceiveAll();
  TakeOrdersOfAll(now);
  SendAll(now);
  Publish();
}

void DriveBus::Cycle(nanoseconds now) noexcept {
  ReceiveAll();
  TakeOrdersOfAll(now);
  bool silent = false;
  for (const auto& servo : servos_) {
    silent = silent || servo->master().stage() == protocols::canopen::DriveStage::kSilent;
  }
  // To measure how the drives stop by themselves, the whole bus falls silent.
  if (!silent) {
    for (const auto& servo : servos_) servo->master().OnSync(now);
    // All masters see the same SYNCs.
    if (measure_anew_.exchange(false)) (void)servos_.front()->master().TakeSyncIntervals();
    sync_intervals_.Set(servos_.front()->master().sync_intervals());
    if (const auto frame = heartbeat_.Poll(now)) Send(*frame, now);
  }
  for (const auto& servo : servos_) servo->master().Poll(now);
  SendAll(now);
  // Set-points are in the drives when SYNC makes them valid.
  if (!silent) Send(sync_.Next(), now);
  Publish();
}

void DriveBus::Publish() noexcept {
  next_counts_.lost = bus_.lost_frames();
  next_counts_.state = bus_.state();
  next_counts_.worst_state = std::max(next_counts_.worst_state, next_counts_.state);
  next_counts_.malformed = 0;
  for (const auto& servo : servos_) {
    servo->Publish();
    next_counts_.malformed += servo->master().malformed_frames();
  }
  counts_.Set(next_counts_);
}

}  // namespace strainwave::bench
