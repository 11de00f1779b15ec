// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "bench/accounts/login_throttle.h"
#include "bench/accounts/sessions.h"
#include "bench/accounts/users_file.h"
#include "bench/page/actions.h"
#include "bench/page/http_text.h"
#include "bench/serving/worker.h"

namespace strainwave::bench {

/// What is said to somebody who logs in or out.
struct LoginAnswer : ActionAnswer {
  std::string cookie{};                // for Set-Cookie; empty: none
  std::chrono::seconds retry_after{};  // of a 429
};

/// Set-Cookie and Retry-After, where the answer has them.
HttpHeaders HeadersOf(const LoginAnswer& answer);

/// By which a file is known to be another: the time of its writing alone repeats where a clock is set back.
struct FileState {
  std::uint64_t inode{};
  std::int64_t bytes{};
  std::int64_t written_ns{};
  std::int64_t changed_ns{};

  bool operator==(const FileState&) const = default;
};

/// Who is who on the page. The file of users is read again whenever it has changed: who is taken out of it,
/// or gets another password, is logged out by that.
class Logins {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// @param users_file  nothing: nobody can log in.
  /// @param cookie  its name: browsers keep those of one host together, whatever the port.
  /// @param is_encrypted  the cookie then goes over TLS alone.
  /// @throws UsersFileError where the file cannot be used.
  Logins(std::optional<std::filesystem::path> users_file, std::string cookie, bool is_encrypted);

  /// Who sends a request with that Cookie header.
  Actor ActorOf(std::string_view cookies, Time now);
  /// As ActorOf, and the session is used.
  Actor Acting(std::string_view cookies, Time now);
  /// Whether the session of an Actor still holds.
  bool Holds(std::string_view session, Time now);

  using Answered = std::function<void(LoginAnswer)>;
  /// {"name", "password"}. @param address  from which it comes; @param answered  is called from another
  /// thread, later, where the password is looked at at all. @return what is said at once; nothing: `answered`
  /// will be called.
  std::optional<LoginAnswer> LogIn(std::string_view request, std::string_view address, Time now,
                                   Answered answered);
  LoginAnswer LogOut(std::string_view cookies);

 private:
  std::string SecretIn(std::string_view cookies) const;
  std::string CookieOf(const std::string& secret, std::chrono::seconds holds) const;
  void ReadAgain();
  LoginAnswer Verify(const std::string& name, const std::string& password, const std::string& network);

  static constexpr std::size_t kMostWaiting = 8;

  const std::optional<std::filesystem::path> users_file_;
  const std::string cookie_;
  const bool is_encrypted_;
  const std::string nobody_;  // a hash that no password fits: a name that nobody has takes as long as any
  std::mutex mutex_;          // of all below
  std::vector<User> users_;
  FileState users_file_state_{};  // when they were read
  Sessions sessions_;
  LoginThrottle throttle_;
  Worker worker_{kMostWaiting, Worker::AtEnd::kDrop};  // its thread uses the above, and ends before
};

}  // namespace strainwave::bench
