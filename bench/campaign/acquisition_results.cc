// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/acquisition_results.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/core.h>

#include "daq/acquisition/running_statistics.h"

namespace strainwave::bench {
namespace {

using daq::acquisition::RunningStatistics;

constexpr double kPpm = 1e6;

void Add(daq::Record& record, const char* name, double value) {
  record.columns.push_back({name, std::vector<double>{value}, {}, {}});
}

double Count(std::uint64_t now, std::uint64_t before) { return static_cast<double>(now - before); }

double FirstOf(const daq::Record& record, std::string_view column) {
  return record.FindColumn(column) == nullptr ? std::nan("") : record.Doubles(column)[0];
}

// The first row of a channel's moments; no samples where it has none.
RunningStatistics StatisticsOf(const daq::Record& record, const std::string& channel) {
  const auto of = [&](const char* what) { return FirstOf(record, channel + what); };
  if (std::isnan(of("_count"))) return {};
  return RunningStatistics({of("_count"), of("_mean_m_per_s2"), of("_second_moment_m2_per_s4"),
                            of("_third_moment_m3_per_s6"), of("_fourth_moment_m4_per_s8"),
                            of("_least_m_per_s2"), of("_most_m_per_s2")});
}

}  // namespace

NamedRecord SourceRecord(const SourceTotals& before, const SourceTotals& now) {
  NamedRecord named{"source_" + now.name, {}};
  daq::Record& record = named.record;
  record.kind = daq::RecordKind::kHistory;
  record.SetMetadata("source", now.name);
  Add(record, "time_s", 0.0);
  Add(record, "received_samples", Count(now.samples.received, before.samples.received));
  Add(record, "lost_samples", Count(now.samples.lost, before.samples.lost));
  Add(record, "estimated_samples", Count(now.samples.estimated, before.samples.estimated));
  Add(record, "repeated_samples", Count(now.samples.repeated, before.samples.repeated));
  Add(record, "gaps_count", Count(now.samples.gaps, before.samples.gaps));
  Add(record, "resets_count", Count(now.samples.resets, before.samples.resets));
  Add(record, "clock_restarts_count", Count(now.clock_restarts, before.clock_restarts));
  if (now.clock) {
    const auto offset = now.clock->host_time - now.clock->device_time;
    Add(record, "clock_offset_s", std::chrono::duration<double>(offset).count());
    Add(record, "clock_offset_ci95_s", now.clock->offset_uncertainty_s);
    Add(record, "clock_drift_ppm", kPpm * now.clock->drift);
    Add(record, "clock_drift_ci95_ppm", kPpm * now.clock->drift_uncertainty);
  }
  return named;
}

NamedRecord RecordingRecord(const RecordedSource& recorded) {
  NamedRecord named{"recording_" + recorded.name, {}};
  daq::Record& record = named.record;
  record.kind = daq::RecordKind::kHistory;
  record.SetMetadata("recording", recorded.name);
  if (!recorded.trouble.empty()) record.SetMetadata("trouble", recorded.trouble);
  const auto& totals = recorded.totals;
  Add(record, "time_s", 0.0);
  Add(record, "received_samples", static_cast<double>(totals.samples.received));
  Add(record, "lost_samples", static_cast<double>(totals.samples.lost));
  Add(record, "gaps_count", static_cast<double>(totals.samples.gaps));
  Add(record, "not_written_samples", static_cast<double>(totals.not_written));
  Add(record, "blocks_without_room_count", static_cast<double>(totals.blocks_without_room));
  Add(record, "files_count", static_cast<double>(totals.files));
  return named;
}

std::vector<Result> SourceResults(std::span<const NamedRecord> records) {
  struct Sums {
    double received{}, lost{}, estimated{};
    double drift_ppm{std::nan("")};
    double drift_ci95_ppm{};
  };
  std::map<std::string, Sums> sources;
  std::map<std::string, double> lost_in_files;
  for (const NamedRecord& named : records) {
    const daq::Record& record = named.record;
    if (const auto name = record.Metadata("recording")) {
      lost_in_files[*name] += FirstOf(record, "lost_samples") + FirstOf(record, "not_written_samples");
    }
    const auto name = record.Metadata("source");
    if (!name) continue;
    Sums& sums = sources[*name];
    sums.received += FirstOf(record, "received_samples");
    sums.lost += FirstOf(record, "lost_samples");
    sums.estimated += FirstOf(record, "estimated_samples");
    if (record.FindColumn("clock_drift_ppm") == nullptr) continue;
    sums.drift_ppm = FirstOf(record, "clock_drift_ppm");
    sums.drift_ci95_ppm = FirstOf(record, "clock_drift_ci95_ppm");
  }
  std::vector<Result> results;
  for (const auto& [name, sums] : sources) {
    const std::string flag =
        sums.estimated > 0.0
            ? fmt::format("{:.0f} of them told from the time that went by, not from a counter",
                          sums.estimated)
            : "";
    results.push_back({kSamplesReceived + name, sums.received, 0.0, ""});
    results.push_back({kSamplesLost + name, sums.lost, 0.0, flag});
    if (std::isnan(sums.drift_ppm)) continue;
    results.push_back({"clock_drift_ppm_" + name, sums.drift_ppm, 0.5 * sums.drift_ci95_ppm, ""});
  }
  for (const auto& [name, lost] : lost_in_files) {
    results.push_back({"samples_lost_in_files_" + name, lost, 0.0, ""});
  }
  return results;
}

std::vector<Result> VibrationStatisticsResults(std::span<const NamedRecord> records) {
  std::map<std::pair<std::string, std::string>, RunningStatistics> merged;
  for (const NamedRecord& named : records) {
    if (named.record.Metadata("statistics") != "vibration") continue;
    const std::string phase = named.group.substr(0, named.group.rfind('/'));
    for (const char* channel : kAccelerometers) {
      merged[{phase, channel}].Merge(StatisticsOf(named.record, channel));
    }
  }
  std::vector<Result> results;
  for (const auto& [place, statistics] : merged) {
    if (statistics.count() == 0) continue;
    const auto& [phase, channel] = place;
    // About the mean, so that a sensor's offset is no vibration.
    const double rms = std::sqrt(statistics.variance());
    const double peak =
        std::max(statistics.most() - statistics.mean(), statistics.mean() - statistics.least());
    const auto add = [&, p = phase, c = channel](const char* what, const char* unit, double value) {
      results.push_back({fmt::format("{}_vibration_{}_{}{}", p, what, c, unit), value, 0.0, ""});
    };
    add("rms", "_m_per_s2", rms);
    add("peak", "_m_per_s2", peak);
    add("crest", "", rms > 0.0 ? peak / rms : std::nan(""));
    add("kurtosis", "", statistics.kurtosis());
  }
  return results;
}

}  // namespace strainwave::bench
