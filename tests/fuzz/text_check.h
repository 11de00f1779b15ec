// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "schedules/reader/findings.h"

/// Reads the bytes as the text of a file: either it is accepted, or refused with findings that each say
/// something and stand in a place of the file.
template <typename Refusal, typename Read>
int CheckText(const std::uint8_t* data, std::size_t size, Read read) {
  try {
    read(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const Refusal& error) {
    if (error.findings().empty()) std::abort();
    for (const strainwave::schedules::Finding& finding : error.findings()) {
      if (finding.message.empty() || finding.line < 0 || finding.column < 0) std::abort();
    }
  }
  return 0;
}
