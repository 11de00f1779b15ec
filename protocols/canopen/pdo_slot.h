// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/object_dictionary.h"

namespace strainwave::protocols::canopen::device {

enum class PdoDirection : std::uint8_t { kReceive, kTransmit };

/// The parameters of one PDO as they stand in the dictionary, communication at 1400h or 1800h and on, mapping
/// at 1600h or 1A00h and on, with the rules for writing them (CiA 301, 7.5.2.35 to 7.5.2.38):
/// - the id changes only through a value with bit 31 set, which switches the PDO off; a PDO that is on can be
/// given
///   the value that it has (else 06090030h);
/// - ids of other services, ids of 29 bits, and a TPDO that could be asked for by remote frame are refused
///   (06090030h), since this device has no such TPDO;
/// - the mapping changes while the PDO is off (else 08000022h), its entries while there are none of them in
/// force
///   (sub-index 0 is zero);
/// - transmission types are 0 to 240, 254 and 255.
class PdoSlot {
 public:
  /// @param number  from 0. @throws std::invalid_argument when an object of it is missing.
  PdoSlot(ObjectDictionary& objects, PdoDirection direction, std::uint16_t number);
  PdoSlot(const PdoSlot&) = delete;
  PdoSlot& operator=(const PdoSlot&) = delete;

  static bool IsThere(const ObjectDictionary& objects, PdoDirection direction, std::uint16_t number);

  bool on() const;
  std::uint32_t id() const;
  int transmission_type() const { return static_cast<int>(type_->integer()); }
  bool synchronous() const { return transmission_type() <= kMostSyncs; }
  std::chrono::nanoseconds event_time() const { return std::chrono::milliseconds(event_time_->integer()); }
  std::chrono::nanoseconds inhibit_time() const;

  /// Bytes of the mapping in force.
  std::size_t length();

  CanFrame Encode();
  /// The mapped objects are given these bytes; a value that an object refuses is left out.
  void Decode(std::span<const std::uint8_t> bytes);

  static constexpr int kMostSyncs = 240;

 private:
  struct Mapped {
    Object* object{};  // null: a dummy of this length
    std::size_t bytes{};
  };

  std::optional<SdoAbort> CheckId(std::int64_t value) const;
  std::optional<SdoAbort> CheckCount(std::int64_t count);
  std::optional<SdoAbort> CheckEntry(std::int64_t entry) const;
  std::optional<SdoAbort> WhyNotMappable(std::int64_t entry) const;
  void Refresh();

  ObjectDictionary& objects_;
  PdoDirection direction_;
  Object* cob_id_;
  Object* type_;
  Object* inhibit_;  // of a TPDO; else null
  Object* event_time_;
  Object* count_;
  std::vector<Object*> entries_;
  std::array<Mapped, 8> mapped_{};
  std::array<std::int64_t, 9> as_mapped_{};  // count and entries that `mapped_` was made from
  std::size_t length_{};
};

}  // namespace strainwave::protocols::canopen::device
