// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/load_results.h"

#include <algorithm>
#include <map>
#include <string>

#include <fmt/core.h>

namespace strainwave::bench {

std::vector<Result> LoadResults(std::span<const daq::NamedRecord> records) {
  struct Load {
    double credited_s{};
    double equivalent_s{};
  };
  std::map<std::string, Load> loads;
  for (const daq::NamedRecord& named : records) {
    const daq::Record& record = named.record;
    if (record.FindColumn("equivalent_load_s") == nullptr) continue;
    const auto credited_s = record.Doubles("credited_load_s");
    const auto equivalent_s = record.Doubles("equivalent_load_s");
    if (credited_s.empty()) continue;
    Load& load = loads[named.group.substr(0, named.group.rfind('/'))];
    // An attempt goes on from the time that the ones before it were credited; the equivalent is its own.
    load.credited_s = std::max(load.credited_s, credited_s.back());
    load.equivalent_s += equivalent_s.back();
  }
  std::vector<Result> results;
  for (const auto& [phase, load] : loads) {
    results.push_back({fmt::format("{}_credited_s", phase), load.credited_s, 0.0, ""});
    results.push_back({fmt::format("{}_equivalent_s", phase), load.equivalent_s, 0.0, ""});
  }
  return results;
}

}  // namespace strainwave::bench
