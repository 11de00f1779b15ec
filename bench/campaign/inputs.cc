// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/core.h>

#include "bench/campaign/campaign.h"
#include "bench/configuration/check_schedule.h"
#include "bench/configuration/embedded_bench.h"
#include "bench/configuration/read_bench_file.h"
#include "schedules/reader/read_schedule.h"
#include "schedules/reader/validate_schedule.h"

namespace strainwave::bench {
namespace {

// The frozen bench file names the copy of the plant file that lies beside it.
std::string WithPlantFile(const std::string& text, const std::string& named) {
  std::string frozen = text;
  const std::size_t key = frozen.find("plant_file:");
  const std::size_t value = key == std::string::npos ? key : frozen.find(named, key);
  if (value == std::string::npos) return frozen;
  return frozen.replace(value, named.size(), "plant.yaml");
}

CampaignInputs ReadBoth(const std::filesystem::path& schedule,
                        const std::optional<std::filesystem::path>& bench) {
  CampaignInputs inputs;
  inputs.schedule = schedules::ReadSchedule(schedule);
  inputs.schedule_text = ReadText(schedule);
  if (bench) {
    inputs.bench = ReadBenchFile(*bench);
    inputs.bench_text = ReadText(*bench);
    // A bare name has no parent before it is made absolute.
    inputs.bench_folder = std::filesystem::absolute(*bench).parent_path();
    if (const std::string& named = inputs.bench.simulation.plant_file; !named.empty()) {
      inputs.plant_text = ReadText(bench->parent_path() / named);
      inputs.bench_text = WithPlantFile(inputs.bench_text, named);
    }
  } else {
    inputs.bench = EmbeddedBench();
    inputs.bench_text = EmbeddedBenchText();
  }
  return inputs;
}

}  // namespace

CampaignInputs ReadInputs(const std::filesystem::path& schedule,
                          const std::optional<std::filesystem::path>& bench) {
  CampaignInputs inputs = ReadBoth(schedule, bench);
  const schedules::FindingList findings = CheckScheduleAgainstBench(inputs.schedule, inputs.bench);
  if (findings.has_errors()) throw schedules::ScheduleError(schedule.string(), findings);
  return inputs;
}

schedules::FindingList WarningsOf(const CampaignInputs& inputs) {
  const schedules::Schedule& schedule = inputs.schedule;
  schedules::FindingList warnings = schedules::ValidateSchedule(schedule);
  warnings.Append(CheckScheduleAgainstBench(schedule, inputs.bench));
  const auto is_blank = [](const schedules::Phase& phase) {
    return std::holds_alternative<schedules::BlankTest>(phase.parameters);
  };
  if (std::ranges::any_of(schedule.preparation, is_blank)) return warnings;
  for (const schedules::Phase& phase : schedule.phases) {
    if (!std::holds_alternative<schedules::HysteresisTest>(phase.parameters)) continue;
    warnings.AddWarning(
        phase.line, 1,
        "the stiffness will include the twist of couplings and sensor (a blank_test in preparation "
        "measures and removes it)");
  }
  return warnings;
}

CampaignInputs ReadFrozenInputs(const CampaignFolder& folder, const Journal& journal) {
  // They were held against each other at the start, with profiles of drives that need not be here.
  CampaignInputs inputs = ReadBoth(folder.Schedule(), folder.Bench());
  if (const auto cycles = journal.Property(kCycles)) inputs.schedule.cycles = std::stoi(*cycles);
  return inputs;
}

}  // namespace strainwave::bench
