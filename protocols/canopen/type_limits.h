// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "protocols/canopen/object.h"

namespace strainwave::protocols::canopen {

/// Whether the number is one of the types that `DataType` names.
bool IsKnownType(DataType type);

/// Booleans count as integers of 0 and 1.
bool IsIntegerType(DataType type);
bool IsSignedType(DataType type);

/// Bytes of a value; 0 of a type without a fixed length. A boolean takes one byte.
std::size_t BytesOf(DataType type);

/// The text of an EDS file as a value of an integer type. Negative ones are written in hexadecimal, too:
/// 0xFFFFFFFF is -1 of INTEGER32. Nothing when it is no number or does not fit; an UNSIGNED64 above 2^63 - 1
/// does not fit here.
std::optional<std::int64_t> TypedEdsNumber(std::string_view text, std::uint8_t node_id, DataType type);

/// "a number from -128 to 127".
std::string RangeWords(DataType type);

}  // namespace strainwave::protocols::canopen
