// SPDX-License-Identifier: Apache-2.0
#include "bench/page/page_state.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "bench/campaign/alarms_json.h"
#include "bench/campaign/status_json.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

// The journal's last words of a run that has ended on request.
constexpr std::array<std::string_view, 5> kEndings{"pause", "quick_stop", "quick_stop_key", "shutdown",
                                                   "finish_cycle"};

json NumberOrNull(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? json(*value) : json();
}

json AgeOf(const std::optional<Moment>& then, const Moment& now) {
  return then ? NumberOrNull(PauseBetween(*then, now).length_s) : json();
}

json ValuesJson(const CampaignProgress& progress, const Moment& now) {
  json values = json::array();
  for (const LiveValue& live : progress.live) {
    values.push_back({{"quantity", live.quantity},
                      {"value", NumberOrNull(live.value)},
                      {"unit", live.unit},
                      {"limit", live.limit},
                      {"missing", live.missing},
                      {"age_s", AgeOf(progress.live_taken, now)}});
  }
  return values;
}

json ResultsJson(const std::vector<Result>& results) {
  json all = json::object();
  for (const Result& result : results) {
    all[result.quantity] = {{"value", NumberOrNull(result.value)},
                            {"standard_error", NumberOrNull(result.standard_error)},
                            {"flag", result.flag}};
  }
  return all;
}

std::string EtaBasis(const CampaignProgress& progress) {
  const std::string by = progress.as_planned
                             ? fmt::format("as the newest cycles went, {:.1f} % of what was planned",
                                           100.0 * *progress.as_planned)
                             : std::string("planned durations");
  if (progress.process == 0) return fmt::format("{}, without pauses; nobody runs the campaign now", by);
  if (!progress.pace) return fmt::format("{}, as if in real time; the pace is not known yet", by);
  return fmt::format("{}, at the pace of this run, {:.3g} times real time, without pauses", by,
                     *progress.pace);
}

}  // namespace

std::string_view NameOf(BenchView view) {
  switch (view) {
    case BenchView::kNotBegun:
      return "not_begun";
    case BenchView::kRunning:
      return "running";
    case BenchView::kStopped:
      return "stopped";
    case BenchView::kComplete:
      return "complete";
    case BenchView::kFaulted:
      return "faulted";
    case BenchView::kInterrupted:
      return "interrupted";
    case BenchView::kUnreadable:
      return "unreadable";
  }
  return "";
}

BenchView ViewOf(const CampaignProgress& progress, bool begun) {
  if (progress.process > 0) return BenchView::kRunning;
  if (!begun) return BenchView::kNotBegun;
  if (progress.complete >= progress.cycles) return BenchView::kComplete;
  if (!progress.alarms.empty()) {
    return progress.alarms.front().code == "stop_criterion" ? BenchView::kStopped : BenchView::kFaulted;
  }
  const bool asked =
      progress.last_of_bench && std::ranges::find(kEndings, progress.last_of_bench->code) != kEndings.end();
  return asked ? BenchView::kStopped : BenchView::kInterrupted;
}

std::optional<bool> IsSafe(BenchView view) {
  switch (view) {
    case BenchView::kRunning:
      return false;
    case BenchView::kNotBegun:
    case BenchView::kStopped:
    case BenchView::kComplete:
    case BenchView::kFaulted:
      return true;
    case BenchView::kInterrupted:
    case BenchView::kUnreadable:
      return std::nullopt;
  }
  return std::nullopt;
}

std::string RunId(std::uint64_t campaign, const std::optional<RunBegun>& begun, int process) {
  const bool is_another = begun && process > 0 && begun->process > 0 && begun->process != process;
  return is_another ? fmt::format("{:016x}-of-{}", campaign, process)
                    : fmt::format("{:016x}-{}", campaign, begun ? begun->utc_ms : 0);
}

std::string Sentence(const CampaignSnapshot& snapshot) {
  const CampaignProgress& progress = snapshot.progress;
  const std::string last = progress.last_of_bench ? progress.last_of_bench->text : "";
  switch (snapshot.view) {
    case BenchView::kNotBegun:
      return "the campaign was made and never run";
    case BenchView::kRunning:
      return progress.cycle == 0
                 ? fmt::format("preparation, {}", progress.phase)
                 : fmt::format("cycle {} of {}, {}", progress.cycle, progress.cycles, progress.phase);
    case BenchView::kStopped:
      return fmt::format("{}; torque off, brakes on", last);
    case BenchView::kComplete:
      return fmt::format("all {} cycles are complete; torque off, brakes on", progress.cycles);
    case BenchView::kFaulted:
      return fmt::format("{}; torque off, brakes on", progress.alarms.back().text);
    case BenchView::kInterrupted:
      return "the program that ran it is gone without a word; the drives stop by their own supervision: look "
             "at the bench before anybody goes near, then go on with strainwave run --resume";
    case BenchView::kUnreadable:
      return snapshot.trouble;
  }
  return "";
}

nlohmann::json StateJson(const CampaignSnapshot& snapshot, const Moment& now) {
  const CampaignProgress& progress = snapshot.progress;
  const double eta_s = TimeToEnd_s(progress).value_or(progress.remaining_s);
  const double to_go_s = progress.remaining_s / progress.as_planned.value_or(1.0);  // as planned
  const double share = progress.planned_s > 0.0 ? 1.0 - to_go_s / progress.planned_s : 1.0;
  const auto safe = IsSafe(snapshot.view);
  return {
      {"campaign", snapshot.campaign},
      {"specimen", snapshot.specimen},
      {"run", snapshot.run},
      {"state", NameOf(snapshot.view)},
      {"sentence", Sentence(snapshot)},
      {"safe", safe ? json(*safe) : json()},
      {"process", progress.process},
      {"phase", progress.phase},
      {"phase_outcome", progress.phase_outcome},
      {"phase_share", NumberOrNull(progress.phase_share)},
      {"share", std::clamp(share, 0.0, 1.0)},
      {"cycle", std::min(progress.cycle, progress.cycles)},
      {"cycles", progress.cycles},
      {"cycles_complete", progress.complete},
      {"eta_s", eta_s},
      {"eta_basis", EtaBasis(progress)},
      {"expected_end_utc", progress.pace ? json(UtcText(now.utc_ms + std::llround(1e3 * eta_s))) : json()},
      {"pace", NumberOrNull(progress.pace)},
      {"bench_time_s", progress.bench_time_s},
      {"credited_load_s", snapshot.credited_load_s},
      {"life_share", NumberOrNull(progress.life_share)},
      {"values", ValuesJson(progress, now)},
      {"ages_s",
       {{"readings", AgeOf(progress.live_taken, now)},
        {"checkpoint", AgeOf(progress.checkpoint_written, now)}}},
      {"results_cycle", progress.complete},
      {"results", ResultsJson(progress.last_results)},
      {"stop_criteria", StopsJson(progress.stops)},
      {"bad_channels", ChannelsJson(progress.bad_channels)},
      {"sources", SourcesJson(progress.sources, progress.sources_since_utc_ms)},
      {"picture",
       snapshot.has_camera ? PictureJson(snapshot.picture, progress.complete, now.utc_ms) : json()},
      {"alarms", AlarmsJson(progress.open_alarms, progress.alarm_rules, {})},
      {"notes", NotesJson(progress.notes)},
      {"disk", progress.room ? json{{"free_bytes", progress.room->free_bytes},
                                    {"needed_bytes", progress.room->needed_bytes},
                                    {"lasts_s", NumberOrNull(progress.disk_lasts_s)}}
                             : json()},
      {"last_event", snapshot.last_event},
      {"now_utc", UtcText(now.utc_ms)},
      {"now_ms", now.utc_ms}};
}

nlohmann::json EventJson(const Event& event) {
  return {{"id", event.id},       {"utc", event.utc},     {"bench_time_s", event.time_s},
          {"cycle", event.cycle}, {"phase", event.phase}, {"severity", event.severity},
          {"code", event.code},   {"text", event.text}};
}

}  // namespace strainwave::bench
