// SPDX-License-Identifier: Apache-2.0
#include "bench/trip_test/trip_sheet.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

constexpr std::size_t kColumns = 7;
using Cells = std::array<std::string, kColumns>;

std::string LimitText(const TripLimit& limit) {
  return limit.value ? fmt::format("{:g} {} ({})", *limit.value, limit.unit, limit.key) : limit.key;
}

Cells CellsOf(const TripRow& row, const TripResult& result) {
  return {std::string(Name(result.verdict)),
          row.signal,
          LimitText(row.limit),
          fmt::format("{:.0f} ms", 1e3 * row.safe_within_s),
          row.latches ? "latches" : "no",
          row.action,
          result.seen};
}

std::string Line(const Cells& cells, const std::array<std::size_t, kColumns>& widths) {
  std::string line;
  for (std::size_t i = 0; i < kColumns; ++i) {
    line += i + 1 < kColumns ? fmt::format("{:<{}}  ", cells[i], widths[i]) : cells[i];
  }
  return line + "\n";
}

nlohmann::ordered_json OrNull(const std::optional<double>& value) {
  return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

nlohmann::ordered_json RowJson(const TripRow& row, const TripResult& result) {
  return {{"code", Code(row.cause)},
          {"signal", row.signal},
          {"limit", {{"value", OrNull(row.limit.value)}, {"unit", row.limit.unit}, {"key", row.limit.key}}},
          {"trips_within_s", row.noticed_within_s},
          {"safe_within_s", row.safe_within_s},
          {"latches", row.latches},
          {"action", row.action},
          {"verdict", Name(result.verdict)},
          {"tripped_after_s", OrNull(result.tripped_after_s)},
          {"safe_after_s", OrNull(result.safe_after_s)},
          {"stopped_as",
           result.stopped_as.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(result.stopped_as)},
          {"seen", result.seen}};
}

}  // namespace

std::size_t CountOf(std::span<const TripResult> results, TripVerdict verdict) {
  return static_cast<std::size_t>(std::ranges::count(results, verdict, &TripResult::verdict));
}

bool IsGood(const TripSheet& sheet) {
  return CountOf(sheet.results, TripVerdict::kFailed) == 0 &&
         CountOf(sheet.results, TripVerdict::kPassed) > 0;
}

std::string SummaryText(std::span<const TripResult> results) {
  return fmt::format("{} {}: {} passed, {} failed, {} skipped", results.size(),
                     results.size() == 1 ? "row" : "rows", CountOf(results, TripVerdict::kPassed),
                     CountOf(results, TripVerdict::kFailed), CountOf(results, TripVerdict::kSkipped));
}

std::string SheetText(const TripSheet& sheet) {
  std::string text = "trip test of the interlocks\n";
  text += fmt::format("  bench     {}{}{}\n", sheet.bench, sheet.simulated ? ", simulated" : "",
                      sheet.bench_file.empty() ? "" : fmt::format(" ({})", sheet.bench_file));
  text += fmt::format("  limits    {}\n", sheet.schedule.empty() ? "of no schedule" : sheet.schedule);
  text += fmt::format("  date      {}\n  software  {}\n\n", sheet.utc, sheet.software);
  std::vector<Cells> lines{{"verdict", "signal", "limit", "safe within", "alarm", "action", "seen"}};
  for (std::size_t i = 0; i < sheet.rows.size(); ++i) {
    lines.push_back(CellsOf(sheet.rows[i], sheet.results[i]));
  }
  std::array<std::size_t, kColumns> widths{};
  for (const Cells& cells : lines) {
    for (std::size_t i = 0; i < kColumns; ++i) widths[i] = std::max(widths[i], cells[i].size());
  }
  for (const Cells& cells : lines) text += Line(cells, widths);
  return text + "\n" + SummaryText(sheet.results) + "\n";
}

nlohmann::ordered_json SheetJson(const TripSheet& sheet) {
  const auto or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(text);
  };
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < sheet.rows.size(); ++i) {
    rows.push_back(RowJson(sheet.rows[i], sheet.results[i]));
  }
  return {{"bench", sheet.bench},
          {"bench_file", or_null(sheet.bench_file)},
          {"simulated", sheet.simulated},
          {"schedule", or_null(sheet.schedule)},
          {"utc", sheet.utc},
          {"software", sheet.software},
          {"good", IsGood(sheet)},
          {"passed", CountOf(sheet.results, TripVerdict::kPassed)},
          {"failed", CountOf(sheet.results, TripVerdict::kFailed)},
          {"skipped", CountOf(sheet.results, TripVerdict::kSkipped)},
          {"rows", rows}};
}

}  // namespace strainwave::bench
