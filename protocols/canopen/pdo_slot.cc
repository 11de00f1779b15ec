// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/pdo_slot.h"

#include <algorithm>

#include "protocols/canopen/device_frames.h"
#include "protocols/canopen/type_limits.h"

namespace strainwave::protocols::canopen::device {
namespace {

constexpr std::int64_t kOff = 0x80000000;
constexpr std::int64_t kNoRemote = 0x40000000;
constexpr std::int64_t kLongId = 0x20000000;
constexpr std::int64_t kIdBits = 0x1FFFFFFF;
constexpr std::size_t kMostBytes = 8;

std::uint16_t CommunicationIndex(PdoDirection direction, std::uint16_t number) {
  return static_cast<std::uint16_t>((direction == PdoDirection::kReceive ? 0x1400 : 0x1800) + number);
}
std::uint16_t MappingIndex(PdoDirection direction, std::uint16_t number) {
  return static_cast<std::uint16_t>((direction == PdoDirection::kReceive ? 0x1600 : 0x1A00) + number);
}

// Ids that no PDO may have (CiA 301, Table 40).
bool IsRestricted(std::int64_t id) {
  return id <= 0x07F || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5FF) ||
         (id >= 0x601 && id <= 0x67F) || (id >= 0x6E0 && id <= 0x6FF) || id >= 0x701;
}

std::optional<SdoAbort> CheckType(std::int64_t type) {
  if (type <= PdoSlot::kMostSyncs || type >= 254) return std::nullopt;
  return SdoAbort::kInvalidValue;
}

ObjectAddress AddressOf(std::int64_t entry) {
  return {static_cast<std::uint16_t>(entry >> 16 & 0xFFFF), static_cast<std::uint8_t>(entry >> 8 & 0xFF)};
}
std::size_t BitsOf(std::int64_t entry) { return static_cast<std::size_t>(entry & 0xFF); }

// Types stand in the dictionary by their own numbers; mapped to an RPDO they fill places (CiA 301, 7.4.7.3).
bool IsDummy(std::int64_t entry) {
  const ObjectAddress address = AddressOf(entry);
  return address.subindex == 0 && IsIntegerType(static_cast<DataType>(address.index));
}

}  // namespace

bool PdoSlot::IsThere(const ObjectDictionary& objects, PdoDirection direction, std::uint16_t number) {
  return objects.Find({CommunicationIndex(direction, number), 1}) != nullptr;
}

PdoSlot::PdoSlot(ObjectDictionary& objects, PdoDirection direction, std::uint16_t number)
    : objects_(objects), direction_(direction) {
  const std::uint16_t communication = CommunicationIndex(direction, number);
  const std::uint16_t mapping = MappingIndex(direction, number);
  cob_id_ = &objects.At({communication, 1});
  type_ = &objects.At({communication, 2});
  inhibit_ = direction == PdoDirection::kTransmit ? &objects.At({communication, 3}) : nullptr;
  event_time_ = &objects.At({communication, 5});
  count_ = &objects.At({mapping, 0});
  objects.CheckWrites({communication, 1}, [this](std::int64_t value) { return CheckId(value); });
  objects.CheckWrites({communication, 2}, CheckType);
  if (inhibit_ != nullptr) {
    objects.CheckWrites({communication, 3}, [this](std::int64_t value) -> std::optional<SdoAbort> {
      if (on() && value != inhibit_->integer()) return SdoAbort::kCannotStoreDeviceState;
      return std::nullopt;
    });
  }
  objects.CheckWrites({mapping, 0}, [this](std::int64_t count) { return CheckCount(count); });
  for (std::uint8_t sub = 1; sub <= kMostBytes; ++sub) {
    Object* entry = objects.Find({mapping, sub});
    if (entry == nullptr) break;
    entries_.push_back(entry);
    objects.CheckWrites({mapping, sub}, [this](std::int64_t value) { return CheckEntry(value); });
  }
  as_mapped_[0] = -1;
}

bool PdoSlot::on() const { return (cob_id_->integer() & kOff) == 0; }
std::uint32_t PdoSlot::id() const { return static_cast<std::uint32_t>(cob_id_->integer() & kStandardIdBits); }
std::chrono::nanoseconds PdoSlot::inhibit_time() const {
  return std::chrono::microseconds(100) * (inhibit_ == nullptr ? 0 : inhibit_->integer());
}

std::optional<SdoAbort> PdoSlot::CheckId(std::int64_t value) const {
  const std::int64_t id = value & kIdBits;
  if ((value & kLongId) != 0 || id > kStandardIdBits) return SdoAbort::kInvalidValue;
  if (direction_ == PdoDirection::kTransmit && (value & kNoRemote) == 0) return SdoAbort::kInvalidValue;
  if ((value & kOff) != 0) return std::nullopt;
  if (on() && value != cob_id_->integer()) return SdoAbort::kInvalidValue;
  if (IsRestricted(id)) return SdoAbort::kInvalidValue;
  return std::nullopt;
}

std::optional<SdoAbort> PdoSlot::CheckEntry(std::int64_t entry) const {
  if (on() || count_->integer() != 0) return SdoAbort::kCannotStoreDeviceState;
  return entry == 0 ? std::nullopt : WhyNotMappable(entry);
}

std::optional<SdoAbort> PdoSlot::CheckCount(std::int64_t count) {
  if (on()) return SdoAbort::kCannotStoreDeviceState;
  if (count > static_cast<std::int64_t>(entries_.size())) return SdoAbort::kMappingTooLong;
  std::size_t bits = 0;
  for (std::int64_t i = 0; i < count; ++i) {
    const std::int64_t entry = entries_[static_cast<std::size_t>(i)]->integer();
    if (const std::optional<SdoAbort> abort = WhyNotMappable(entry)) return abort;
    bits += BitsOf(entry);
  }
  return bits > 8 * kMostBytes ? std::optional(SdoAbort::kMappingTooLong) : std::nullopt;
}

std::optional<SdoAbort> PdoSlot::WhyNotMappable(std::int64_t entry) const {
  if (direction_ == PdoDirection::kReceive && IsDummy(entry)) {
    const bool fits = BitsOf(entry) == 8 * BytesOf(static_cast<DataType>(AddressOf(entry).index));
    return fits ? std::nullopt : std::optional(SdoAbort::kNotMappable);
  }
  const Object* object = objects_.Find(AddressOf(entry));
  if (object == nullptr) return SdoAbort::kNoSuchObject;
  const bool right_way = direction_ == PdoDirection::kReceive ? object->writable() : object->readable();
  if (!object->mappable() || !right_way || BitsOf(entry) != 8 * object->size()) return SdoAbort::kNotMappable;
  return std::nullopt;
}

void PdoSlot::Refresh() {
  std::array<std::int64_t, 9> now{};
  now[0] = count_->integer();
  for (std::size_t i = 0; i < entries_.size(); ++i) now[i + 1] = entries_[i]->integer();
  if (now == as_mapped_) return;
  as_mapped_ = now;
  length_ = 0;
  for (std::size_t i = 0; i < mapped_.size(); ++i) {
    mapped_[i] = {};
    if (static_cast<std::int64_t>(i) >= now[0]) continue;
    mapped_[i] = {objects_.Find(AddressOf(now[i + 1])), BitsOf(now[i + 1]) / 8};
    length_ += mapped_[i].bytes;
  }
}

std::size_t PdoSlot::length() {
  Refresh();
  return length_;
}

CanFrame PdoSlot::Encode() {
  std::array<std::uint8_t, kMostBytes> bytes{};
  const std::span all(bytes);
  std::size_t at = 0;
  const std::size_t length = this->length();
  for (const Mapped& mapped : mapped_) {
    if (mapped.object == nullptr || at + mapped.bytes > kMostBytes) continue;
    mapped.object->Encode(all.subspan(at, mapped.bytes));
    at += mapped.bytes;
  }
  return DataFrame(id(), all.first(std::min(length, kMostBytes)));
}

void PdoSlot::Decode(std::span<const std::uint8_t> bytes) {
  Refresh();
  for (const Mapped& mapped : mapped_) {
    if (mapped.bytes > bytes.size()) return;
    if (mapped.object != nullptr) mapped.object->Write(bytes.first(mapped.bytes));
    bytes = bytes.subspan(mapped.bytes);
  }
}

}  // namespace strainwave::protocols::canopen::device
