// SPDX-License-Identifier: Apache-2.0
// nlohmann-json by itself makes a number of an enum, and nobody sees it until a document is read.
#include <type_traits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "analysis/torsional_stiffness.h"

namespace strainwave::bench::enum_json_test {
namespace {

TEST(Json, IsNotMadeOfAnEnum) {
  using analysis::StiffnessMethod;
  EXPECT_FALSE((std::is_constructible_v<nlohmann::json, StiffnessMethod>));
  EXPECT_FALSE((std::is_constructible_v<nlohmann::ordered_json, StiffnessMethod>));
  EXPECT_TRUE((std::is_constructible_v<nlohmann::json, std::underlying_type_t<StiffnessMethod>>));
}

}  // namespace
}  // namespace strainwave::bench::enum_json_test
