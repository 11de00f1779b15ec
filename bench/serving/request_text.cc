// SPDX-License-Identifier: Apache-2.0
#include "bench/serving/request_text.h"

#include <algorithm>

#include "bench/text.h"

namespace strainwave::bench {
namespace {

constexpr std::string_view kSpaces = " \t\r";

bool IsRange(std::string_view line) {
  std::string name(line.substr(0, line.find(':')));
  name.erase(0, std::min(name.find_first_not_of(kSpaces), name.size()));
  name.erase(name.find_last_not_of(kSpaces) + 1);
  name = LowerCase(name);
  return name == "range" || name == "if-range";
}

}  // namespace

// By line feeds alone, as cpp-httplib takes lines apart: one that a carriage return does not precede would
// hide a header from whoever looks for both.
std::string WithoutRanges(std::string_view request) {
  std::string kept;
  bool is_head = true;
  while (!request.empty()) {
    const std::size_t end = request.find('\n');
    const std::string_view line = request.substr(0, end == request.npos ? end : end + 1);
    request.remove_prefix(line.size());
    is_head = is_head && line != "\r\n";
    if (!is_head || !IsRange(line)) kept += line;
  }
  return kept;
}

}  // namespace strainwave::bench
