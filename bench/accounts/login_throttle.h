// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace strainwave::bench {

/// Slows the guessing of passwords: after the n-th wrong one in a row the next try of that name waits for
/// 2^(n−1) s, at most a minute. By name, since all who look on may come from one address; whoever is made to
/// wait by somebody else's guesses can still stop the bench, which needs no login.
class LoginThrottle {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds kLongestWait{60};
  static constexpr std::chrono::minutes kForgottenAfter{15};
  static constexpr std::size_t kMostNames = 1000;

  /// Until the next try of that name is looked at; zero: now.
  std::chrono::milliseconds Wait(std::string_view name, Time now) const;
  void Failed(std::string_view name, Time now);
  void Succeeded(std::string_view name);

 private:
  struct Tries {
    int wrong{};
    Time last;
  };

  std::map<std::string, Tries, std::less<>> tries_;
};

}  // namespace strainwave::bench
