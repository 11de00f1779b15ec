// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/object_dictionary.h"

#include <bit>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/canopen/type_limits.h"

namespace strainwave::protocols::canopen::device {
namespace {

constexpr std::uint8_t kMostNodeId = 127;

std::uint64_t CutTo(std::uint64_t bits, std::size_t bytes) {
  return bytes >= 8 ? bits : bits & ((std::uint64_t{1} << (8 * bytes)) - 1);
}

// The number that the lowest `bytes` of `bits` mean.
std::int64_t NumberOf(std::uint64_t bits, std::size_t bytes, bool is_signed) {
  bits = CutTo(bits, bytes);
  if (is_signed && bytes < 8 && (bits >> (8 * bytes - 1)) != 0) bits |= ~std::uint64_t{0} << (8 * bytes);
  return static_cast<std::int64_t>(bits);
}

// A real as an EDS file writes it, by its bits; zero of anything else.
template <typename Real, typename Bits>
std::int64_t RealBits(std::string_view text) {
  Real real{};
  std::from_chars(text.data(), text.data() + text.size(), real);
  return static_cast<std::int64_t>(std::bit_cast<Bits>(real));
}

}  // namespace

Object::Object(ObjectAddress address, const EdsObject& eds, std::uint8_t node_id)
    : address_(address), type_(eds.type), access_(eds.access), mappable_(eds.mappable) {
  if (IsIntegerType(type_)) {
    initial_integer_ = TypedEdsNumber(eds.default_value, node_id, type_).value_or(0);
    low_ = TypedEdsNumber(eds.low_limit, node_id, type_);
    high_ = TypedEdsNumber(eds.high_limit, node_id, type_);
  } else if (type_ == DataType::kReal32) {
    initial_integer_ = RealBits<float, std::uint32_t>(eds.default_value);
  } else if (type_ == DataType::kReal64) {
    initial_integer_ = RealBits<double, std::uint64_t>(eds.default_value);
  } else {
    initial_text_.assign(eds.default_value.begin(), eds.default_value.end());
  }
  Restore();
}

std::size_t Object::size() const {
  const std::size_t bytes = BytesOf(type_);
  return bytes == 0 ? text_.size() : bytes;
}

void Object::Set(std::int64_t value) noexcept {
  integer_ = NumberOf(static_cast<std::uint64_t>(value), BytesOf(type_), IsSignedType(type_));
}

void Object::Restore() {
  integer_ = initial_integer_;
  text_ = initial_text_;
}

void Object::Encode(std::span<std::uint8_t> bytes) const noexcept {
  auto bits = static_cast<std::uint64_t>(integer_);
  for (std::size_t i = 0; i < size() && i < bytes.size(); ++i, bits >>= 8) {
    bytes[i] = BytesOf(type_) == 0 ? text_[i] : static_cast<std::uint8_t>(bits & 0xFF);
  }
}

std::int64_t Object::Decode(std::span<const std::uint8_t> bytes) const noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) bits = bits << 8 | bytes[i];
  return NumberOf(bits, BytesOf(type_), IsSignedType(type_));
}

std::optional<SdoAbort> Object::Write(std::span<const std::uint8_t> bytes) {
  if (!writable()) return SdoAbort::kReadOnlyObject;
  const std::size_t expected = BytesOf(type_);
  if (expected == 0) {
    if (bytes.size() > ObjectDictionary::kMostBytes) return SdoAbort::kOutOfMemory;
    text_.assign(bytes.begin(), bytes.end());
    return std::nullopt;
  }
  if (bytes.size() > expected) return SdoAbort::kLengthTooHigh;
  if (bytes.size() < expected) return SdoAbort::kLengthTooLow;
  const std::int64_t value = Decode(bytes);
  if (type_ == DataType::kBoolean && (value < 0 || value > 1)) return SdoAbort::kInvalidValue;
  if (high_ && value > *high_) return SdoAbort::kValueTooHigh;
  if (low_ && value < *low_) return SdoAbort::kValueTooLow;
  if (check_) {
    if (const std::optional<SdoAbort> abort = check_(value)) return abort;
  }
  integer_ = value;
  return std::nullopt;
}

ObjectDictionary::ObjectDictionary(const EdsFile& eds, std::uint8_t node_id) {
  if (node_id < 1 || node_id > kMostNodeId) {
    throw std::invalid_argument(fmt::format("node_id = {} (must be from 1 to {})", node_id, kMostNodeId));
  }
  for (const auto& [address, object] : eds.objects)
    objects_.emplace(address, Object(address, object, node_id));
}

Object* ObjectDictionary::Find(ObjectAddress address) {
  const auto found = objects_.find(address);
  return found == objects_.end() ? nullptr : &found->second;
}

const Object* ObjectDictionary::Find(ObjectAddress address) const {
  const auto found = objects_.find(address);
  return found == objects_.end() ? nullptr : &found->second;
}

Object& ObjectDictionary::At(ObjectAddress address) {
  Object* object = Find(address);
  if (object == nullptr) {
    throw std::invalid_argument(
        fmt::format("the device has no object {:04X}:{:02X} (its EDS file must have it)", address.index,
                    address.subindex));
  }
  return *object;
}

std::int64_t ObjectDictionary::Integer(ObjectAddress address, std::int64_t otherwise) const {
  const Object* object = Find(address);
  return object == nullptr ? otherwise : object->integer();
}

std::optional<SdoAbort> ObjectDictionary::WhyNot(ObjectAddress address) const {
  if (const auto found = refused_.find(address); found != refused_.end()) return found->second;
  if (Find(address) != nullptr) return std::nullopt;
  const auto next = objects_.lower_bound({address.index, 0});
  const bool has_index = next != objects_.end() && next->first.index == address.index;
  return has_index ? SdoAbort::kNoSuchSubindex : SdoAbort::kNoSuchObject;
}

std::optional<SdoAbort> ObjectDictionary::Read(ObjectAddress address,
                                               std::vector<std::uint8_t>& bytes) const {
  if (const std::optional<SdoAbort> abort = WhyNot(address)) return abort;
  const Object& object = *Find(address);
  if (!object.readable()) return SdoAbort::kWriteOnlyObject;
  bytes.resize(object.size());
  object.Encode(bytes);
  return std::nullopt;
}

std::optional<SdoAbort> ObjectDictionary::Write(ObjectAddress address, std::span<const std::uint8_t> bytes) {
  if (const std::optional<SdoAbort> abort = WhyNot(address)) return abort;
  return Find(address)->Write(bytes);
}

void ObjectDictionary::Restore(std::uint16_t first_index, std::uint16_t last_index) {
  for (auto& [address, object] : objects_) {
    if (address.index >= first_index && address.index <= last_index) object.Restore();
  }
}

void ObjectDictionary::Refuse(ObjectAddress address, std::optional<SdoAbort> abort) {
  if (abort) {
    refused_[address] = *abort;
  } else {
    refused_.erase(address);
  }
}

}  // namespace strainwave::protocols::canopen::device
