// SPDX-License-Identifier: Apache-2.0
#include "analysis/networks/vector_functions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace strainwave::analysis::networks::network_vector_functions_test {
namespace {

template <typename Scalar>
class VectorFunctions : public testing::Test {
 protected:
  using Limits = std::numeric_limits<Scalar>;

  // As far out as a network's sums are.
  static std::vector<Scalar> Places(std::size_t count) {
    std::vector<Scalar> z;
    for (std::size_t i = 0; i < count; ++i) {
      const double turn = 2.4 * static_cast<double>(i) + 0.1;
      z.push_back(static_cast<Scalar>(std::sin(turn) * std::exp2(static_cast<double>(i % 10) - 4.0)));
    }
    return z;
  }

  // One number before and one behind, which nothing may touch.
  template <typename Function, typename Truth>
  static void ExpectWithin(double ulps, Function function, Truth truth) {
    for (std::size_t count = 0; count < 70; ++count) {
      std::vector<Scalar> z = Places(count + 2);
      const std::vector<Scalar> before = z;
      function(z.data() + 1, static_cast<std::ptrdiff_t>(count));
      EXPECT_EQ(z.front(), before.front());
      EXPECT_EQ(z.back(), before.back());
      for (std::size_t i = 1; i <= count; ++i) {
        const long double expected = truth(static_cast<long double>(before[i]));
        ASSERT_LE(std::abs(z[i] / expected - 1.0L), ulps * Limits::epsilon()) << before[i] << " of " << count;
      }
    }
  }
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(VectorFunctions, Scalars);

TYPED_TEST(VectorFunctions, SigmoidIsTheSameAtEveryCountAndPlace) {
  this->ExpectWithin(
      5.0, [](TypeParam* z, std::ptrdiff_t count) { Sigmoid(z, count); },
      [](long double z) { return 1.0L / (1.0L + std::exp(-z)); });
}

TYPED_TEST(VectorFunctions, TanhIsTheSameAtEveryCountAndPlace) {
  this->ExpectWithin(
      5.0, [](TypeParam* z, std::ptrdiff_t count) { Tanh(z, count); },
      [](long double z) { return std::tanh(z); });
}

TYPED_TEST(VectorFunctions, WhatIsNoNumberStaysNoneAndTheEndsAreReached) {
  constexpr TypeParam kNone = std::numeric_limits<TypeParam>::quiet_NaN();
  constexpr TypeParam kInfinite = std::numeric_limits<TypeParam>::infinity();
  constexpr std::size_t kCount = 40;
  for (std::size_t place = 0; place < kCount; ++place) {
    std::vector<TypeParam> one(kCount, kInfinite);
    one[place] = kNone;
    one[(place + 1) % one.size()] = -kInfinite;
    std::vector<TypeParam> other = one;
    Sigmoid(one.data(), std::ssize(one));
    Tanh(other.data(), std::ssize(other));
    for (std::size_t i = 0; i < one.size(); ++i) {
      if (i == place) {
        EXPECT_TRUE(std::isnan(one[i]) && std::isnan(other[i])) << i;
      } else if (i == (place + 1) % one.size()) {
        EXPECT_EQ(one[i], 0);
        EXPECT_EQ(other[i], -1);
      } else {
        EXPECT_EQ(one[i], 1);
        EXPECT_EQ(other[i], 1);
      }
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::networks::network_vector_functions_test
