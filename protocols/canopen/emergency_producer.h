// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include "protocols/can_frame.h"
#include "protocols/canopen/object_dictionary.h"

namespace strainwave::protocols::canopen::device {

/// Error codes of the emergency messages that this device sends (CiA 301, 7.2.7.1; CiA 402-2 for 8611h and
/// 8700h).
enum class ErrorCode : std::uint16_t {
  kNone = 0x0000,
  kSafeTorqueOff = 0x5440,   // contacts: the safe-torque-off input opened under power
  kDeviceSoftware = 0x6000,  // the simulated device itself is out of order
  kCommunication = 0x8100,   // the master took the node out of operational under power
  kHeartbeat = 0x8130,       // a heartbeat that is watched (1016h) does not come
  kRecoveredFromBusOff = 0x8140,
  kPdoTooShort = 0x8210,  // not processed
  kPdoTooLong = 0x8220,   // its beginning was processed
  kSyncLength = 0x8240,   // not processed
  kRpdoTimeout = 0x8250,  // of the event timer of an RPDO (1400h:5)
  kFollowingError = 0x8611,
  kSyncMissing = 0x8700,  // no SYNC within twice 1006h
};

/// Emergency messages with the error register (1001h), the history (1003h), the id of 1014h and the inhibit
/// time of 1015h. An error lasts until it is cleared; then code 0000h goes out with what the register still
/// has.
class EmergencyProducer {
 public:
  explicit EmergencyProducer(ObjectDictionary& objects);

  /// An error that lasts already is not told again.
  void Raise(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor = {});
  void Raise(ErrorCode code, const std::array<std::uint8_t, 5>& vendor = {}) {
    Raise(static_cast<std::uint16_t>(code), vendor);
  }
  void Clear(std::uint16_t code);
  void Clear(ErrorCode code) { Clear(static_cast<std::uint16_t>(code)); }
  bool lasts(ErrorCode code) const;

  /// The next message, if one is due.
  bool Next(std::chrono::nanoseconds now, CanFrame& frame);

  void Reset();

 private:
  static constexpr std::size_t kMost = 32;

  void Queue(std::uint16_t code, const std::array<std::uint8_t, 5>& vendor);
  void UpdateRegister();

  Object& register_;
  Object& cob_id_;
  Object& inhibit_;
  Object& history_length_;
  std::vector<Object*> history_;  // newest first
  std::vector<std::uint16_t> lasting_;
  std::vector<CanFrame> queue_;  // ids are put in when sent
  std::chrono::nanoseconds next_{};
};

}  // namespace strainwave::protocols::canopen::device
