// SPDX-License-Identifier: Apache-2.0
#include "bench/page/logins.h"

#include <sys/stat.h>

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "bench/accounts/password_hash.h"
#include "bench/accounts/random_bytes.h"
#include "bench/serving/addresses.h"

namespace strainwave::bench {
namespace {

using nlohmann::json;

constexpr std::size_t kLongestPassword_bytes = 1000;
constexpr std::size_t kSecret_bytes = 32;

// For a name that nobody has as for a password that is another: which of the two is nobody's business.
LoginAnswer NoSuchUser() { return {NotDone(401, "password", "no user of that name has that password")}; }

std::int64_t Nanoseconds(const timespec& time) { return time.tv_sec * 1'000'000'000 + time.tv_nsec; }

std::optional<FileState> StateOf(const std::filesystem::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return std::nullopt;
  return FileState{found.st_ino, found.st_size, Nanoseconds(found.st_mtim), Nanoseconds(found.st_ctim)};
}

}  // namespace

HttpHeaders HeadersOf(const LoginAnswer& answer) {
  HttpHeaders headers;
  if (!answer.cookie.empty()) headers.emplace_back("Set-Cookie", answer.cookie);
  if (answer.retry_after.count() > 0) {
    headers.emplace_back("Retry-After", std::to_string(answer.retry_after.count()));
  }
  return headers;
}

Logins::Logins(std::optional<std::filesystem::path> users_file, std::string cookie, bool is_encrypted)
    : users_file_(std::move(users_file)),
      cookie_(std::move(cookie)),
      is_encrypted_(is_encrypted),
      nobody_(users_file_ ? HashPassword(HexOf(RandomBytes(kSecret_bytes))) : "") {
  if (!users_file_) return;
  users_file_state_ = StateOf(*users_file_).value_or(FileState{});
  users_ = ReadUsersFile(*users_file_);
}

// A file that cannot be used any more has no users: nobody acts by what it was.
void Logins::ReadAgain() {
  if (!users_file_) return;
  const auto state = StateOf(*users_file_);
  if (state && *state == users_file_state_) return;
  users_file_state_ = state.value_or(FileState{});
  try {
    users_ = ReadUsersFile(*users_file_);
  } catch (const std::exception&) {
    users_.clear();
  }
  sessions_.KeepOnly(users_);
}

std::string Logins::SecretIn(std::string_view cookies) const {
  while (!cookies.empty()) {
    const std::size_t end = cookies.find(';');
    std::string_view one = cookies.substr(0, end);
    one.remove_prefix(std::min(one.find_first_not_of(' '), one.size()));
    const std::size_t equals = one.find('=');
    if (equals != one.npos && one.substr(0, equals) == cookie_) return std::string(one.substr(equals + 1));
    if (end == cookies.npos) break;
    cookies.remove_prefix(end + 1);
  }
  return {};
}

std::string Logins::CookieOf(const std::string& secret, std::chrono::seconds holds) const {
  return fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict; Max-Age={}{}", cookie_, secret, holds.count(),
                     is_encrypted_ ? "; Secure" : "");
}

Actor Logins::ActorOf(std::string_view cookies, Time now) {
  const std::lock_guard lock(mutex_);
  ReadAgain();
  Actor actor{.user = {}, .session = SecretIn(cookies), .knows_users = users_file_.has_value()};
  actor.user = sessions_.Find(actor.session, now);
  if (!actor.user) actor.session.clear();
  return actor;
}

Actor Logins::Acting(std::string_view cookies, Time now) {
  Actor actor = ActorOf(cookies, now);
  const std::lock_guard lock(mutex_);
  sessions_.Touch(actor.session, now);
  return actor;
}

bool Logins::Holds(std::string_view session, Time now) {
  const std::lock_guard lock(mutex_);
  ReadAgain();
  return sessions_.Find(session, now).has_value();
}

std::optional<LoginAnswer> Logins::LogIn(std::string_view text, std::string_view address, Time now,
                                         Answered answered) {
  if (!users_file_) {
    return LoginAnswer{
        NotDone(404, "no_users",
                "this page has no users (expected: strainwave serve DIR --users FILE; strainwave users FILE "
                "add NAME makes one)")};
  }
  const json request = json::parse(text, nullptr, false);
  const bool is_whole = request.is_object() && request.contains("name") && request["name"].is_string() &&
                        request.contains("password") && request["password"].is_string();
  if (!is_whole)
    return LoginAnswer{NotDone(400, "request", "expected {\"name\":\"...\",\"password\":\"...\"}")};
  auto name = request["name"].get<std::string>();
  auto password = request["password"].get<std::string>();
  if (!IsUserName(name) || password.size() > kLongestPassword_bytes) {
    return NoSuchUser();
  }
  const std::string network = NetworkOf(address);
  const std::lock_guard lock(mutex_);
  if (const auto wait = throttle_.Wait(name, network, now); wait.count() > 0) {
    const auto seconds = std::chrono::ceil<std::chrono::seconds>(wait);
    LoginAnswer answer{
        NotDone(429, "wait",
                fmt::format("after a wrong password the next try waits: again in {} s", seconds.count()))};
    answer.retry_after = seconds;
    return answer;
  }
  const bool taken =
      worker_.Post([this, name, network, password = std::move(password), answered = std::move(answered)] {
        LoginAnswer answer;
        try {
          answer = Verify(name, password, network);
        } catch (const std::exception& error) {
          answer = {NotDone(503, "login", fmt::format("nobody can log in now: {}", error.what()))};
        }
        answered(std::move(answer));
      });
  if (!taken)
    return LoginAnswer{NotDone(503, "busy", "too many log in at once (expected: again in a moment)")};
  // Until it is known better: no second try while this one is looked at. Its thread waits for the lock.
  throttle_.Failed(name, network, now);
  return std::nullopt;
}

LoginAnswer Logins::Verify(const std::string& name, const std::string& password, const std::string& network) {
  std::optional<User> user;
  {
    const std::lock_guard lock(mutex_);
    ReadAgain();
    const auto known = std::ranges::find(users_, name, &User::name);
    if (known != users_.end()) user = *known;
  }
  if (!IsPasswordOf(password, user ? user->password : nobody_) || !user) {
    return NoSuchUser();
  }
  const std::string secret = HexOf(RandomBytes(kSecret_bytes));
  const std::lock_guard lock(mutex_);
  const Time now = std::chrono::steady_clock::now();
  throttle_.Succeeded(name, network, now);
  sessions_.Open(secret, *user, now);
  return {{200,
           {{"user", UserJson(*user)},
            {"holds_s", sessions_.limits().in_all.count()},
            {"without_action_s", sessions_.limits().without_action.count()}}},
          CookieOf(secret, sessions_.limits().in_all)};
}

LoginAnswer Logins::LogOut(std::string_view cookies) {
  const std::lock_guard lock(mutex_);
  sessions_.Close(SecretIn(cookies));
  return {{200, {{"user", nullptr}}}, CookieOf("", std::chrono::seconds(0))};
}

}  // namespace strainwave::bench
