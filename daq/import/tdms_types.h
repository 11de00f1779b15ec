// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

/// Numbers and names of docs/sources.md#tdms, for `read_tdms.cc`.
namespace strainwave::daq::tdms {

/// Of values and properties.
enum Type : std::uint32_t {
  kInt8 = 1,
  kInt16 = 2,
  kInt32 = 3,
  kInt64 = 4,
  kUint8 = 5,
  kUint16 = 6,
  kUint32 = 7,
  kUint64 = 8,
  kSingle = 9,
  kDouble = 10,
  kSingleWithUnit = 0x19,
  kDoubleWithUnit = 0x1A,
  kString = 0x20,
  kBoolean = 0x21,
  kTimeStamp = 0x44,
};

/// Bytes of a number; 0 for what is none.
inline std::size_t WidthOf(std::uint32_t type) {
  switch (type) {
    case kInt8:
    case kUint8:
    case kBoolean:
      return 1;
    case kInt16:
    case kUint16:
      return 2;
    case kInt32:
    case kUint32:
    case kSingle:
    case kSingleWithUnit:
      return 4;
    case kInt64:
    case kUint64:
    case kDouble:
    case kDoubleWithUnit:
      return 8;
    case kTimeStamp:
      return 16;
    default:
      return 0;
  }
}

/// "/'group'/'channel'" as "group/channel".
inline std::string PlainPath(std::string_view path) {
  std::string plain;
  bool within = false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] == '\'') {
      if (within && i + 1 < path.size() && path[i + 1] == '\'') {
        plain += path[i++];
      } else {
        within = !within;
      }
    } else if (within) {
      plain += path[i];
    } else if (path[i] == '/' && !plain.empty()) {
      plain += '/';
    }
  }
  return plain;
}

}  // namespace strainwave::daq::tdms
