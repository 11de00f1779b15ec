// SPDX-License-Identifier: Apache-2.0
#include "bench/campaign/signed_words.h"

#include <cstddef>

#include <fmt/core.h>

#include "bench/errors/bench_error.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kLongestName_bytes = 100;
constexpr std::size_t kLongestText_bytes = 2000;

}  // namespace

std::string SignerOf(const std::string& by) {
  const std::size_t begin = by.find_first_not_of(" \t\r\n");
  if (begin == by.npos) {
    throw BenchError(ExitCode::kWrongInput,
                     "--by: error: there is no name (expected whose act it is, as in --by \"A. Meier\")");
  }
  std::string name = by.substr(begin, by.find_last_not_of(" \t\r\n") - begin + 1);
  if (name.size() > kLongestName_bytes) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("--by: error: the name has {} bytes (expected at most {})", name.size(),
                                 kLongestName_bytes));
  }
  return name;
}

std::string WordsOf(const std::string& option, const std::string& text, bool may_be_empty) {
  if (!may_be_empty && text.find_first_not_of(" \t\r\n") == text.npos) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: there are no words (expected what is to be kept)", option));
  }
  if (text.size() > kLongestText_bytes) {
    throw BenchError(ExitCode::kWrongInput,
                     fmt::format("{}: error: the text has {} bytes (expected at most {})", option,
                                 text.size(), kLongestText_bytes));
  }
  return text;
}

}  // namespace strainwave::bench
