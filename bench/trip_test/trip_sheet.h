// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "bench/trip_test/trip_row.h"
#include "bench/trip_test/trip_test.h"

namespace strainwave::bench {

/// A trip test as it is filed.
struct TripSheet {
  std::string bench;       // name in its file
  std::string bench_file;  // empty: the embedded one
  bool simulated{};
  std::string schedule;  // file that the limits come from; empty: none
  std::string utc;       // when it began
  std::string software;
  std::vector<TripRow> rows;
  std::vector<TripResult> results;  // one a row
};

std::size_t CountOf(std::span<const TripResult> results, TripVerdict verdict);

/// Every row that was tested passed, and one was.
bool IsGood(const TripSheet& sheet);

/// Head, table and a line of summary, as text.
std::string SheetText(const TripSheet& sheet);

/// "29 rows: 27 passed, 0 failed, 2 skipped".
std::string SummaryText(std::span<const TripResult> results);

/// The same as one document.
nlohmann::ordered_json SheetJson(const TripSheet& sheet);

}  // namespace strainwave::bench
