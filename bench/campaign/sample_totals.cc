// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/sample_totals.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/json_property.h"

namespace strainwave::bench {
namespace {

constexpr const char* kTotals = "sample_totals";

struct Totals {
  int last_cycle = -1;
  std::map<std::string, double> received;
  std::map<std::string, double> lost;
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Totals, last_cycle, received, lost)

Totals TotalsOf(const Journal& journal) {
  Totals totals;
  // Journals of earlier programs have none: every cycle is read.
  ReadJsonProperty(journal, kTotals, [&](const nlohmann::json& kept) {
    totals = kept.get<Totals>();
    if (totals.last_cycle < -1 || totals.last_cycle == std::numeric_limits<int>::max()) {
      throw std::invalid_argument("last_cycle is no cycle");
    }
  });
  const auto source_of = [](const CycleResult& row, std::string_view prefix) {
    return row.result.quantity.substr(prefix.size());
  };
  const auto take = [&](const CycleResult& row) {
    if (!std::isfinite(row.result.value)) return true;
    if (row.result.quantity.starts_with(kSamplesReceived)) {
      totals.received[source_of(row, kSamplesReceived)] += row.result.value;
    } else if (row.result.quantity.starts_with(kSamplesLost)) {
      totals.lost[source_of(row, kSamplesLost)] += row.result.value;
    }
    return true;
  };
  journal.ForEachResult("samples_", take, totals.last_cycle + 1);
  totals.last_cycle = journal.LastCompleteCycle();
  return totals;
}

}  // namespace

std::map<std::string, SampleCount> SamplesOf(const Journal& journal) {
  const Totals totals = TotalsOf(journal);
  std::map<std::string, SampleCount> counts;
  // What was lost in the files of a source begins alike, and is of no source by that name.
  for (const auto& [source, received] : totals.received) {
    const auto lost = totals.lost.find(source);
    counts[source] = {received, lost == totals.lost.end() ? 0.0 : lost->second};
  }
  return counts;
}

void KeepSampleTotals(Journal& journal) {
  journal.SetProperty(kTotals, nlohmann::json(TotalsOf(journal)).dump());
}

}  // namespace strainwave::bench
