// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/node_pdos.h"

#include <algorithm>

#include "protocols/canopen/device_frames.h"

namespace strainwave::protocols::canopen::device {

NodePdos::NodePdos(ObjectDictionary& objects, EmergencyProducer& emergencies) : emergencies_(emergencies) {
  for (std::uint16_t n = 0; PdoSlot::IsThere(objects, PdoDirection::kReceive, n); ++n) {
    receive_.emplace_back().slot = std::make_unique<PdoSlot>(objects, PdoDirection::kReceive, n);
  }
  for (std::uint16_t n = 0; PdoSlot::IsThere(objects, PdoDirection::kTransmit, n); ++n) {
    transmit_.emplace_back().slot = std::make_unique<PdoSlot>(objects, PdoDirection::kTransmit, n);
  }
}

void NodePdos::Start() {
  for (Receive& receive : receive_) {
    receive.waits = receive.heard = receive.timed_out = false;
  }
  for (Transmit& transmit : transmit_) {
    transmit.due = false;
    transmit.first = true;
    transmit.syncs = 0;
  }
}

bool NodePdos::OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) {
  if (!IsPlainData(frame)) return false;
  bool written = false;
  for (Receive& receive : receive_) {
    PdoSlot& slot = *receive.slot;
    if (!slot.on() || slot.id() != frame.id || slot.length() == 0) continue;
    if (frame.length < slot.length()) {
      emergencies_.Raise(ErrorCode::kPdoTooShort);
      continue;
    }
    emergencies_.Clear(ErrorCode::kPdoTooShort);
    if (frame.length > slot.length()) {
      emergencies_.Raise(ErrorCode::kPdoTooLong);
    } else {
      emergencies_.Clear(ErrorCode::kPdoTooLong);
    }
    receive.heard = true;
    receive.timed_out = false;
    receive.last = now;
    if (slot.synchronous()) {
      receive.waiting = frame;
      receive.waits = true;
    } else {
      slot.Decode(std::span(frame.data).first(frame.length));
      written = true;
    }
  }
  return written;
}

bool NodePdos::OnSync() {
  bool written = false;
  for (Receive& receive : receive_) {
    if (!receive.waits) continue;
    receive.waits = false;
    receive.slot->Decode(std::span(receive.waiting.data).first(receive.waiting.length));
    written = true;
  }
  return written;
}

void NodePdos::Sample(Transmit& transmit) {
  transmit.sampled = transmit.slot->Encode();
  transmit.due = true;
  transmit.first = false;
}

void NodePdos::SampleOnSync() {
  for (Transmit& transmit : transmit_) {
    PdoSlot& slot = *transmit.slot;
    if (!slot.on() || !slot.synchronous() || slot.length() == 0) continue;
    if (slot.transmission_type() == 0) {
      if (transmit.first || !(slot.Encode() == transmit.last)) Sample(transmit);
    } else if (++transmit.syncs >= slot.transmission_type()) {
      transmit.syncs = 0;
      Sample(transmit);
    }
  }
}

void NodePdos::Supervise(std::chrono::nanoseconds now) {
  for (Receive& receive : receive_) {
    const PdoSlot& slot = *receive.slot;
    const bool watched = slot.on() && slot.event_time().count() != 0;
    receive.timed_out = watched && receive.heard && now - receive.last > slot.event_time();
  }
}

void NodePdos::SampleOnEvent(std::chrono::nanoseconds now) {
  for (Transmit& transmit : transmit_) {
    PdoSlot& slot = *transmit.slot;
    if (!slot.on() || slot.synchronous() || slot.length() == 0 || transmit.due) continue;
    if (!transmit.first && now - transmit.last_time < slot.inhibit_time()) continue;
    const bool timed = slot.event_time().count() != 0 && now - transmit.last_time >= slot.event_time();
    if (!transmit.first && !timed && slot.Encode() == transmit.last) continue;
    Sample(transmit);
    transmit.last_time = now;
  }
}

bool NodePdos::Next(CanFrame& frame) {
  for (Transmit& transmit : transmit_) {
    if (!transmit.due) continue;
    transmit.due = false;
    transmit.last = transmit.sampled;
    frame = transmit.sampled;
    frame.length = static_cast<std::uint8_t>(std::clamp(frame.length + length_change_, 0, 8));
    std::fill(frame.data.begin() + frame.length, frame.data.end(), std::uint8_t{});
    return true;
  }
  return false;
}

bool NodePdos::timed_out() const {
  return std::any_of(receive_.begin(), receive_.end(),
                     [](const Receive& receive) { return receive.timed_out; });
}

}  // namespace strainwave::protocols::canopen::device
