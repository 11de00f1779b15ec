// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_view.h"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>

namespace strainwave::bench {
namespace {

std::optional<std::int64_t> ReadUtc_ms(const std::string& text) {
  int year{}, month{}, day{}, hour{}, minute{}, second{}, millisecond{};
  if (std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d.%3dZ", &year, &month, &day, &hour, &minute, &second,
                  &millisecond) != 7) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!date.ok()) return std::nullopt;
  const std::int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return (((days * 24 + hour) * 60 + minute) * 60 + second) * 1000 + millisecond;
}

}  // namespace

Moment MomentOf(const std::string& utc, const Moment& now) {
  const auto utc_ms = ReadUtc_ms(utc);
  if (!utc_ms || *utc_ms > now.utc_ms) return now;
  return {*utc_ms, now.since_boot_ms - (now.utc_ms - *utc_ms), now.boot};
}

NoticeView NoticeViewOf(const CampaignSnapshot& snapshot, const std::string& folder, const Moment& now,
                        const std::optional<double>& held_s) {
  const CampaignProgress& progress = snapshot.progress;
  NoticeView view;
  view.campaign = snapshot.campaign;
  view.specimen = snapshot.specimen;
  view.folder = folder;
  view.run = snapshot.run;
  view.view = snapshot.view;
  view.sentence = Sentence(snapshot);
  view.process = progress.process;
  view.alarms = progress.open_alarms;
  view.rules = progress.alarm_rules;
  if (progress.process == 0) return view;
  const auto take = [&](const std::optional<double>& age_s) {
    if (age_s && *age_s >= 0.0) view.quiet_s = std::min(view.quiet_s.value_or(*age_s), *age_s);
  };
  take(held_s);
  for (const auto& sign : {progress.live_taken, progress.checkpoint_written}) {
    if (sign) take(PauseBetween(*sign, now).length_s);
  }
  if (progress.run_begun) take(PauseBetween(progress.run_begun->moment(), now).length_s);
  return view;
}

}  // namespace strainwave::bench
