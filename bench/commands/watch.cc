// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/campaign/folder.h"
#include "bench/commands/commands.h"
#include "bench/commands/no_core.h"
#include "bench/commands/output.h"
#include "bench/commands/person.h"
#include "bench/errors/bench_error.h"
#include "bench/notices/notice_watch.h"
#include "bench/utc.h"

namespace strainwave::bench {
namespace {

struct WatchOptions {
  std::string folder;
  std::string notices;
  bool once{};
  bool test{};
  bool dry_run{};
};

bool IsToEnd() { return Requested() != StopRequest::kNone; }

int Test(const CampaignFolder& folder, const NoticeSettings& settings) {
  const Moment now = Now();
  const Notice notice = TestNotice(NoticeLooks(folder, false).Look(now), now);
  bool all = true;
  for (const NamedSender& channel : MakeSenders(settings, IsToEnd)) {
    const std::string trouble = channel.sender->Send(notice);
    all = all && trouble.empty();
    ToStdout("{} to {}: {}\n", channel.name, channel.to,
             trouble.empty() ? "taken" : fmt::format("NOT taken: {}", trouble));
  }
  return static_cast<int>(all ? ExitCode::kDone : ExitCode::kMachineFailed);
}

// What a look now would send, by what is kept of the looks before.
int ShowDue(const CampaignFolder& folder, const NoticeSettings& settings) {
  std::string trouble;
  NoticeMemory memory = ReadNoticeFile(NoticeFileOf(folder), trouble).memory;
  if (!trouble.empty()) ToStderr("{}\n", trouble);
  const Moment now = Now();
  const NoticeView view = NoticeLooks(folder, false).Look(now);
  const std::vector<Notice> due = PlanNotices(view, settings.rules, memory, now);
  for (const Notice& notice : due) ToStdout("{}\n{}\n", notice.subject, notice.text);
  ToStdout("{}: {}; {} notice(s) due\n", folder.root.string(), NameOf(view.view), due.size());
  return static_cast<int>(ExitCode::kDone);
}

int WatchCampaign(const WatchOptions& options) {
  LeaveNoCore();
  ListenForQuickStop();
  const CampaignFolder folder{options.folder};
  const NoticeSettings settings = ReadNoticeSettings(options.notices);
  if (!std::filesystem::is_directory(folder.root)) {
    Refuse(folder.root, "there is no such folder",
           fmt::format("that of a campaign, which strainwave run SCHEDULE --out {} makes", options.folder));
  }
  if (options.test) return Test(folder, settings);
  if (options.dry_run) return ShowDue(folder, settings);
  // Nobody who reads the words, or does not, holds up the watch.
  const LiveOutput output(IsToEnd, LiveOutput::Results::kDropped);
  NoticeWatch watch(folder, settings, IsToEnd,
                    [](const std::string& line) { ToStderr("{} {}\n", UtcNow(), line); });
  if (options.once) {
    const bool all = watch.Once();
    return static_cast<int>(all ? ExitCode::kDone : ExitCode::kMachineFailed);
  }
  ToStderr("{} {}: watched (Ctrl-C ends the watch, not the campaign)\n", UtcNow(), options.folder);
  while (!IsToEnd()) watch.Round();
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddWatch(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "watch",
      "Send word of a campaign to whoever is not there, by mail, webhook or MQTT: alarms that nobody has "
      "acknowledged, a fault, the end, and silence, which is a program that is gone or frozen.\n"
      "It is a program of its own that only reads the campaign and keeps what it has sent in notices.json "
      "beside: a restart tells nothing twice. The settings file says over which channels and when "
      "(bench/notices/notices.yaml has every key). --once looks once and sends what is due, as from a "
      "timer; exit code 3 where a channel did not take it. Ctrl-C ends the watch, not the campaign.\n"
      "Example: strainwave watch campaigns/first --notices bench/notices/notices.yaml --test");
  auto options = std::make_shared<WatchOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_option("--notices", options->notices, "channels and times (YAML)")->required();
  CLI::Option* const once = command->add_flag("--once", options->once, "look once, send what is due, end");
  CLI::Option* const test =
      command->add_flag("--test", options->test, "send a test over each channel and say what came of it")
          ->excludes(once);
  command->add_flag("--dry-run", options->dry_run, "print what is due now; nothing is sent or kept")
      ->excludes(once)
      ->excludes(test);
  command->callback([options, &action] { action = [options] { return WatchCampaign(*options); }; });
}

}  // namespace strainwave::bench
