// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>

namespace strainwave::bench {

/// Tokens that are good for one action on one run. A token is a number and a seal of it with the run; the
/// server keeps those that were used and no others, so that handing them out costs nothing and nobody can
/// exhaust them. Tokens of a program that has ended are not known to the next.
class Tokens {
 public:
  /// @param key  for the seals, secret and never used before; @param most_used  that are kept.
  explicit Tokens(std::string key, std::size_t most_used = 4096);

  /// A new one, for an action on that run.
  std::string Issue(std::string_view run);

  enum class Answer { kGood, kUsed, kUnknown };
  struct Use {
    Answer answer{Answer::kUnknown};
    std::string done{};  // of a used one: what was done with it, and when
  };
  /// What the token is worth for an action on that run; nothing changes.
  Use Look(std::string_view token, std::string_view run) const;
  /// Uses up a good one. Where more were used than are kept, all that were handed out are unknown from then
  /// on: none is good twice.
  void Spend(std::string_view token, std::string done);

 private:
  std::string Seal(std::string_view number, std::string_view run) const;

  std::string key_;
  std::size_t most_used_;
  unsigned long last_{};
  std::map<std::string, std::string, std::less<>> used_;
};

/// 32 random bytes for a key. @throws std::runtime_error where the system has none.
std::string RandomKey();

}  // namespace strainwave::bench
