// SPDX-License-Identifier: Apache-2.0
// What a campaign does about its sensors: calibrations, checks, raw streams, losses, what is shown of them.
#include <algorithm>
#include <chrono>

#include <fmt/core.h>

#include "bench/campaign/acquisition_results.h"
#include "bench/campaign/calibrations.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/campaign/check_results.h"
#include "bench/utc.h"
#include "daq/synced_folder.h"

namespace strainwave::bench {

// A calibration may run out in a campaign of months, or have been accepted as it is at the start.
void CampaignRunner::NoteCalibrations() {
  for (const CalibrationTrouble& trouble :
       CalibrationTroubles(CalibrationsOf(bench_), machine_.Calibrations(), Today())) {
    if (!noted_channels_.insert(trouble.channel).second) continue;
    Note("warning", "", "calibration", trouble.words + ": the data are stamped with it");
  }
}

// A channel that gives nothing is never shown as good with what it gave last: it stays named until it is
// back.
void CampaignRunner::WatchChannels(std::string_view phase) {
  std::vector<ChannelTrouble> now;
  for (BenchMachine::BadChannel& bad : machine_.BadChannels()) {
    const auto known = std::ranges::find(channel_troubles_, bad.channel, &ChannelTrouble::channel);
    if (known != channel_troubles_.end()) {
      now.push_back({bad.channel, bad.reason, known->since_utc});
      continue;
    }
    now.push_back({bad.channel, bad.reason, UtcNow()});
    Note("warning", phase, "bad_channel", fmt::format("channel {} is bad: {}", bad.channel, bad.reason));
  }
  if (now == channel_troubles_) return;
  for (const ChannelTrouble& before : channel_troubles_) {
    if (std::ranges::find(now, before.channel, &ChannelTrouble::channel) != now.end()) continue;
    Note("info", phase, "good_channel", fmt::format("channel {} is good again", before.channel));
  }
  channel_troubles_ = std::move(now);
  journal_.SetChannelTroubles(channel_troubles_);
}

void CampaignRunner::Show(std::string_view phase, double share) {
  WatchChannels(phase);
  share_ = share;
  progress_.Update({cycle_, schedule_.cycles, phase, share, channel_troubles_});
}

void CampaignRunner::ShowLive(const Readings& readings) {
  live_.Show(readings);
  ShowExtremes();
  live_sources_.Show(machine_.Sources(), Now());
}

void CampaignRunner::ShowExtremes() {
  const LiveExtremes extremes = runner_.TakeExtremes();
  const double time_s = time_base_s_ + std::chrono::duration<double>(extremes.newest - clock_base_).count();
  envelope_.Add(std::clamp(time_s, time_base_s_, Time_s()), extremes);
}

void CampaignRunner::BeginRecording(const CycleStep& step, int repeat) {
  if (step.phase->recorded_sources.empty()) return;
  const auto streams = held_.wherever().Streams();
  daq::MakeFolders(streams);
  const std::string retry = repeat == 0 ? "" : fmt::format("-retry_{}", repeat);
  machine_.StartRecording({step.phase->recorded_sources,
                           streams,
                           fmt::format("{:06d}-{}{}", cycle_, step.phase->name, retry),
                           {{"specimen", schedule_.specimen.identity},
                            {"cycle", std::to_string(cycle_)},
                            {"phase", step.group},
                            {"bench", bench_.name},
                            {"started_utc", UtcNow()}}});
}

std::vector<NamedRecord> CampaignRunner::EndRecording(std::string_view phase) {
  std::vector<NamedRecord> records;
  for (const RecordedSource& recorded : machine_.StopRecording()) {
    if (!recorded.trouble.empty()) {
      Note("warning", phase, "recording",
           fmt::format("the stream of {} is not whole: {}", recorded.name, recorded.trouble));
    }
    records.push_back(RecordingRecord(recorded));
  }
  return records;
}

// Each phase's records say what was lost since the last ones that were kept, so that their sum over a
// campaign is all that was lost.
void CampaignRunner::AddSources(std::vector<NamedRecord>& records) {
  std::vector<SourceTotals> now = machine_.Sources();
  for (const SourceTotals& source : now) {
    const auto before = std::ranges::find(sources_, source.name, &SourceTotals::name);
    records.push_back(SourceRecord(before == sources_.end() ? SourceTotals{} : *before, source));
  }
  sources_ = std::move(now);
}

// A check that fails and is to stop has not been passed: after what was wrong is mended it is run again.
void CampaignRunner::JudgeSensorCheck(const CycleStep& step, PhaseOutcome& outcome) {
  const auto* const check = std::get_if<schedules::SensorCheck>(&step.phase->parameters);
  if (check == nullptr || outcome.reason) return;
  daq::Record& record = outcome.records.front().record;
  if (check->kind == schedules::SensorCheck::Kind::kReference) {
    const std::string quantity = CheckQuantity(record, step.group);
    journal_.ForEachResult(quantity, [&](const CycleResult& earlier) {
      const bool first = earlier.result.quantity == quantity && earlier.result.flag.empty();
      if (first) SetExpected(record, earlier.result.value);
      return !first;
    });
  }
  const std::string failed = SensorCheckResult(record, step.group).flag;
  if (failed.empty()) return;
  if (!check->stops) return Note("warning", step.phase->name, "sensor_check", failed);
  outcome.reason = {StopCause::kSensorCheck, 0.0, 0.0, runner_.last_readings().time};
  outcome.words = fmt::format("{}; {}", failed, AdviceAfter(record));
  outcome.black_box = std::move(outcome.records);
}

}  // namespace strainwave::bench
