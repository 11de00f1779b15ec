// SPDX-License-Identifier: Apache-2.0
#include "analysis/products.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/analysis/each_machine.h"

namespace strainwave::analysis::products_test {
namespace {

using Index = std::ptrdiff_t;

template <typename Scalar>
class Products : public testing::Test {
 protected:
  // Small whole numbers: every sum of them is exact in either type, in whatever order.
  std::vector<Scalar> Whole(Index count) {
    std::uniform_int_distribution<int> draw(-9, 9);
    std::vector<Scalar> values(static_cast<std::size_t>(count));
    for (Scalar& value : values) value = static_cast<Scalar>(draw(random_));
    return values;
  }

  std::mt19937 random_{1};
};

using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(Products, Scalars);

constexpr Index kSizes[][3] = {{1, 1, 1},    {1, 500, 100}, {4, 16, 48},  {5, 3, 47}, {7, 13, 5},
                               {12, 49, 97}, {3, 100, 31},  {50, 51, 17}, {2, 0, 20}, {9, 8, 64}};

TYPED_TEST(Products, CombineRowsIsItsSumAtEverySize) {
  testing_machines::OnEachMachine([this](const char* machine) {
    for (const auto& [rows, terms, width] : kSizes) {
      // Gaps between the rows, which nothing may touch, and a read by columns.
      const Index a_stride = rows + 2;
      const Index b_stride = width + 3;
      const Index c_stride = width + 1;
      const auto a = this->Whole(a_stride * terms);
      const auto b = this->Whole(b_stride * terms);
      for (const Sum sum : {Sum::kOverwrite, Sum::kAdd}) {
        const auto before = this->Whole(c_stride * rows);
        auto c = before;
        CombineRows<TypeParam>({a.data(), 1, a_stride}, {b.data(), b_stride}, {c.data(), c_stride}, rows,
                               terms, width, sum);
        for (Index r = 0; r < rows; ++r) {
          for (Index j = 0; j < c_stride; ++j) {
            const auto place = static_cast<std::size_t>(r * c_stride + j);
            TypeParam expected = sum == Sum::kAdd || j >= width ? before[place] : TypeParam(0);
            for (Index s = 0; s < terms && j < width; ++s) {
              expected += a[static_cast<std::size_t>(r + s * a_stride)] *
                          b[static_cast<std::size_t>(s * b_stride + j)];
            }
            ASSERT_EQ(c[place], expected)
                << machine << " " << rows << " " << terms << " " << width << " at " << r << " " << j;
          }
        }
      }
    }
  });
}

TYPED_TEST(Products, MultiplyRowsIsItsSumAtEverySize) {
  testing_machines::OnEachMachine([this](const char* machine) {
    for (const auto& [rows, columns, terms] : kSizes) {
      const Index stride = terms + 3;
      const auto a = this->Whole(stride * rows);
      const auto b = this->Whole(stride * columns);
      for (const Sum sum : {Sum::kOverwrite, Sum::kAdd}) {
        const auto before = this->Whole(rows * columns);
        auto c = before;
        MultiplyRows<TypeParam>({a.data(), stride}, {b.data(), stride}, {c.data(), 1, rows}, rows, columns,
                                terms, sum);
        for (Index r = 0; r < rows; ++r) {
          for (Index s = 0; s < columns; ++s) {
            const auto place = static_cast<std::size_t>(r + s * rows);
            TypeParam expected = sum == Sum::kAdd ? before[place] : TypeParam(0);
            for (Index i = 0; i < terms; ++i) {
              expected +=
                  a[static_cast<std::size_t>(r * stride + i)] * b[static_cast<std::size_t>(s * stride + i)];
            }
            ASSERT_EQ(c[place], expected)
                << machine << " " << rows << " " << columns << " " << terms << " at " << r << " " << s;
          }
        }
      }
    }
  });
}

}  // namespace
}  // namespace strainwave::analysis::products_test
