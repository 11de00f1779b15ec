// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace strainwave::protocols::canopen {

/// Why an SDO transfer was given up, by the codes of CiA 301, 7.2.4.3.17 (Table 22).
enum class SdoAbort : std::uint32_t {
  kToggleBitNotAlternated = 0x05030000,
  kTimedOut = 0x05040000,
  kUnknownCommand = 0x05040001,
  kInvalidBlockSize = 0x05040002,
  kInvalidSequenceNumber = 0x05040003,
  kCrcError = 0x05040004,
  kOutOfMemory = 0x05040005,
  kUnsupportedAccess = 0x06010000,
  kWriteOnlyObject = 0x06010001,
  kReadOnlyObject = 0x06010002,
  kNoSuchObject = 0x06020000,
  kNotMappable = 0x06040041,
  kMappingTooLong = 0x06040042,
  kParameterIncompatible = 0x06040043,
  kDeviceIncompatible = 0x06040047,
  kHardwareError = 0x06060000,
  kLengthMismatch = 0x06070010,
  kLengthTooHigh = 0x06070012,
  kLengthTooLow = 0x06070013,
  kNoSuchSubindex = 0x06090011,
  kInvalidValue = 0x06090030,
  kValueTooHigh = 0x06090031,
  kValueTooLow = 0x06090032,
  kMaximumBelowMinimum = 0x06090036,
  kResourceNotAvailable = 0x060A0023,
  kGeneralError = 0x08000000,
  kCannotStore = 0x08000020,
  kCannotStoreLocalControl = 0x08000021,
  kCannotStoreDeviceState = 0x08000022,
  kNoObjectDictionary = 0x08000023,
  kNoDataAvailable = 0x08000024,
};

/// The code in words; "a code that CiA 301 does not know" for a maker's own.
std::string_view Words(SdoAbort abort);

}  // namespace strainwave::protocols::canopen
