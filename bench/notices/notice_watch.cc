// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_watch.h"

#include <sys/stat.h>

#include <cmath>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace strainwave::bench {
namespace {

constexpr std::chrono::seconds kLookEvery{1};
constexpr std::chrono::milliseconds kTakeFor{100};

std::string NameOfFolder(const CampaignFolder& folder) {
  return std::filesystem::weakly_canonical(folder.root).filename().string();
}

// Whoever takes a campaign writes its lock. By UTC alone: nothing where that was set back since.
std::optional<double> HeldFor_s(const CampaignFolder& folder, const Moment& now) {
  struct stat lock {};
  if (::stat(folder.Lock().c_str(), &lock) != 0) return std::nullopt;
  const std::int64_t taken_ms = lock.st_mtim.tv_sec * 1000 + lock.st_mtim.tv_nsec / 1'000'000;
  if (taken_ms > now.utc_ms) return std::nullopt;
  return 1e-3 * static_cast<double>(now.utc_ms - taken_ms);
}

}  // namespace

NoticeLooks::NoticeLooks(const CampaignFolder& folder, bool even_unreadable) : folder_(folder) {
  try {
    watch_ = std::make_unique<CampaignWatch>(folder_);
  } catch (const std::exception& error) {
    if (!even_unreadable) throw;
    trouble_ = error.what();
  }
}

NoticeView NoticeLooks::Look(const Moment& now) {
  const std::string path = std::filesystem::weakly_canonical(folder_.root).string();
  if (!watch_) {
    try {
      watch_ = std::make_unique<CampaignWatch>(folder_);
    } catch (const std::exception& error) {
      trouble_ = error.what();
    }
  }
  CampaignSnapshot snapshot;
  if (watch_) {
    snapshot = watch_->Look().snapshot;
  } else {
    snapshot.campaign = NameOfFolder(folder_);
    snapshot.view = BenchView::kUnreadable;
    snapshot.trouble = fmt::format("the campaign's folder cannot be read: {}", trouble_);
  }
  return NoticeViewOf(snapshot, path, now, HeldFor_s(folder_, now));
}

NoticeWatch::NoticeWatch(const CampaignFolder& folder, const NoticeSettings& settings,
                         const GivenUp& given_up, Log log)
    : folder_(folder),
      file_(NoticeFileOf(folder)),
      rules_(settings.rules),
      given_up_(given_up),
      log_(std::move(log)),
      looks_(folder, std::filesystem::exists(file_)),
      lock_(HoldNotices(folder)),
      post_(MakeSenders(settings, given_up)) {
  std::string trouble;
  state_ = ReadNoticeFile(file_, trouble);
  if (!trouble.empty()) log_(trouble);
  UseChannels(state_.outbox, post_.channels());
}

void NoticeWatch::LookAndPlan() {
  looked_ = std::chrono::steady_clock::now();
  const Moment now = Now();
  Put(state_.outbox, PlanNotices(looks_.Look(now), rules_, state_.memory, now), now);
  for (const std::string& line : GiveUpOld(state_.outbox, now)) log_(line);
  // Before anything is sent: whatever becomes of this process, nothing is planned twice.
  Keep();
}

void NoticeWatch::Hand() {
  const Moment now = Now();
  for (const std::string& channel : post_.channels()) {
    if (!post_.IsFree(channel)) continue;
    if (const Notice* const next = NextFor(state_.outbox, channel, now)) post_.Send(channel, *next);
  }
}

void NoticeWatch::Take(std::chrono::milliseconds patience) {
  const std::vector<NoticePost::Outcome> outcomes = post_.Take(patience);
  for (const NoticePost::Outcome& outcome : outcomes) {
    if (outcome.trouble.empty()) {
      for (const WaitingNotice& waiting : state_.outbox.waiting) {
        if (waiting.notice.id == outcome.id)
          log_(fmt::format("{}: sent: {}", outcome.channel, waiting.notice.subject));
      }
      Delivered(state_.outbox, outcome.channel, outcome.id);
    } else if (!given_up_() && Failed(state_.outbox, outcome.channel, outcome.id, outcome.trouble, Now())) {
      log_(fmt::format("{}: not sent, tried again later: {}", outcome.channel, outcome.trouble));
    }
  }
  if (!outcomes.empty()) Keep();
}

void NoticeWatch::Keep() {
  std::string text = NoticeStateJson(state_).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text == kept_) return;
  std::string trouble;
  try {
    WriteNoticeFile(file_, state_);
    kept_ = std::move(text);
  } catch (const std::exception& error) {
    trouble = error.what();
  }
  if (trouble != std::exchange(keep_trouble_, trouble) && !trouble.empty()) {
    log_(fmt::format("{} (what is sent now may be sent again after a restart)", trouble));
  }
}

void NoticeWatch::Round() {
  if (!looked_ || std::chrono::steady_clock::now() - *looked_ >= kLookEvery) LookAndPlan();
  Hand();
  Take(kTakeFor);
}

bool NoticeWatch::Once() {
  LookAndPlan();
  Hand();
  while (!post_.IsFree() && !given_up_()) {
    Take(kTakeFor);
    Hand();
  }
  return state_.outbox.waiting.empty();
}

}  // namespace strainwave::bench
