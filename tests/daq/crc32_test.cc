// SPDX-License-Identifier: Apache-2.0
#include "daq/crc32.h"

#include <gtest/gtest.h>

#include <string>

namespace strainwave::daq::crc32_test {
namespace {

TEST(Crc32, GivesTheCheckValueOfTheStandard) {
  const std::string digits = "123456789";
  EXPECT_EQ(Crc32(std::as_bytes(std::span(digits))), 0xCBF43926U);
  EXPECT_EQ(Crc32({}), 0U);
}

TEST(Crc32, GoesOnFromWhereItStopped) {
  const std::string digits = "123456789";
  const auto bytes = std::as_bytes(std::span(digits));
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    EXPECT_EQ(Crc32(bytes.subspan(cut), Crc32(bytes.first(cut))), 0xCBF43926U) << cut;
  }
}

}  // namespace
}  // namespace strainwave::daq::crc32_test
