// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/emergency_producer.h"

#include <algorithm>

#include "protocols/canopen/device_frames.h"

namespace strainwave::protocols::canopen::device {
namespace {

constexpr std::int64_t kNotValid = 0x80000000;  // bit 31 of a COB-ID
constexpr std::chrono::microseconds kInhibitUnit(100);

// Bits of 1001h (CiA 301, Table 48): 0 any error, 1 current, 2 voltage, 3 temperature, 4 communication, 5 of
// the device's profile, 7 of its maker.
unsigned RegisterBits(std::uint16_t code) {
  constexpr unsigned kAny = 0x01;
  switch (code >> 12U) {
    case 0x2:
      return kAny | 0x02;
    case 0x3:
      return kAny | 0x04;
    case 0x4:
      return kAny | 0x08;
    case 0xF:
      return kAny | 0x80;
    case 0x8:
      return code < 0x8300 ? kAny | 0x10 : kAny | 0x20;
    default:
      return kAny;
  }
}

}  // namespace

EmergencyProducer::EmergencyProducer(ObjectDictionary& objects)
    : register_(objects.At({0x1001, 0})),
      cob_id_(objects.At({0x1014, 0})),
      inhibit_(objects.At({0x1015, 0})),
      history_length_(objects.At({0x1003, 0})) {
  for (std::uint8_t sub = 1; Object* entry = objects.Find({0x1003, sub}); ++sub) history_.push_back(entry);
  lasting_.reserve(kMost);
  queue_.reserve(kMost);
  // Written with zero the history is emptied; nothing else can be written (CiA 301, 7.5.2.4).
  objects.CheckWrites({0x1003, 0}, [this](std::int64_t value) -> std::optional<SdoAbort> {
    if (value != 0) return SdoAbort::kInvalidValue;
    for (Object* entry : history_) entry->Set(0);
    return std::nullopt;
  });
}

void EmergencyProducer::Reset() {
  lasting_.clear();
  queue_.clear();
  UpdateRegister();
}

void EmergencyProducer::UpdateRegister() {
  unsigned bits = 0;
  for (const std::uint16_t code : lasting_) bits |= RegisterBits(code);
  register_.Set(bits);
}

bool EmergencyProducer::lasts(ErrorCode code) const {
  return std::count(lasting_.begin(), lasting_.end(), static_cast<std::uint16_t>(code)) != 0;
}

void EmergencyProducer::Queue(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) {
  if (queue_.size() == kMost) return;
  std::array<std::uint8_t, 8> bytes{};
  PutLittleEndian(std::span(bytes).first(2), code);
  bytes[2] = static_cast<std::uint8_t>(register_.integer());
  std::copy(vendor.begin(), vendor.end(), bytes.begin() + 3);
  queue_.push_back(DataFrame(0, bytes));
}

void EmergencyProducer::Raise(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor) {
  if (std::count(lasting_.begin(), lasting_.end(), code) != 0 || lasting_.size() == kMost) return;
  lasting_.push_back(code);
  UpdateRegister();
  for (std::size_t i = history_.size(); i-- > 1;) history_[i]->Set(history_[i - 1]->integer());
  if (!history_.empty()) {
    history_[0]->Set(code | std::int64_t{vendor[0]} << 16 | std::int64_t{vendor[1]} << 24);
    history_length_.Set(std::min(history_length_.integer() + 1, static_cast<std::int64_t>(history_.size())));
  }
  Queue(code, vendor);
}

void EmergencyProducer::Clear(std::uint16_t code) {
  if (std::erase(lasting_, code) == 0) return;
  UpdateRegister();
  Queue(static_cast<std::uint16_t>(ErrorCode::kNone), {});
}

bool EmergencyProducer::Next(std::chrono::nanoseconds now, CanFrame& frame) {
  if (queue_.empty() || now < next_ || (cob_id_.integer() & kNotValid) != 0) return false;
  frame = queue_.front();
  frame.id = static_cast<std::uint32_t>(cob_id_.integer() & kStandardIdBits);
  queue_.erase(queue_.begin());
  next_ = now + inhibit_.integer() * kInhibitUnit;
  return true;
}

}  // namespace strainwave::protocols::canopen::device
