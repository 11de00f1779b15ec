// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/campaign/journal.h"
#include "schedules/reader/schedule.h"

namespace strainwave::bench {

/// What `GET /api/v1/cycles` asks for.
struct CyclesQuery {
  int from{1};
  int to{};  // 0: the last complete cycle
  int points{500};
  std::vector<std::string> quantities;

  bool operator==(const CyclesQuery&) const = default;
};

/// A parameter of a request. @throws std::invalid_argument with what was expected.
int WholeNumber(const std::string& name, const std::string& text, int least, int most);
inline constexpr int kLastCycle = 1'000'000'000;

/// @param parameters  of the request, by name: from, to, points, quantities (separated by commas).
/// @throws std::invalid_argument with one sentence for the first that is wrong.
CyclesQuery ParseCyclesQuery(const std::multimap<std::string, std::string>& parameters);

/// One quantity in the cycles of one bin. Smallest and largest are of all cycles in it, whatever their
/// number: a bin hides no value.
struct CycleBin {
  int count{};
  double min{};
  double max{};
  double last{};
  double last_standard_error{};
  int flagged{};  // results with a flag that makes them doubtful (IsSound)
};

/// Cycles `from` to `to` in bins of one width, at most `points` of them, the last one perhaps narrower.
class CycleBins {
 public:
  CycleBins(int from, int to, int points);

  int width() const { return width_; }
  const std::vector<CycleBin>& bins() const { return bins_; }
  /// The last cycle of a bin.
  int EndOf(std::size_t bin) const;
  /// In the order of cycles, each from `from` to `to`.
  void Add(int cycle, const Result& result);

 private:
  int from_;
  int to_;
  int width_;
  std::vector<CycleBin> bins_;
};

/// The answer, read from the journal. @param stop  criteria of the schedule.
/// @throws DatabaseError.
nlohmann::json CyclesJson(const Journal& journal, const CyclesQuery& query,
                          const schedules::StopCriteria& stop);

}  // namespace strainwave::bench
