// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <system_error>

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/campaign/alarms_json.h"
#include "bench/campaign/campaign_status.h"
#include "bench/campaign/cycle_results.h"
#include "bench/campaign/status_json.h"
#include "bench/commands/alarm_report.h"
#include "bench/commands/check_report.h"
#include "bench/commands/commands.h"
#include "bench/commands/error_text.h"
#include "bench/commands/output.h"
#include "bench/commands/results_table.h"
#include "bench/commands/terminal.h"
#include "bench/errors/bench_error.h"
#include "bench/escaped.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

struct StatusOptions {
  std::string folder;
  bool json{};
  bool check_all{};
};

// A journal of so many bytes, about 17 000 cycles, is compared with its checksums as a matter of course: that
// takes 30 ms at 1.1 GB/s, as long as everything else that `status` does. Of a larger one only what is shown.
constexpr std::uintmax_t kAlwaysChecked_bytes = 32U << 20U;

PagesChecked CheckedOf(const CampaignFolder& folder, bool check_all) {
  std::error_code none;
  const auto bytes = std::filesystem::file_size(folder.Journal(), none);
  return check_all || none || bytes <= kAlwaysChecked_bytes ? PagesChecked::kAll : PagesChecked::kAsRead;
}

CampaignStatus ReadStatus(const CampaignFolder& folder, PagesChecked checked) {
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly, checked);
  for (const std::string& warning : WarningsAbout(folder, journal)) ToStderr("{}\n", warning);
  return StatusOf(folder, journal, ReadFrozenInputs(folder, journal));
}

// Of the newest readings; empty: there are none.
std::string LiveUtc(const CampaignStatus& status) {
  return status.live_taken ? UtcText(status.live_taken->utc_ms) : std::string();
}

bool HasLittleRoom(const CampaignStatus& status) { return status.room && IsLittle(*status.room); }

void PrintLive(const CampaignStatus& status) {
  if (status.process == 0) return;
  const bool fresh = status.live_age_s && *status.live_age_s <= kOldestLive_s;
  ToStdout("  readings     {}\n",
           !status.live_taken ? "– (none yet)"
           : fresh            ? fmt::format("of {}, {:.1f} s ago", LiveUtc(status), *status.live_age_s)
                              : fmt::format("– (the last are of {}, {}: stale)", LiveUtc(status),
                                 status.live_age_s ? DurationText(*status.live_age_s) + " ago" : "long ago"));
  if (!fresh) return;
  for (const LiveValue& live : status.live) {
    ToStdout("    {:16} {:>8} {:4}  {}\n", live.quantity,
             live.value ? fmt::format("{:.4g}", *live.value) : "–", live.unit,
             live.value ? fmt::format("stops at {:.4g}", live.limit) : live.missing);
  }
}

void Print(const CampaignStatus& status, const CampaignFolder& folder, PagesChecked checked) {
  ToStdout("{}: {}\n", folder.root.string(),
           status.process > 0                 ? fmt::format("running in process {}", status.process)
           : status.complete == status.cycles ? "complete"
                                              : "not running");
  ToStdout("  cycles       {} of {} complete\n", status.complete, status.cycles);
  if (!status.phase_outcome.empty()) {
    ToStdout("  phase        {} ({}), load credited in this cycle {:.0f} s\n", status.phase,
             status.phase_outcome, status.credited_load_s);
  }
  if (status.measured_again > 0) {
    ToStdout("  retries      {} measurement(s) of this cycle taken again\n", status.measured_again);
  }
  ToStdout("  bench time   {} so far, about {} to go\n", DurationText(status.bench_time_s),
           DurationText(status.remaining_s));
  if (status.pace) {
    ToStdout(
        "  end          about {:.16}Z, in {}{}\n", EndUtc(status), DurationText(*TimeToEnd_s(status)),
        std::abs(*status.pace - 1.0) < 0.1 ? "" : fmt::format(", at {:.3g} times real time", *status.pace));
  }
  PrintLive(status);
  for (const StopDistance& stop : status.stops) {
    ToStdout("  stops        when {} is {} {:.5g} {}; now {:.5g}\n", stop.quantity,
             stop.is_lower ? "below" : "above", stop.limit, stop.unit, stop.value);
  }
  if (status.life_share)
    ToStdout("  life         {:.3g} % of the bearing's L10\n", 100.0 * *status.life_share);
  for (const Result& result : status.last_results) {
    ToStdout("  {:28} {:12.5g} ± {}{}\n", result.quantity, result.value, ErrorText(result.standard_error),
             result.flag.empty() ? "" : "  " + result.flag);
  }
  for (const auto& [source, count] : status.samples) {
    ToStdout("  samples of {}: {:.0f} received, {:.0f} lost, in all complete cycles\n", source,
             count.received, count.lost);
  }
  if (!status.checks.empty()) ToStdout("sensor checks\n{}", CheckText(status.checks));
  for (const ChannelTrouble& bad : status.bad_channels) {
    ToStdout("  BAD CHANNEL {} {} {}: {}\n", bad.channel, status.process > 0 ? "since" : "at the end, since",
             bad.since_utc, bad.reason);
  }
  if (HasLittleRoom(status) && status.complete < status.cycles) {
    ToStdout("  LITTLE ROOM  {} are free for about {}, and the raw data of the cycles to come may take {}\n",
             BytesText(status.room->free_bytes), DurationText(status.disk_lasts_s),
             BytesText(status.room->needed_bytes));
  }
  ToStdout("{}", AlarmText(status.open_alarms, status.alarm_rules, {}));
  for (const OperatorNote& note : status.notes) {
    ToStdout("  note         {} {}: {}\n", note.utc, Escaped(note.author), Escaped(note.text));
  }
  ToStdout("  interrupted  {} time(s){}; after a pause of up to {} it counts as the same test\n",
           status.holes.size(),
           status.holes.empty()
               ? ""
               : fmt::format(", last at {} ({})", status.holes.back().start_utc, status.holes.back().cause),
           DurationText(status.longest_pause_s));
  if (status.unattended_allowed > 0) {
    ToStdout("  unattended   {} of {} restarts without a person are used up since a person began a run\n",
             status.unattended_restarts, status.unattended_allowed);
  }
  if (checked == PagesChecked::kAsRead) {
    ToStdout(
        "  journal      what is shown was compared with its checksums; all of it: strainwave status {} "
        "--check-all\n",
        folder.root.string());
  }
  for (const Event& event : status.events) {
    ToStdout("  {} cycle {} {}: {}\n", event.utc, event.cycle, event.severity, event.text);
  }
}

nlohmann::json Json(const CampaignStatus& status, PagesChecked checked) {
  nlohmann::json holes = nlohmann::json::array();
  for (const Hole& hole : status.holes) {
    holes.push_back({{"cycle", hole.cycle},
                     {"phase", hole.phase},
                     {"start_utc", hole.start_utc},
                     {"end_utc", hole.end_utc},
                     {"cause", hole.cause}});
  }
  nlohmann::json samples = nlohmann::json::object();
  for (const auto& [source, count] : status.samples) {
    samples[source] = {{"received", count.received}, {"lost", count.lost}};
  }
  nlohmann::json live;
  if (status.live_taken) {
    live = {{"utc", LiveUtc(status)},
            {"age_s", status.live_age_s ? nlohmann::json(*status.live_age_s) : nlohmann::json()},
            {"values", nlohmann::json::array()}};
    for (const LiveValue& value : status.live) {
      live["values"].push_back({{"quantity", value.quantity},
                                {"value", value.value ? nlohmann::json(*value.value) : nlohmann::json()},
                                {"limit", value.limit},
                                {"unit", value.unit},
                                {"missing", value.missing}});
    }
  }
  return {{"running", status.process > 0},
          {"process", status.process},
          {"cycles_complete", status.complete},
          {"cycles", status.cycles},
          {"phase", status.phase},
          {"phase_outcome", status.phase_outcome},
          {"credited_load_s", status.credited_load_s},
          {"bench_time_s", status.bench_time_s},
          {"eta_s", status.remaining_s},
          {"pace", status.pace ? nlohmann::json(*status.pace) : nlohmann::json()},
          {"expected_end_utc", status.pace ? nlohmann::json(EndUtc(status)) : nlohmann::json()},
          {"measured_again", status.measured_again},
          {"little_room", HasLittleRoom(status) ? nlohmann::json{{"free_bytes", status.room->free_bytes},
                                                                 {"needed_bytes", status.room->needed_bytes}}
                                                : nlohmann::json()},
          {"disk", status.room ? nlohmann::json{{"free_bytes", status.room->free_bytes},
                                                {"needed_bytes", status.room->needed_bytes},
                                                {"lasts_s", status.disk_lasts_s}}
                               : nlohmann::json()},
          {"live", std::move(live)},
          {"stop_criteria", StopsJson(status.stops)},
          {"life_share", status.life_share ? nlohmann::json(*status.life_share) : nlohmann::json()},
          {"last_results", CycleJson(status.complete, status.last_results)},
          {"samples", std::move(samples)},
          {"sensor_checks", CheckJson(status.checks)},
          {"bad_channels", ChannelsJson(status.bad_channels)},
          {"alarms", AlarmsJson(status.open_alarms, status.alarm_rules, {})},
          {"notes", NotesJson(status.notes)},
          {"holes", std::move(holes)},
          {"longest_pause_s", status.longest_pause_s},
          {"unattended_restarts", status.unattended_restarts},
          {"unattended_allowed", status.unattended_allowed},
          {"journal_checked", checked == PagesChecked::kAll ? "all" : "as read"}};
}

}  // namespace

void AddStatus(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("status",
                                         "Progress, phase, time to go, last results, open alarms and "
                                         "interruptions of a campaign, running or not.\n"
                                         "Example: strainwave status campaigns/first");
  auto options = std::make_shared<StatusOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_flag("--json", options->json, "JSON on standard output");
  command->add_flag("--check-all", options->check_all,
                    "compare the whole journal with its checksums; above 32 MiB only what is shown is "
                    "compared, as run --resume and recompute compare all of it in any case");
  command->callback([options, &action] {
    action = [options] {
      const CampaignFolder folder{options->folder};
      const PagesChecked checked = CheckedOf(folder, options->check_all);
      const CampaignStatus status = ReadStatus(folder, checked);
      options->json ? ToStdout("{}\n", DocumentOf(Json(status, checked))) : Print(status, folder, checked);
      return static_cast<int>(ExitCode::kDone);
    };
  });
}

}  // namespace strainwave::bench
