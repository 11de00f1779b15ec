// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/recompute.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

#include <fmt/core.h>

#include "bench/campaign/blank_results.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/campaign_error.h"
#include "bench/campaign/on_all_processors.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

bool SameBits(double a, double b) {
  // SQLite keeps a not-a-number as NULL and gives it back as zero.
  if (std::isnan(a)) return b == 0.0 || std::isnan(b);
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool SameResults(std::vector<Result> a, std::vector<Result> b) {
  std::ranges::sort(a, {}, &Result::quantity);
  std::ranges::sort(b, {}, &Result::quantity);
  return std::ranges::equal(a, b, [](const Result& x, const Result& y) {
    return x.quantity == y.quantity && SameBits(x.value, y.value) &&
           SameBits(x.standard_error, y.standard_error) && x.flag == y.flag;
  });
}

// The blank test was measured with the same sensors as all that it corrects.
CycleContext WithRecalibratedBlank(const CampaignFolder& folder, CycleContext context) {
  if (context.recalibrations.empty() || !std::filesystem::exists(folder.CycleFile(0))) return context;
  std::vector<NamedRecord> records = ReadCycleRecords(folder, 0);
  Recalibrate(records, context.recalibrations);
  Apply(BlankCalibrations(records), context.corrections);
  return context;
}

}  // namespace

std::vector<NamedRecord> ReadCycleRecords(const CampaignFolder& folder, int cycle) {
  const auto file = folder.CycleFile(cycle);
  if (!std::filesystem::exists(file)) {
    throw CampaignError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: the file of cycle {} is missing (expected the raw records that the "
                    "journal says were stored)",
                    file.string(), cycle));
  }
  auto records = daq::ReadCycleFile(file, daq::Checking::kNone).records;
  for (NamedRecord& named : records) named.group.erase(0, named.group.find_first_not_of('/'));
  return records;
}

std::vector<RecomputedCycle> RecomputeCampaign(
    const CampaignFolder& folder, const Journal& journal, const CycleContext& stored_context,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  const CycleContext context = WithRecalibratedBlank(folder, stored_context);
  std::vector<RecomputedCycle> cycles;
  for (const CycleRow& row : journal.Cycles()) {
    // A campaign that prepares nothing has an empty cycle 0.
    if (row.outcome != "complete" || journal.Phases(row.cycle).empty()) continue;
    RecomputedCycle cycle{row.cycle, {}, {journal.Results(row.cycle, 0)}, false};
    for (const int repeat : journal.RepeatsOf(row.cycle)) {
      if (repeat > 0) cycle.stored.push_back(journal.Results(row.cycle, repeat));
    }
    cycles.push_back(std::move(cycle));
  }
  std::size_t done = 0;
  std::mutex hdf5;  // the library is not thread-safe as Debian builds it
  std::mutex reporting;
  std::vector<std::pair<int, std::string>> findings;
  OnAllProcessors(cycles.size(), [&](std::size_t i) {
    RecomputedCycle& cycle = cycles[i];
    std::string trouble;
    try {
      std::vector<NamedRecord> records;
      {
        const std::lock_guard reading(hdf5);
        records = ReadCycleRecords(folder, cycle.cycle);
      }
      Recalibrate(records, context.recalibrations);
      cycle.again = AnalyzeForStore(records, cycle.cycle, context);
      std::vector<std::vector<Result>> again{cycle.again.results};
      again.insert(again.end(), cycle.again.repeats.begin(), cycle.again.repeats.end());
      cycle.equal = std::ranges::equal(again, cycle.stored, SameResults);
    } catch (const std::exception& error) {
      trouble = error.what();
    }
    const std::lock_guard lock(reporting);
    if (!trouble.empty()) findings.emplace_back(cycle.cycle, trouble);
    ++done;
    if (progress) progress(done, cycles.size());
  });
  if (!findings.empty()) {
    std::ranges::sort(findings);
    std::string text;
    for (const auto& [cycle, what] : findings) text += (text.empty() ? "" : "\n") + what;
    throw CampaignError(ExitCode::kWrongInput, text);
  }
  return cycles;
}

}  // namespace strainwave::bench
