// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace strainwave::bench {

/// The cost of scrypt (RFC 7914): N = 2^log2_n blocks of 128·r bytes, p times.
struct ScryptCost {
  int log2_n{15};  // with r = 8: 32 MiB, the memory of one login on a bench's computer
  int r{8};
  int p{3};  // OWASP's password storage cheat sheet has N = 2^15, r = 8, p = 3 beside its other equals
};

/// "scrypt$15$8$3$SALT$HASH", salt of 16 and hash of 32 bytes in hexadecimal; a new salt each time.
/// @throws std::runtime_error where OpenSSL cannot: no random numbers, no memory.
std::string HashPassword(std::string_view password, const ScryptCost& cost = {});

/// False where `stored` is no such text. Takes a tenth of a second, whatever it answers for a text that is.
bool IsPasswordOf(std::string_view password, std::string_view stored);

/// Whether it is a text as `HashPassword` makes it, at a cost that can be borne: up to 1 GiB.
bool IsPasswordHash(std::string_view stored);

}  // namespace strainwave::bench
