// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_file.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/errors/bench_error.h"
#include "bench/json_text.h"
#include "daq/whole_file.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr int kFileVersion = 1;
constexpr std::array kViews{BenchView::kNotBegun,  BenchView::kRunning, BenchView::kStopped,
                            BenchView::kComplete,  BenchView::kFaulted, BenchView::kInterrupted,
                            BenchView::kUnreadable};

json MomentJson(const Moment& moment) {
  return {{"utc_ms", moment.utc_ms}, {"since_boot_ms", moment.since_boot_ms}, {"boot", moment.boot}};
}
json MomentJson(const std::optional<Moment>& moment) { return moment ? MomentJson(*moment) : json(); }

Moment MomentFrom(const json& entry) {
  return {entry.at("utc_ms").get<std::int64_t>(), entry.at("since_boot_ms").get<std::int64_t>(),
          entry.at("boot").get<std::uint64_t>()};
}
std::optional<Moment> OptionalMomentFrom(const json& entry) {
  return entry.is_null() ? std::nullopt : std::optional(MomentFrom(entry));
}

BenchView ViewNamed(const std::string& name) {
  const auto found = std::ranges::find(kViews, name, [](BenchView view) { return NameOf(view); });
  if (found == kViews.end()) throw std::invalid_argument("there is no state " + name);
  return *found;
}

// An alarm is kept as a notice would tell it.
json KeptAlarmJson(const KeptAlarm& kept) {
  Notice notice;
  notice.alarms = {kept.alarm};
  return {{"alarm", NoticeJson(notice).at("alarms").at(0)},
          {"raised", MomentJson(kept.raised)},
          {"acknowledged", kept.acknowledged},
          {"notified", MomentJson(kept.notified)},
          {"escalated", MomentJson(kept.escalated)}};
}

KeptAlarm KeptAlarmFrom(const json& entry) {
  json notice = NoticeJson(Notice{});
  notice["alarms"] = json::array({entry.at("alarm")});
  return {NoticeFrom(notice).alarms.front(), MomentFrom(entry.at("raised")),
          entry.at("acknowledged").get<bool>(), OptionalMomentFrom(entry.at("notified")),
          OptionalMomentFrom(entry.at("escalated"))};
}

json MemoryJson(const NoticeMemory& memory) {
  json alarms = json::array();
  for (const KeptAlarm& kept : memory.alarms) alarms.push_back(KeptAlarmJson(kept));
  json sent = json::array();
  for (const Moment& moment : memory.sent) sent.push_back(MomentJson(moment));
  json silence;
  if (memory.silence) {
    silence = {{"notified", MomentJson(memory.silence->notified)}, {"escalated", memory.silence->escalated}};
  }
  return {{"alarms", std::move(alarms)},   {"silence", std::move(silence)},
          {"ended_run", memory.ended_run}, {"run", memory.run},
          {"state", NameOf(memory.view)},  {"since", MomentJson(memory.since)},
          {"sent", std::move(sent)},       {"last_number", memory.last_number}};
}

NoticeMemory MemoryFrom(const json& entry) {
  NoticeMemory memory;
  for (const json& kept : entry.at("alarms")) memory.alarms.push_back(KeptAlarmFrom(kept));
  if (const json& silence = entry.at("silence"); !silence.is_null()) {
    memory.silence = {MomentFrom(silence.at("notified")), silence.at("escalated").get<bool>()};
  }
  entry.at("ended_run").get_to(memory.ended_run);
  entry.at("run").get_to(memory.run);
  memory.view = ViewNamed(entry.at("state").get<std::string>());
  memory.since = MomentFrom(entry.at("since"));
  for (const json& moment : entry.at("sent")) memory.sent.push_back(MomentFrom(moment));
  entry.at("last_number").get_to(memory.last_number);
  return memory;
}

}  // namespace

std::filesystem::path NoticeFileOf(const CampaignFolder& folder) { return folder.root / "notices.json"; }

json NoticeStateJson(const NoticeState& state) {
  json waiting = json::array();
  for (const WaitingNotice& notice : state.outbox.waiting) {
    waiting.push_back({{"notice", NoticeJson(notice.notice)},
                       {"planned", MomentJson(notice.planned)},
                       {"channels", notice.channels},
                       {"tries", notice.tries}});
  }
  json channels = json::array();
  for (const ChannelState& channel : state.outbox.channels) {
    channels.push_back({{"name", channel.name},
                        {"failures", channel.failures},
                        {"failed", MomentJson(channel.failed)},
                        {"trouble", channel.trouble}});
  }
  return {{"notices", kFileVersion},
          {"memory", MemoryJson(state.memory)},
          {"waiting", std::move(waiting)},
          {"channels", std::move(channels)}};
}

NoticeState NoticeStateFrom(const json& document) {
  if (document.at("notices").get<int>() != kFileVersion) throw std::invalid_argument("of another version");
  NoticeState state;
  state.memory = MemoryFrom(document.at("memory"));
  for (const json& entry : document.at("waiting")) {
    state.outbox.waiting.push_back({NoticeFrom(entry.at("notice")), MomentFrom(entry.at("planned")),
                                    entry.at("channels").get<std::vector<std::string>>(),
                                    entry.at("tries").get<int>()});
  }
  for (const json& entry : document.at("channels")) {
    state.outbox.channels.push_back({entry.at("name").get<std::string>(), entry.at("failures").get<int>(),
                                     OptionalMomentFrom(entry.at("failed")),
                                     entry.at("trouble").get<std::string>()});
  }
  return state;
}

NoticeState ReadNoticeFile(const std::filesystem::path& file, std::string& trouble) {
  trouble.clear();
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  try {
    return NoticeStateFrom(ParseUnorderedJson(daq::ReadWholeFile(file)));
  } catch (const std::exception& wrong) {
    trouble =
        fmt::format("{}: cannot be used, what was sent may be sent again: {}", file.string(), wrong.what());
    return {};
  }
}

void WriteNoticeFile(const std::filesystem::path& file, const NoticeState& state) {
  constexpr int kIndent = 1;
  daq::WriteFileAtomically(
      file, NoticeStateJson(state).dump(kIndent, ' ', false, json::error_handler_t::replace) + "\n");
}

daq::FileDescriptor HoldNotices(const CampaignFolder& folder) {
  const std::filesystem::path file = folder.root / "notices.lock";
  daq::FileDescriptor lock(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!lock.is_open()) throw std::system_error(errno, std::generic_category(), file.string());
  if (::flock(lock.get(), LOCK_EX | LOCK_NB) != 0) {
    Refuse(folder.root, "another strainwave watch sends its notices already",
           "one watch a campaign: end that one, or leave it at that");
  }
  return lock;
}

}  // namespace strainwave::bench
