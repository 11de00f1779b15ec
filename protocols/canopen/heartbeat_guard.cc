// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/heartbeat_guard.h"

#include <algorithm>

#include "protocols/canopen/cob_ids.h"
#include "protocols/canopen/device_frames.h"

namespace strainwave::protocols::canopen::device {
namespace {

std::uint32_t NodeOf(std::int64_t entry) { return static_cast<std::uint32_t>(entry >> 16 & 0xFF); }
std::chrono::milliseconds TimeOf(std::int64_t entry) { return std::chrono::milliseconds(entry & 0xFFFF); }

}  // namespace

HeartbeatGuard::HeartbeatGuard(ObjectDictionary& objects) {
  for (std::uint8_t sub = 1; const Object* entry = objects.Find({0x1016, sub}); ++sub) {
    watches_.push_back({entry});
    // No node is watched twice (CiA 301, 7.5.2.14).
    objects.CheckWrites({0x1016, sub}, [this, entry](std::int64_t value) -> std::optional<SdoAbort> {
      if (NodeOf(value) > 127) return SdoAbort::kInvalidValue;
      if (NodeOf(value) == 0 || TimeOf(value).count() == 0) return std::nullopt;
      for (const Watch& watch : watches_) {
        const std::int64_t other = watch.entry->integer();
        if (watch.entry != entry && TimeOf(other).count() != 0 && NodeOf(other) == NodeOf(value)) {
          return SdoAbort::kParameterIncompatible;
        }
      }
      return std::nullopt;
    });
  }
}

bool HeartbeatGuard::Watches(const Watch& watch, std::uint32_t id) {
  const std::int64_t entry = watch.entry->integer();
  return NodeOf(entry) != 0 && TimeOf(entry).count() != 0 && id == kHeartbeatBase + NodeOf(entry);
}

void HeartbeatGuard::OnFrame(const CanFrame& frame, std::chrono::nanoseconds now) {
  if (!IsPlainData(frame) || frame.length != 1) return;
  for (Watch& watch : watches_) {
    if (!Watches(watch, frame.id)) continue;
    watch.as_set = watch.entry->integer();
    watch.heard = true;
    watch.lost = false;
    watch.last = now;
  }
}

void HeartbeatGuard::Poll(std::chrono::nanoseconds now) {
  for (Watch& watch : watches_) {
    if (watch.as_set != watch.entry->integer()) {  // another node or time: it begins anew
      watch = {watch.entry, watch.entry->integer()};
    }
    if (watch.heard && now - watch.last > TimeOf(watch.as_set)) watch.lost = true;
  }
}

bool HeartbeatGuard::lost() const {
  return std::any_of(watches_.begin(), watches_.end(), [](const Watch& watch) { return watch.lost; });
}

void HeartbeatGuard::Reset() {
  for (Watch& watch : watches_) watch = {watch.entry};
}

}  // namespace strainwave::protocols::canopen::device
