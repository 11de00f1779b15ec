// SPDX-License-Identifier: Apache-2.0
#include "bench/records/record_refusal.h"

#include <fmt/format.h>

namespace strainwave::bench {
namespace {

BenchError RefusalAt(const daq::Record& record, const std::string& place, const std::string& what) {
  const std::string& group = record.source.group;
  return {ExitCode::kWrongInput, fmt::format("{}{}: error: {}{}", record.source.file, place,
                                             group.empty() ? "" : fmt::format("group '{}': ", group), what)};
}

}  // namespace

BenchError RecordRefusal(const daq::Record& record, const std::string& what) {
  return RefusalAt(record, "", what);
}

BenchError RowRefusal(const daq::Record& record, std::size_t row, const std::string& what) {
  const int first = record.source.first_data_line;
  return RefusalAt(record, first > 0 ? fmt::format(":{}", first + static_cast<int>(row)) : "", what);
}

}  // namespace strainwave::bench
