// SPDX-License-Identifier: Apache-2.0
#include "bench/accounts/password_hash.h"

#include <gtest/gtest.h>

namespace strainwave::bench::password_hash_test {
namespace {

constexpr ScryptCost kCheap{.log2_n = 4, .r = 1, .p = 1};

// Made by Python 3.11: hashlib.scrypt(b"correct horse", salt=bytes(range(16)), n=16, r=8, p=1, dklen=32).
constexpr const char* kOfPython =
    "scrypt$4$8$1$000102030405060708090a0b0c0d0e0f$"
    "43b11c1f5ef93ff91c53b244d87454faa4d1aeafc14ba51b09160f741682e72f";

TEST(PasswordHash, FitsItsPasswordAlone) {
  const std::string hash = HashPassword("correct horse", kCheap);
  EXPECT_TRUE(IsPasswordHash(hash)) << hash;
  EXPECT_TRUE(IsPasswordOf("correct horse", hash));
  EXPECT_FALSE(IsPasswordOf("correct horsf", hash));
  EXPECT_FALSE(IsPasswordOf("", hash));
}

TEST(PasswordHash, IsThatOfAnotherImplementation) {
  EXPECT_TRUE(IsPasswordOf("correct horse", kOfPython));
  EXPECT_FALSE(IsPasswordOf("Correct horse", kOfPython));
}

TEST(PasswordHash, HasASaltOfItsOwnAndTheCostThatIsStated) {
  EXPECT_NE(HashPassword("same", kCheap), HashPassword("same", kCheap));
  EXPECT_TRUE(HashPassword("same").starts_with("scrypt$15$8$3$"));
}

TEST(PasswordHash, IsNoOtherText) {
  const std::string good = kOfPython;
  for (const std::string& bad :
       {std::string(), std::string("secret"), "bcrypt" + good.substr(6), good + "0", good + "$",
        good.substr(0, good.size() - 1) + "g", std::string("scrypt$40") + good.substr(8),
        std::string("scrypt$24$64") + good.substr(10), std::string("scrypt$-4") + good.substr(8)}) {
    EXPECT_FALSE(IsPasswordHash(bad)) << bad;
    EXPECT_FALSE(IsPasswordOf("correct horse", bad)) << bad;
  }
}

}  // namespace
}  // namespace strainwave::bench::password_hash_test
