// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/heartbeat.h"

#include <fmt/format.h>

#include <stdexcept>

#include "protocols/canopen/cob_ids.h"
#include "protocols/canopen/wire_bytes.h"

namespace strainwave::protocols::canopen {
namespace {

using std::chrono::nanoseconds;

void Check(std::uint8_t node_id, std::string_view name, nanoseconds time) {
  if (node_id < 1 || node_id > 127) {
    throw std::invalid_argument(fmt::format("node_id = {} is not 1 to 127", node_id));
  }
  if (time <= nanoseconds::zero()) {
    throw std::invalid_argument(fmt::format("{} = {} ns is not above zero", name, time.count()));
  }
}

}  // namespace

CanFrame HeartbeatFrame(std::uint8_t node_id, NmtState state) noexcept {
  return FrameOf(kHeartbeatBase + node_id, {static_cast<std::uint8_t>(state)});
}

HeartbeatProducer::HeartbeatProducer(std::uint8_t node_id, nanoseconds period)
    : node_id_(node_id), period_(period) {
  Check(node_id, "period", period);
}

std::optional<CanFrame> HeartbeatProducer::Poll(nanoseconds now) noexcept {
  if (due_ && now < *due_) return std::nullopt;
  due_ = due_ && now < *due_ + period_ ? *due_ + period_ : now + period_;
  return HeartbeatFrame(node_id_, NmtState::kOperational);
}

HeartbeatConsumer::HeartbeatConsumer(std::uint8_t node_id, nanoseconds timeout)
    : node_id_(node_id), timeout_(timeout) {
  Check(node_id, "timeout", timeout);
}

void HeartbeatConsumer::Start(nanoseconds now) noexcept {
  is_watching_ = true;
  is_lost_ = false;
  last_ = now;
}

std::optional<HeartbeatEvent> HeartbeatConsumer::OnFrame(const CanFrame& frame, nanoseconds now) noexcept {
  if (!IsDataFrame(frame, kHeartbeatBase + node_id_) || frame.length != 1) return std::nullopt;
  const std::optional<NmtState> state = NmtStateOf(frame.data[0]);
  if (!state) return std::nullopt;
  const bool was_lost = is_lost_;
  const bool is_new = state != state_;
  last_ = now;
  is_lost_ = false;
  state_ = state;
  if (*state == NmtState::kBootUp) return HeartbeatEvent::kBootUp;
  if (was_lost) return HeartbeatEvent::kReturned;
  if (is_new) return HeartbeatEvent::kStateChanged;
  return std::nullopt;
}

std::optional<HeartbeatEvent> HeartbeatConsumer::Poll(nanoseconds now) noexcept {
  if (!is_watching_ || is_lost_ || now - last_ < timeout_) return std::nullopt;
  is_lost_ = true;
  return HeartbeatEvent::kLost;
}

}  // namespace strainwave::protocols::canopen
