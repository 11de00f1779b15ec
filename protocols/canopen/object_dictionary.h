// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocols/canopen/eds_file.h"
#include "protocols/canopen/object.h"
#include "protocols/canopen/sdo_abort.h"

/// The device side of CANopen: what a drive does. The master's side shares nothing with it but the headers
/// that both include, so that one reading of the standard is tested against another.
namespace strainwave::protocols::canopen::device {

/// Asked before a value from the bus is kept; refuses it with a reason. Not asked for texts.
using WriteCheck = std::function<std::optional<SdoAbort>(std::int64_t value)>;

/// One value of a device. Integers are kept as numbers; reals as their bits; texts as bytes.
class Object {
 public:
  Object(ObjectAddress address, const EdsObject& eds, std::uint8_t node_id);

  ObjectAddress address() const { return address_; }
  DataType type() const { return type_; }
  bool mappable() const { return mappable_; }
  bool readable() const { return access_ != AccessType::kWriteOnly; }
  bool writable() const { return access_ == AccessType::kWriteOnly || access_ == AccessType::kReadWrite; }
  /// Bytes on the bus; of a text those it has now.
  std::size_t size() const;

  std::int64_t integer() const { return integer_; }
  /// The device's own word: neither access nor limits are looked at; cut to the type's width.
  void Set(std::int64_t value) noexcept;
  void SetText(std::string_view text) { text_.assign(text.begin(), text.end()); }
  std::string_view text() const { return {reinterpret_cast<const char*>(text_.data()), text_.size()}; }

  /// Little endian into the first `size()` bytes.
  void Encode(std::span<std::uint8_t> bytes) const noexcept;
  std::int64_t Decode(std::span<const std::uint8_t> bytes) const noexcept;

  /// A value from the bus, `size()` bytes of a number. Says why when it is not taken.
  std::optional<SdoAbort> Write(std::span<const std::uint8_t> bytes);

  void Restore();

 private:
  friend class ObjectDictionary;

  ObjectAddress address_;
  DataType type_;
  AccessType access_;
  bool mappable_;
  std::optional<std::int64_t> low_;
  std::optional<std::int64_t> high_;
  std::int64_t integer_{};
  std::int64_t initial_integer_{};
  std::vector<std::uint8_t> text_;
  std::vector<std::uint8_t> initial_text_;
  WriteCheck check_;
};

/// The objects of one device, by address. They stay where they are: a pointer to one holds as long as the
/// dictionary.
class ObjectDictionary {
 public:
  /// Longest text or domain that is taken.
  static constexpr std::size_t kMostBytes = 65536;

  /// Every object at its default, "$NODEID" resolved.
  /// @throws std::invalid_argument for a node id that is not from 1 to 127.
  ObjectDictionary(const EdsFile& eds, std::uint8_t node_id);

  /// Nothing when the device has no such object.
  Object* Find(ObjectAddress address);
  const Object* Find(ObjectAddress address) const;
  /// @throws std::invalid_argument when the device has no such object, naming it.
  Object& At(ObjectAddress address);

  /// The value, of one without an object `otherwise`.
  std::int64_t Integer(ObjectAddress address, std::int64_t otherwise = 0) const;

  /// As the network sees it. `bytes` is given the value.
  std::optional<SdoAbort> Read(ObjectAddress address, std::vector<std::uint8_t>& bytes) const;
  std::optional<SdoAbort> Write(ObjectAddress address, std::span<const std::uint8_t> bytes);

  /// @throws std::invalid_argument when the device has no such object.
  void CheckWrites(ObjectAddress address, WriteCheck check) { At(address).check_ = std::move(check); }

  /// Defaults for the objects of these indices, both included.
  void Restore(std::uint16_t first_index, std::uint16_t last_index);

  /// From now on the network's access to this object is refused with this code; without one it is free again.
  void Refuse(ObjectAddress address, std::optional<SdoAbort> abort);

 private:
  std::optional<SdoAbort> WhyNot(ObjectAddress address) const;

  std::map<ObjectAddress, Object> objects_;
  std::map<ObjectAddress, SdoAbort> refused_;
};

}  // namespace strainwave::protocols::canopen::device
