// SPDX-License-Identifier: Apache-2.0
#include "bench/page/tokens.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include <array>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "bench/accounts/random_bytes.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kKey_bytes = 32;
constexpr std::size_t kSeal_bytes = 16;
constexpr char kBetween = '.';

}  // namespace

std::string RandomKey() {
  const auto bytes = RandomBytes(kKey_bytes);
  return {bytes.begin(), bytes.end()};
}

Tokens::Tokens(std::string key, std::size_t most_used) : key_(std::move(key)), most_used_(most_used) {}

std::string Tokens::Seal(std::string_view number, std::string_view run) const {
  const std::string text = fmt::format("{} {}", number, run);
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  if (HMAC(EVP_sha256(), key_.data(), static_cast<int>(key_.size()),
           reinterpret_cast<const unsigned char*>(text.data()), text.size(), digest.data(),
           &size) == nullptr) {
    throw std::runtime_error("HMAC with SHA-256 is not available in this OpenSSL");
  }
  return HexOf(std::span(digest).first(kSeal_bytes));
}

std::string Tokens::Issue(std::string_view run) {
  const std::string number = std::to_string(++last_);
  return number + kBetween + Seal(number, run);
}

Tokens::Use Tokens::Look(std::string_view token, std::string_view run) const {
  const std::size_t between = token.find(kBetween);
  if (between == std::string_view::npos) return {};
  const std::string seal = Seal(token.substr(0, between), run);
  const std::string_view given = token.substr(between + 1);
  if (given.size() != seal.size() || CRYPTO_memcmp(given.data(), seal.data(), seal.size()) != 0) return {};
  const auto used = used_.find(token);
  if (used != used_.end()) return {Answer::kUsed, used->second};
  return {Answer::kGood, {}};
}

void Tokens::Spend(std::string_view token, std::string done) {
  if (used_.size() >= most_used_) {
    used_.clear();
    key_ = RandomKey();
    return;
  }
  used_.emplace(token, std::move(done));
}

}  // namespace strainwave::bench
