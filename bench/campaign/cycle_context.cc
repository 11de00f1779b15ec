// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/cycle_context.h"

#include <map>
#include <utility>

#include <fmt/core.h>

#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/blank_results.h"
#include "bench/campaign/on_all_processors.h"
#include "bench/campaign/quality.h"

namespace strainwave::bench {
namespace {

// "repeat_N/…" → N; 0 for anything else.
int RepeatOf(const std::string& group) {
  constexpr std::string_view kPrefix = "repeat_";
  if (!group.starts_with(kPrefix)) return 0;
  return std::stoi(group.substr(kPrefix.size()));
}

StoredCycle AnalyzePreparation(std::span<const NamedRecord> records, const CycleContext& context) {
  StoredCycle stored;
  stored.calibrations = BlankCalibrations(records);
  stored.results = SensorCheckResults(records);
  // The repeats are measured after the blank, so they are already corrected by what it has shown.
  CycleContext corrected = context;
  Apply(stored.calibrations, corrected.corrections);
  corrected.corrections.repeatability.clear();  // it is what the repeats are to show
  std::map<int, std::vector<NamedRecord>> repeats;
  for (const NamedRecord& named : records) {
    const int repeat = RepeatOf(named.group);
    if (repeat == 0) continue;
    repeats[repeat].push_back({named.group.substr(named.group.find('/') + 1), named.record});
  }
  std::vector<int> numbers;
  for (const auto& [repeat, repeat_records] : repeats) numbers.push_back(repeat);
  std::vector<CycleAnalysis> analyses(numbers.size());
  OnAllProcessors(numbers.size(),
                  [&](std::size_t i) { analyses[i] = AnalyzeCycle(repeats.at(numbers[i]), corrected); });
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (const std::string& check : analyses[i].failed_checks) {
      stored.failed_checks.push_back(fmt::format("repeat {}: {}", numbers[i], check));
    }
    stored.repeats.push_back(std::move(analyses[i].results));
  }
  for (Calibration& gauge : RepeatabilityOf(stored.repeats)) stored.calibrations.push_back(std::move(gauge));
  return stored;
}

}  // namespace

CycleContext ContextOf(const Journal& journal, const schedules::Schedule& schedule,
                       const BenchDescription& bench) {
  CycleContext context;
  context.ratio = schedule.specimen.ratio;
  context.corrections.torque_gain_relative_se = bench.transducer.relative_gain_uncertainty;
  context.corrections.encoder.reference_accuracy_rad = bench.blank_reference_accuracy_rad;
  context.corrections.encoder_accuracy_rad = bench.output_encoder.accuracy_rad;
  for (const Calibration& gauge : journal.CalibrationsLike(kRepeatabilityPrefix)) {
    context.corrections.repeatability[gauge.name.substr(kRepeatabilityPrefix.size())] = gauge.value;
  }
  context.declared_temperature_degC = schedule.measurements.declared_temperature_degC;
  context.temperature_tolerance_K = schedule.measurements.temperature_tolerance_K;
  std::vector<Calibration> calibrations;
  for (const char* name : kBlankCalibrations) {
    if (auto calibration = journal.FindCalibration(name)) calibrations.push_back(std::move(*calibration));
  }
  Apply(calibrations, context.corrections);
  return context;
}

StoredCycle AnalyzeForStore(std::span<const NamedRecord> records, int cycle, const CycleContext& context) {
  StoredCycle stored;
  if (cycle == 0) {
    stored = AnalyzePreparation(records, context);
  } else {
    CycleAnalysis analysis = AnalyzeCycle(records, context);
    stored.results = std::move(analysis.results);
    stored.failed_checks = std::move(analysis.failed_checks);
  }
  // Of everything that was measured, also of what was then measured again.
  for (Result& result : SourceResults(records)) stored.results.push_back(std::move(result));
  return stored;
}

}  // namespace strainwave::bench
