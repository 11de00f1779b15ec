// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bench/accounts/users_file.h"

namespace strainwave::bench {

/// How long a login holds.
struct SessionLimits {
  std::chrono::seconds without_action{std::chrono::hours(1)};  // a desk that somebody has left
  std::chrono::seconds in_all{std::chrono::hours(12)};         // a working day
  std::size_t most{200};        // at a time; one more ends the one idle longest
  std::size_t most_of_one{20};  // of one user; likewise, so that nobody logs others out by logging in
};

/// Who is logged in. Kept in memory alone: a program that is started again knows nobody.
class Sessions {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit Sessions(const SessionLimits& limits = {}) : limits_(limits) {}

  /// @param secret  that nobody can guess, by which the session is found again.
  void Open(const std::string& secret, User user, Time now);
  /// Nothing where there is no such session, or it is over.
  std::optional<User> Find(std::string_view secret, Time now) const;
  /// The person has acted.
  void Touch(std::string_view secret, Time now);
  void Close(std::string_view secret);
  /// Those of users who are not the same any more: gone, with another role or another password.
  void KeepOnly(const std::vector<User>& users);
  const SessionLimits& limits() const { return limits_; }

 private:
  struct Session {
    User user;
    Time opened;
    Time acted;
  };

  bool IsOver(const Session& session, Time now) const;
  void EndLongestIdle(const std::string* name);

  SessionLimits limits_;
  std::map<std::string, Session, std::less<>> sessions_;
};

}  // namespace strainwave::bench
