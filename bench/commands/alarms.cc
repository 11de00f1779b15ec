// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <CLI/CLI.hpp>

#include "bench/campaign/alarms_json.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_alarms.h"
#include "bench/campaign/signed_words.h"
#include "bench/commands/alarm_report.h"
#include "bench/commands/commands.h"
#include "bench/commands/moving_limits.h"
#include "bench/commands/output.h"
#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

struct AlarmsOptions {
  std::string folder;
  std::string verb;
  std::string number;
  std::string by;
  std::string comment;
  std::string length;
  bool all{};
  bool json{};
};

const std::map<std::string, AlarmEvent>& Verbs() {
  static const std::map<std::string, AlarmEvent> verbs{{"acknowledge", AlarmEvent::kAcknowledge},
                                                       {"confirm", AlarmEvent::kConfirm},
                                                       {"comment", AlarmEvent::kComment},
                                                       {"shelve", AlarmEvent::kShelve},
                                                       {"unshelve", AlarmEvent::kUnshelve}};
  return verbs;
}

std::int64_t NumberOf(const AlarmsOptions& options) {
  std::int64_t number{};
  const char* const end = options.number.data() + options.number.size();
  const auto [read, error] = std::from_chars(options.number.data(), end, number);
  if (error == std::errc() && read == end && number > 0) return number;
  throw BenchError(
      ExitCode::kWrongInput,
      fmt::format("{}: error: '{}' is no number of an alarm (expected one that strainwave alarms {} "
                  "shows)",
                  options.verb, options.number, options.folder));
}

double LengthOf_s(const AlarmsOptions& options) {
  const bool shelves = options.verb == "shelve";
  if (shelves && options.length.empty()) {
    throw BenchError(ExitCode::kWrongInput,
                     "shelve: error: --for is missing (expected how long, as in --for 30min)");
  }
  if (!shelves && !options.length.empty()) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("--for {}: error: {} takes no time (expected it with shelve alone)",
                                 options.length, options.verb));
  }
  return shelves ? OptionQuantity("--for", options.length, schedules::Dimension::kTime) : 0.0;
}

int ActAsAsked(const AlarmsOptions& options, const CampaignFolder& folder) {
  AlarmRequest request;
  request.event = Verbs().at(options.verb);
  request.number = NumberOf(options);
  request.by = SignerOf(options.by);
  request.text = WordsOf("--comment", options.comment, request.event != AlarmEvent::kComment);
  request.shelf_length_s = LengthOf_s(options);
  Journal journal = OpenCampaign(folder, Database::Mode::kReadWrite);
  const AlarmInstance now = ActOnAlarm(folder, journal, request, Now());
  if (options.json) {
    const auto rules = ReadFrozenInputs(folder, journal).bench.alarms;
    ToStdout("{}\n", DocumentOf(AlarmsJson({&now, 1}, rules, journal.AlarmActions()).front()));
  } else {
    ToStdout("alarm {}: {}\n", now.number, StateText(now));
  }
  return static_cast<int>(ExitCode::kDone);
}

int List(const AlarmsOptions& options, const CampaignFolder& folder) {
  const Journal journal = OpenCampaign(folder, Database::Mode::kReadOnly);
  const auto rules = ReadFrozenInputs(folder, journal).bench.alarms;
  if (options.json) {
    ToStdout("{}\n", DocumentOf(AlarmListJson(journal, rules, options.all, Now())));
    return static_cast<int>(ExitCode::kDone);
  }
  const auto [alarms, ever] = ReadAlarms(journal, options.all, Now());
  ToStdout("{}: {} open alarm(s), {} in all\n{}", folder.root.string(),
           std::ranges::count_if(alarms, [](const AlarmInstance& alarm) { return IsOpen(alarm.state); }),
           ever, AlarmText(alarms, rules, journal.AlarmActions()));
  return static_cast<int>(ExitCode::kDone);
}

}  // namespace

void AddAlarms(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand(
      "alarms",
      "The alarms of a campaign, running or not: list them, or do something about one of them by its "
      "number.\n"
      "acknowledge: it was seen. confirm: the cause of a latched one is mended. comment. shelve: out of the "
      "way "
      "for a stated time, at most 24 h. unshelve. None of these moves a shaft or changes a limit.\n"
      "Example: strainwave alarms campaigns/first acknowledge 1 --by \"A. Meier\"");
  auto options = std::make_shared<AlarmsOptions>();
  command->add_option("DIR", options->folder, "the campaign's folder")->required();
  command->add_option("VERB", options->verb, "acknowledge, confirm, comment, shelve or unshelve")
      ->check(CLI::IsMember({"acknowledge", "confirm", "comment", "shelve", "unshelve"}));
  command->add_option("N", options->number, "the alarm's number");
  command->add_option("--by", options->by, "name of the person who does that");
  command->add_option("--comment", options->comment, "what there is to say about it");
  command->add_option("--for", options->length, "of shelve: how long, as in 30min");
  command->add_flag("--all", options->all, "list those that are cleared, too");
  command->add_flag("--json", options->json, "JSON on standard output");
  command->callback([options, &action] {
    action = [options] {
      const CampaignFolder folder{options->folder};
      return options->verb.empty() ? List(*options, folder) : ActAsAsked(*options, folder);
    };
  });
}

}  // namespace strainwave::bench
