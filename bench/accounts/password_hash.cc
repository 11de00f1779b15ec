// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/password_hash.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "bench/accounts/random_bytes.h"

namespace strainwave::bench {
namespace {

constexpr std::size_t kSalt_bytes = 16;
constexpr std::size_t kHash_bytes = 32;
constexpr std::uint64_t kMostMemory_bytes = 1ULL << 30;
constexpr char kBetweenParts = '$';

using Bytes = std::vector<unsigned char>;

struct StoredHash {
  ScryptCost cost;
  Bytes salt;
  Bytes hash;
};

Bytes Scrypt(std::string_view password, const Bytes& salt, const ScryptCost& cost) {
  Bytes hash(kHash_bytes);
  // A little more than 128·r·N bytes, as OpenSSL counts them.
  if (EVP_PBE_scrypt(password.data(), password.size(), salt.data(), salt.size(), 1ULL << cost.log2_n,
                     static_cast<std::uint64_t>(cost.r), static_cast<std::uint64_t>(cost.p),
                     2 * kMostMemory_bytes, hash.data(), hash.size()) != 1) {
    throw std::runtime_error("scrypt is not available in this OpenSSL, or there is no memory for it");
  }
  return hash;
}

std::optional<Bytes> BytesOf(std::string_view hex, std::size_t count) {
  if (hex.size() != 2 * count) return std::nullopt;
  Bytes bytes(count);
  for (std::size_t i = 0; i < count; ++i) {
    const char* const begin = hex.data() + 2 * i;
    const auto [end, error] = std::from_chars(begin, begin + 2, bytes[i], 16);
    if (error != std::errc() || end != begin + 2) return std::nullopt;
  }
  return bytes;
}

std::optional<int> NumberOf(std::string_view text, int least, int most) {
  int number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number >= least && number <= most ? std::optional(number) : std::nullopt;
}

std::optional<StoredHash> Parse(std::string_view stored) {
  std::array<std::string_view, 6> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t end = stored.find(kBetweenParts);
    if ((end == stored.npos) != (i + 1 == parts.size())) return std::nullopt;
    parts[i] = stored.substr(0, end);
    if (end != stored.npos) stored.remove_prefix(end + 1);
  }
  const auto log2_n = NumberOf(parts[1], 1, 24);
  const auto r = NumberOf(parts[2], 1, 64);
  const auto p = NumberOf(parts[3], 1, 64);
  const auto salt = BytesOf(parts[4], kSalt_bytes);
  const auto hash = BytesOf(parts[5], kHash_bytes);
  if (parts[0] != "scrypt" || !log2_n || !r || !p || !salt || !hash) return std::nullopt;
  if ((128ULL * static_cast<unsigned>(*r) << *log2_n) > kMostMemory_bytes) return std::nullopt;
  return StoredHash{{*log2_n, *r, *p}, *salt, *hash};
}

}  // namespace

std::string HashPassword(std::string_view password, const ScryptCost& cost) {
  const Bytes salt = RandomBytes(kSalt_bytes);
  return fmt::format("scrypt${}${}${}${}${}", cost.log2_n, cost.r, cost.p, HexOf(salt),
                     HexOf(Scrypt(password, salt, cost)));
}

bool IsPasswordOf(std::string_view password, std::string_view stored) {
  const auto known = Parse(stored);
  if (!known) return false;
  const Bytes hash = Scrypt(password, known->salt, known->cost);
  return CRYPTO_memcmp(hash.data(), known->hash.data(), kHash_bytes) == 0;
}

bool IsPasswordHash(std::string_view stored) { return Parse(stored).has_value(); }

}  // namespace strainwave::bench
