// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/sessions.h"

#include <algorithm>
#include <utility>

namespace strainwave::bench {

bool Sessions::IsOver(const Session& session, Time now) const {
  return now - session.opened >= limits_.in_all || now - session.acted >= limits_.without_action;
}

// @param name  of whom; null: of all.
void Sessions::EndLongestIdle(const std::string* name) {
  auto longest = sessions_.end();
  for (auto session = sessions_.begin(); session != sessions_.end(); ++session) {
    if (name != nullptr && session->second.user.name != *name) continue;
    if (longest == sessions_.end() || session->second.acted < longest->second.acted) longest = session;
  }
  if (longest != sessions_.end()) sessions_.erase(longest);
}

void Sessions::Open(const std::string& secret, User user, Time now) {
  std::erase_if(sessions_, [&](const auto& entry) { return IsOver(entry.second, now); });
  const auto of_user = std::ranges::count_if(
      sessions_, [&](const auto& entry) { return entry.second.user.name == user.name; });
  if (static_cast<std::size_t>(of_user) >= limits_.most_of_one) EndLongestIdle(&user.name);
  if (sessions_.size() >= limits_.most) EndLongestIdle(nullptr);
  sessions_.insert_or_assign(secret, Session{std::move(user), now, now});
}

std::optional<User> Sessions::Find(std::string_view secret, Time now) const {
  const auto found = sessions_.find(secret);
  if (found == sessions_.end() || IsOver(found->second, now)) return std::nullopt;
  return found->second.user;
}

void Sessions::Touch(std::string_view secret, Time now) {
  const auto found = sessions_.find(secret);
  if (found != sessions_.end() && !IsOver(found->second, now)) found->second.acted = now;
}

void Sessions::Close(std::string_view secret) {
  const auto found = sessions_.find(secret);
  if (found != sessions_.end()) sessions_.erase(found);
}

void Sessions::KeepOnly(const std::vector<User>& users) {
  std::erase_if(sessions_, [&](const auto& entry) {
    const User& user = entry.second.user;
    return std::ranges::none_of(users, [&](const User& known) {
      return known.name == user.name && known.role == user.role && known.password == user.password;
    });
  });
}

}  // namespace strainwave::bench
