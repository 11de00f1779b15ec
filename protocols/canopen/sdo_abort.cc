// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/sdo_abort.h"

namespace strainwave::protocols::canopen {

std::string_view Words(SdoAbort abort) {
  switch (abort) {
    case SdoAbort::kToggleBitNotAlternated:
      return "toggle bit did not alternate";
    case SdoAbort::kTimedOut:
      return "the answer did not come in time";
    case SdoAbort::kUnknownCommand:
      return "command not valid or unknown";
    case SdoAbort::kInvalidBlockSize:
      return "invalid block size";
    case SdoAbort::kInvalidSequenceNumber:
      return "invalid sequence number in a block";
    case SdoAbort::kCrcError:
      return "checksum of a block transfer is wrong";
    case SdoAbort::kOutOfMemory:
      return "out of memory";
    case SdoAbort::kUnsupportedAccess:
      return "the object cannot be accessed this way";
    case SdoAbort::kWriteOnlyObject:
      return "the object can only be written";
    case SdoAbort::kReadOnlyObject:
      return "the object can only be read";
    case SdoAbort::kNoSuchObject:
      return "there is no such object";
    case SdoAbort::kNotMappable:
      return "the object cannot be mapped to a PDO";
    case SdoAbort::kMappingTooLong:
      return "the mapped objects are longer than a PDO";
    case SdoAbort::kParameterIncompatible:
      return "the parameter contradicts another one";
    case SdoAbort::kDeviceIncompatible:
      return "contradiction within the device";
    case SdoAbort::kHardwareError:
      return "a hardware error prevents access";
    case SdoAbort::kLengthMismatch:
      return "the length does not fit the object's data type";
    case SdoAbort::kLengthTooHigh:
      return "more data than the object's data type holds";
    case SdoAbort::kLengthTooLow:
      return "less data than the object's data type holds";
    case SdoAbort::kNoSuchSubindex:
      return "there is no such sub-index";
    case SdoAbort::kInvalidValue:
      return "the value is not valid";
    case SdoAbort::kValueTooHigh:
      return "the value is too high";
    case SdoAbort::kValueTooLow:
      return "the value is too low";
    case SdoAbort::kMaximumBelowMinimum:
      return "the maximum is below the minimum";
    case SdoAbort::kResourceNotAvailable:
      return "the SDO connection is not available";
    case SdoAbort::kGeneralError:
      return "general error";
    case SdoAbort::kCannotStore:
      return "the value cannot be stored";
    case SdoAbort::kCannotStoreLocalControl:
      return "the value cannot be stored while the device is operated locally";
    case SdoAbort::kCannotStoreDeviceState:
      return "the value cannot be stored in the present state of the device";
    case SdoAbort::kNoObjectDictionary:
      return "the object dictionary is missing";
    case SdoAbort::kNoDataAvailable:
      return "no data available";
  }
  return "a code that CiA 301 does not know";
}

}  // namespace strainwave::protocols::canopen
