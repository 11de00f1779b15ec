// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "protocols/modbus/register_map.h"

namespace strainwave::protocols::modbus {

struct WriteRequest {
  Table table{};
  std::uint16_t first{};
  std::vector<std::uint16_t> words;

  bool operator==(const WriteRequest&) const = default;
};

/// The fewest requests that write these values: position in the map, value. Only neighbours go together;
/// nothing is written that was not asked for.
/// @throws std::invalid_argument for a register that is not in the map or not to be written, or a value that
///   it cannot hold.
std::vector<WriteRequest> PlanWrites(const RegisterMap& map,
                                     std::span<const std::pair<std::size_t, double>> values);

}  // namespace strainwave::protocols::modbus
