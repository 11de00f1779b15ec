// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace strainwave::bench {

/// Slows the guessing of passwords. Counted are wrong ones in a row
/// - of a name from an address: after the n-th the next try waits for 2^(n−1) s, at most a minute;
/// - of all names from an address, and of a name from all addresses: the same, after ten that cost nothing,
///   since many people may come from one address, and nobody is to lock another one out by a few tries.
/// A name from an address where it has logged in waits for its own wrong passwords alone: whoever guesses
/// elsewhere keeps nobody from the page who works at it (OWASP's cheat sheet on authentication calls that a
/// device cookie; an address is one that needs no cookie).
class LoginThrottle {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr std::chrono::seconds kLongestWait{60};
  static constexpr std::chrono::minutes kForgottenAfter{15};
  static constexpr std::chrono::hours kKnownFor{24 * 7};
  static constexpr std::size_t kMostKept = 1000;
  static constexpr int kFree = 10;

  /// Until the next try of that name from that address is looked at; zero: now.
  std::chrono::milliseconds Wait(std::string_view name, std::string_view address, Time now) const;
  void Failed(std::string_view name, std::string_view address, Time now);
  /// After a `Failed` that was counted before it was known better: that one is taken back.
  void Succeeded(std::string_view name, std::string_view address, Time now);

 private:
  struct Tries {
    int wrong{};
    Time last;
  };
  using Counts = std::map<std::string, Tries, std::less<>>;

  static std::chrono::milliseconds WaitOf(const Counts& counts, std::string_view who, int free, Time now);
  static void Count(Counts& counts, std::string who, Time now);
  static void TakeBack(Counts& counts, std::string_view who);

  Counts pairs_;
  Counts addresses_;
  Counts names_;
  std::map<std::string, Time, std::less<>> known_;  // pairs that have logged in, and when last
};

}  // namespace strainwave::bench
