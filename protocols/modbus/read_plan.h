// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocols/modbus/register_map.h"

namespace strainwave::protocols::modbus {

/// One reading of neighbouring addresses.
struct ReadRequest {
  Table table{};
  std::uint16_t first{};
  std::uint16_t count{};
  std::vector<std::size_t> registers;  // of the map, that this request brings, by address

  bool operator==(const ReadRequest&) const = default;
};

/// The fewest requests that bring the registers `wanted` (positions in the map, each readable, of a map
/// without problems). A request runs over addresses that were not wanted only where they belong to readable
/// registers of the map, or to none and the map's `read_gap` allows that many in a row; never over a register
/// that can only be written.
/// @throws std::invalid_argument for a position that is not in the map or cannot be read.
std::vector<ReadRequest> PlanReads(const RegisterMap& map, std::span<const std::size_t> wanted);

}  // namespace strainwave::protocols::modbus
