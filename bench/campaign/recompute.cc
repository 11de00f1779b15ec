// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/recompute.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <mutex>

#include <fmt/core.h>

#include "bench/campaign/blank_results.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/campaign/salvage_note.h"
#include "bench/errors/bench_error.h"
#include "bench/sha256.h"
#include "daq/cycle_file.h"
#include "daq/record_checks.h"
#include "daq/record_error.h"

namespace strainwave::bench {
namespace {

bool SameBits(double a, double b) {
  // All that are no numbers are alike: of the file's NULL the sign is not known.
  if (std::isnan(a)) return std::isnan(b);
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// Earlier versions did not say that no blank test was made.
bool SameFlag(std::string_view a, std::string_view b) {
  const auto without = [](std::string_view flag) {
    if (!flag.ends_with(kNoBlankFlag)) return flag;
    flag.remove_suffix(kNoBlankFlag.size());
    if (flag.ends_with("; ")) flag.remove_suffix(2);
    return flag;
  };
  return without(a) == without(b);
}

bool SameResults(std::vector<Result> a, std::vector<Result> b) {
  std::ranges::sort(a, {}, &Result::quantity);
  std::ranges::sort(b, {}, &Result::quantity);
  return std::ranges::equal(a, b, [](const Result& x, const Result& y) {
    return x.quantity == y.quantity && SameBits(x.value, y.value) &&
           SameBits(x.standard_error, y.standard_error) && SameFlag(x.flag, y.flag);
  });
}

// The blank test was measured with the same sensors as all that it corrects.
CycleContext WithRecalibratedBlank(const CampaignFolder& folder, const Journal& journal,
                                   CycleContext context) {
  if (context.recalibrations.empty() || !std::filesystem::exists(folder.CycleFile(0))) return context;
  std::vector<NamedRecord> records = ReadCycleRecords(folder, journal, 0);
  Recalibrate(records, context.recalibrations);
  Apply(BlankCalibrations(records), context.corrections);
  return context;
}

bool SameCalibrations(const Journal& journal, const std::vector<Calibration>& again) {
  return std::ranges::all_of(again, [&](const Calibration& calibration) {
    const auto stored = journal.FindCalibration(calibration.name);
    return stored && SameBits(calibration.value, stored->value) &&
           SameBits(calibration.standard_error, stored->standard_error);
  });
}

// Where the journal has no digest, of earlier versions, the file still says what it is.
void CheckStamps(const std::filesystem::path& file, const daq::Attributes& attributes, const Journal& journal,
                 int cycle) {
  const auto schedule = journal.Property("schedule_sha256");
  for (const auto& [key, is] : attributes) {
    if (key == "cycle" && is != std::to_string(cycle)) {
      Refuse(file, fmt::format("holds the records of cycle {}", is), fmt::format("those of cycle {}", cycle));
    }
    if (key == "schedule_sha256" && schedule && is != *schedule) {
      Refuse(file, "holds records of another campaign", "those measured by this campaign's schedule.yaml");
    }
  }
}

}  // namespace

std::vector<NamedRecord> ReadCycleRecords(const CampaignFolder& folder, const Journal& journal, int cycle) {
  const auto file = folder.CycleFile(cycle);
  if (!std::filesystem::exists(file)) {
    throw BenchError(
        ExitCode::kWrongInput,
        fmt::format("{}: error: the file of cycle {} is missing (expected the raw records that the "
                    "journal says were stored)",
                    file.string(), cycle));
  }
  const std::string sha256 = journal.RecordsSha256(cycle);
  const bool as_stored = sha256.empty() || Sha256OfFile(file) == sha256;
  if (!as_stored) daq::DemandReadable(file);
  daq::CycleFile read = daq::ReadCycleFile(file, daq::Checking::kNone);
  CheckStamps(file, read.attributes, journal, cycle);
  if (!as_stored) {
    Refuse(file, "is not the file that was stored", "the file whose SHA-256 is in the journal, " + sha256);
  }
  for (NamedRecord& named : read.records) named.group.erase(0, named.group.find_first_not_of('/'));
  return std::move(read.records);
}

std::vector<RecomputedCycle> RecomputeCampaign(
    const CampaignFolder& folder, const Journal& journal, const CycleContext& stored_context,
    const std::function<void(std::size_t, std::size_t)>& progress) {
  const CycleContext context = WithRecalibratedBlank(folder, journal, stored_context);
  std::vector<RecomputedCycle> cycles;
  const bool salvaged = SalvageNoteOf(journal).has_value();
  for (const CycleRow& row : journal.Cycles()) {
    if (salvaged && !std::filesystem::exists(folder.CycleFile(row.cycle))) continue;
    // A campaign that prepares nothing has an empty cycle 0.
    if (row.outcome != "complete" || journal.Phases(row.cycle).empty()) continue;
    RecomputedCycle cycle{row.cycle, row.ended_s, {}, {journal.Results(row.cycle, 0)}, false};
    for (const int repeat : journal.RepeatsOf(row.cycle)) {
      if (repeat > 0) cycle.stored.push_back(journal.Results(row.cycle, repeat));
    }
    cycles.push_back(std::move(cycle));
  }
  std::size_t done = 0;
  std::mutex files;  // the journal is for one thread; HDF5 lets in one at a time
  std::mutex reporting;
  std::vector<std::pair<int, std::string>> findings;
  OnAllProcessors(cycles.size(), [&](std::size_t i) {
    RecomputedCycle& cycle = cycles[i];
    std::string trouble;
    try {
      std::vector<NamedRecord> records;
      {
        const std::lock_guard reading(files);
        records = ReadCycleRecords(folder, journal, cycle.cycle);
      }
      Recalibrate(records, context.recalibrations);
      cycle.again = AnalyzeForStore(records, cycle.cycle, context);
      std::vector<std::vector<Result>> again{cycle.again.results};
      again.insert(again.end(), cycle.again.repeats.begin(), cycle.again.repeats.end());
      cycle.equal = std::ranges::equal(again, cycle.stored, SameResults);
      if (!cycle.again.calibrations.empty()) {
        const std::lock_guard reading(files);
        cycle.equal = cycle.equal && SameCalibrations(journal, cycle.again.calibrations);
      }
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
    throw BenchError(ExitCode::kWrongInput, text);
  }
  return cycles;
}

}  // namespace strainwave::bench
