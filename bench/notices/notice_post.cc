// SPDX-License-Identifier: Apache-2.0
#include "bench/notices/notice_post.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <thread>
#include <utility>

namespace strainwave::bench {

struct NoticePost::Channel {
  NamedSender sender;
  std::optional<Notice> notice;  // given, or under way
  bool busy{};                   // until somebody has taken what has come of it
  std::thread thread;
};

NoticePost::NoticePost(std::vector<NamedSender> senders) {
  for (NamedSender& sender : senders) {
    channels_.push_back(std::make_unique<Channel>());
    channels_.back()->sender = std::move(sender);
  }
  for (const auto& channel : channels_) {
    channel->thread = std::thread([this, at = channel.get()] { Work(*at); });
  }
}

NoticePost::~NoticePost() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  given_.notify_all();
  for (const auto& channel : channels_) channel->thread.join();
}

std::vector<std::string> NoticePost::channels() const {
  std::vector<std::string> names;
  for (const auto& channel : channels_) names.push_back(channel->sender.name);
  return names;
}

bool NoticePost::IsFree(std::string_view channel) const {
  const std::lock_guard lock(mutex_);
  return std::ranges::any_of(
      channels_, [&](const auto& known) { return known->sender.name == channel && !known->busy; });
}

bool NoticePost::IsFree() const {
  const std::lock_guard lock(mutex_);
  return std::ranges::none_of(channels_, [](const auto& channel) { return channel->busy; });
}

void NoticePost::Send(std::string_view channel, const Notice& notice) {
  const std::lock_guard lock(mutex_);
  for (const auto& known : channels_) {
    if (known->sender.name != channel || known->busy) continue;
    known->notice = notice;
    known->busy = true;
  }
  given_.notify_all();
}

std::vector<NoticePost::Outcome> NoticePost::Take(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  done_.wait_for(lock, patience, [this] { return !outcomes_.empty(); });
  // Free with what has come of its notice, so that nobody gives it the same one again meanwhile.
  for (const Outcome& outcome : outcomes_) {
    for (const auto& channel : channels_) {
      if (channel->sender.name == outcome.channel) channel->busy = false;
    }
  }
  return std::exchange(outcomes_, {});
}

void NoticePost::Work(Channel& channel) {
  std::unique_lock lock(mutex_);
  while (true) {
    given_.wait(lock, [&] { return stop_ || channel.notice; });
    if (stop_) return;
    const Notice notice = std::move(*channel.notice);
    channel.notice.reset();
    lock.unlock();
    std::string trouble;
    try {
      trouble = channel.sender.sender->Send(notice);
    } catch (const std::exception& error) {
      trouble = error.what();
    }
    lock.lock();
    outcomes_.push_back({channel.sender.name, notice.id, std::move(trouble)});
    done_.notify_all();
  }
}

}  // namespace strainwave::bench
