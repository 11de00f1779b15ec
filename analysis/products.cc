// SPDX-License-Identifier: Apache-2.0
#include "analysis/products.h"

// This file again for each kind of machine (docs/decisions/0018-vectors.md). Vectors are the compiler's here,
// which have a width to choose within one machine; products and sums are contracted where it can.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/products.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strainwave::analysis::HWY_NAMESPACE {

using Index = std::ptrdiff_t;

// Unaligned vectors of `Bytes`; local to the bodies below, never an argument.
template <typename Scalar, int Bytes>
struct VectorOf {
  using Type __attribute__((vector_size(Bytes), aligned(sizeof(Scalar)), may_alias)) = Scalar;
  static constexpr Index kLanes = Bytes / static_cast<int>(sizeof(Scalar));
};

// The sums of a block stay in registers: fewer than eight would wait for one another, and the machines whose
// vectors are shorter than 64 bytes have sixteen in all.
template <int Bytes>
constexpr Index kMostVectors = Bytes >= 64 ? 4 : 3;
constexpr Index kRows = 4;
constexpr Index kManyRows = 12;  // where a block is one or two vectors wide
// For what is left of a row: four floats, two doubles.
constexpr int kFewBytes = 16;

template <typename Scalar, int Bytes, Index Height, Index Width>
HWY_INLINE void CombineBlock(GridView<const Scalar> a, RowView<const Scalar> b, RowView<Scalar> c,
                             Index terms, Sum sum) {
  using Vector = typename VectorOf<Scalar, Bytes>::Type;
  constexpr Index kLanes = VectorOf<Scalar, Bytes>::kLanes;
  Vector sums[Height][Width]{};
  for (Index s = 0; s < terms; ++s) {
    // All of a row of b, then one number of a after the other: sums and these fill sixteen registers.
    const Scalar* row = b.data + s * b.stride;
    Vector values[Width];
    for (Index v = 0; v < Width; ++v) values[v] = *reinterpret_cast<const Vector*>(row + v * kLanes);
    for (Index r = 0; r < Height; ++r) {
      const Scalar factor = a.data[r * a.row_stride + s * a.column_stride];
      for (Index v = 0; v < Width; ++v) sums[r][v] += factor * values[v];
    }
  }
  for (Index r = 0; r < Height; ++r) {
    for (Index v = 0; v < Width; ++v) {
      auto* out = reinterpret_cast<Vector*>(c.data + r * c.stride + v * kLanes);
      *out = sum == Sum::kAdd ? *out + sums[r][v] : sums[r][v];
    }
  }
}

template <typename Scalar, int Bytes, Index Width>
HWY_INLINE void CombineColumns(GridView<const Scalar> a, RowView<const Scalar> b, RowView<Scalar> c,
                               Index rows, Index terms, Sum sum) {
  Index r = 0;
  if constexpr (Width <= 2) {
    constexpr Index kHeight = kManyRows / Width;
    for (; r + kHeight <= rows; r += kHeight) {
      CombineBlock<Scalar, Bytes, kHeight, Width>({a.data + r * a.row_stride, a.row_stride, a.column_stride},
                                                  b, {c.data + r * c.stride, c.stride}, terms, sum);
    }
  }
  for (; r + kRows <= rows; r += kRows) {
    CombineBlock<Scalar, Bytes, kRows, Width>({a.data + r * a.row_stride, a.row_stride, a.column_stride}, b,
                                              {c.data + r * c.stride, c.stride}, terms, sum);
  }
  for (; r < rows; ++r) {
    CombineBlock<Scalar, Bytes, 1, Width>({a.data + r * a.row_stride, a.row_stride, a.column_stride}, b,
                                          {c.data + r * c.stride, c.stride}, terms, sum);
  }
}

template <typename Scalar, int Bytes>
HWY_INLINE void CombineTerms(GridView<const Scalar> a, RowView<const Scalar> b, RowView<Scalar> c, Index rows,
                             Index terms, Index width, Sum sum) {
  constexpr Index kLanes = VectorOf<Scalar, Bytes>::kLanes;
  constexpr Index kVectors = kMostVectors<Bytes>;
  Index j = 0;
  for (; j + kVectors * kLanes <= width; j += kVectors * kLanes) {
    CombineColumns<Scalar, Bytes, kVectors>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms,
                                            sum);
  }
  const Index vectors = (width - j) / kLanes;
  if (vectors == 3) {
    CombineColumns<Scalar, Bytes, 3>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms, sum);
  } else if (vectors == 2) {
    CombineColumns<Scalar, Bytes, 2>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms, sum);
  } else if (vectors == 1) {
    CombineColumns<Scalar, Bytes, 1>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms, sum);
  }
  j += vectors * kLanes;
  if (j < width && width >= kLanes && sum == Sum::kOverwrite) {
    // The last vector again, further right: what it has in common with the one before gets the same bits.
    j = width - kLanes;
    CombineColumns<Scalar, Bytes, 1>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms, sum);
    return;
  }
  constexpr Index kFew = VectorOf<Scalar, kFewBytes>::kLanes;
  for (; j + kFew <= width; j += kFew) {
    CombineColumns<Scalar, kFewBytes, 1>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms, sum);
  }
  for (; j < width; ++j) {
    CombineColumns<Scalar, sizeof(Scalar), 1>(a, {b.data + j, b.stride}, {c.data + j, c.stride}, rows, terms,
                                              sum);
  }
}

template <typename Scalar, int Bytes>
HWY_INLINE void Combine(GridView<const Scalar> a, RowView<const Scalar> b, RowView<Scalar> c, Index rows,
                        Index terms, Index width, Sum sum) {
  // What all rows of c read of b, so many terms of the widest block, stays in a first cache of 32 KiB.
  constexpr Index kTogether = 24 * 1024 / (kMostVectors<Bytes> * Bytes);
  Index s = 0;
  do {
    CombineTerms<Scalar, Bytes>({a.data + s * a.column_stride, a.row_stride, a.column_stride},
                                {b.data + s * b.stride, b.stride}, c, rows, HWY_MIN(kTogether, terms - s),
                                width, s == 0 ? sum : Sum::kAdd);
    s += kTogether;
  } while (s < terms);
}

// The sum of all lanes, by halves.
template <typename Scalar, int Bytes>
HWY_INLINE Scalar Total(const Scalar* lanes) {
  if constexpr (Bytes == sizeof(Scalar)) {
    return *lanes;
  } else {
    using Half = typename VectorOf<Scalar, Bytes / 2>::Type;
    const Half sum = *reinterpret_cast<const Half*>(lanes) +
                     *reinterpret_cast<const Half*>(lanes + VectorOf<Scalar, Bytes / 2>::kLanes);
    return Total<Scalar, Bytes / 2>(reinterpret_cast<const Scalar*>(&sum));
  }
}

// Adds products from `i` on as far as whole vectors go.
template <typename Scalar, int Bytes, Index Height, Index Width>
HWY_INLINE void AddProducts(RowView<const Scalar> a, RowView<const Scalar> b, Index terms, Index& i,
                            Scalar (&totals)[Height][Width]) {
  using Vector = typename VectorOf<Scalar, Bytes>::Type;
  constexpr Index kLanes = VectorOf<Scalar, Bytes>::kLanes;
  Vector sums[Height][Width]{};
  for (; i + kLanes <= terms; i += kLanes) {
    for (Index r = 0; r < Height; ++r) {
      const Vector values = *reinterpret_cast<const Vector*>(a.data + r * a.stride + i);
      // One row of b: nothing of a is read twice, and the machine's own guess ends with every short row. A
      // vector is a line of the cache, or the asking costs more than the waiting.
      if constexpr (Width == 1 && Bytes == 64) __builtin_prefetch(a.data + (r + Height) * a.stride + i);
      for (Index s = 0; s < Width; ++s) {
        sums[r][s] += values * *reinterpret_cast<const Vector*>(b.data + s * b.stride + i);
      }
    }
  }
  for (Index r = 0; r < Height; ++r) {
    for (Index s = 0; s < Width; ++s) {
      totals[r][s] += Total<Scalar, Bytes>(reinterpret_cast<const Scalar*>(&sums[r][s]));
    }
  }
}

template <typename Scalar, int Bytes, Index Height, Index Width>
HWY_INLINE void MultiplyBlock(RowView<const Scalar> a, RowView<const Scalar> b, GridView<Scalar> c,
                              Index terms, Sum sum) {
  Scalar totals[Height][Width]{};
  Index i = 0;
  AddProducts<Scalar, Bytes>(a, b, terms, i, totals);
  if (i + VectorOf<Scalar, kFewBytes>::kLanes <= terms)
    AddProducts<Scalar, kFewBytes>(a, b, terms, i, totals);
  for (; i < terms; ++i) {
    for (Index r = 0; r < Height; ++r) {
      for (Index s = 0; s < Width; ++s) totals[r][s] += a.data[r * a.stride + i] * b.data[s * b.stride + i];
    }
  }
  for (Index r = 0; r < Height; ++r) {
    for (Index s = 0; s < Width; ++s) {
      Scalar& out = c.data[r * c.row_stride + s * c.column_stride];
      out = sum == Sum::kAdd ? out + totals[r][s] : totals[r][s];
    }
  }
}

// A few rows of a with some rows of b.
template <typename Scalar, int Bytes, Index Height>
HWY_INLINE void MultiplyStrip(RowView<const Scalar> a, RowView<const Scalar> b, GridView<Scalar> c,
                              Index columns, Index terms, Sum sum) {
  constexpr Index kColumns = 4;
  Index s = 0;
  for (; s + kColumns <= columns; s += kColumns) {
    MultiplyBlock<Scalar, Bytes, Height, kColumns>(
        a, {b.data + s * b.stride, b.stride}, {c.data + s * c.column_stride, c.row_stride, c.column_stride},
        terms, sum);
  }
  for (; s < columns; ++s) {
    MultiplyBlock<Scalar, Bytes, Height, 1>(a, {b.data + s * b.stride, b.stride},
                                            {c.data + s * c.column_stride, c.row_stride, c.column_stride},
                                            terms, sum);
  }
}

// One row of b: each value of a is read once, and what counts is how many of these reads are under way.
template <typename Scalar, int Bytes>
HWY_INLINE void MultiplyOne(RowView<const Scalar> a, RowView<const Scalar> b, GridView<Scalar> c, Index rows,
                            Index terms, Sum sum) {
  constexpr Index kHeight = 8;
  const auto from = [&](Index r) { return RowView<const Scalar>{a.data + r * a.stride, a.stride}; };
  const auto to = [&](Index r) {
    return GridView<Scalar>{c.data + r * c.row_stride, c.row_stride, c.column_stride};
  };
  Index r = 0;
  for (; r + kHeight <= rows; r += kHeight)
    MultiplyBlock<Scalar, Bytes, kHeight, 1>(from(r), b, to(r), terms, sum);
  for (; r < rows; ++r) MultiplyBlock<Scalar, Bytes, 1, 1>(from(r), b, to(r), terms, sum);
}

template <typename Scalar, int Bytes>
HWY_INLINE void Multiply(RowView<const Scalar> a, RowView<const Scalar> b, GridView<Scalar> c, Index rows,
                         Index columns, Index terms, Sum sum) {
  if (columns == 1) {
    MultiplyOne<Scalar, Bytes>(a, b, c, rows, terms, sum);
    return;
  }
  constexpr Index kHeight = 3;
  // So many rows of b stay in the second cache while all of a passes.
  constexpr Index kPanel = 48;
  for (Index first = 0; first < columns; first += kPanel) {
    const Index here = HWY_MIN(kPanel, columns - first);
    const RowView<const Scalar> panel{b.data + first * b.stride, b.stride};
    Scalar* const out = c.data + first * c.column_stride;
    Index r = 0;
    for (; r + kHeight <= rows; r += kHeight) {
      MultiplyStrip<Scalar, Bytes, kHeight>({a.data + r * a.stride, a.stride}, panel,
                                            {out + r * c.row_stride, c.row_stride, c.column_stride}, here,
                                            terms, sum);
    }
    for (; r < rows; ++r) {
      MultiplyStrip<Scalar, Bytes, 1>({a.data + r * a.stride, a.stride}, panel,
                                      {out + r * c.row_stride, c.row_stride, c.column_stride}, here, terms,
                                      sum);
    }
  }
}

constexpr int kBytes =
    HWY_MAX(kFewBytes, hwy::HWY_NAMESPACE::MaxLanes(hwy::HWY_NAMESPACE::ScalableTag<std::uint8_t>()));

HWY_ATTR void CombineFloats(GridView<const float> a, RowView<const float> b, RowView<float> c, Index rows,
                            Index terms, Index width, Sum sum) {
  Combine<float, kBytes>(a, b, c, rows, terms, width, sum);
}

HWY_ATTR void CombineDoubles(GridView<const double> a, RowView<const double> b, RowView<double> c, Index rows,
                             Index terms, Index width, Sum sum) {
  Combine<double, kBytes>(a, b, c, rows, terms, width, sum);
}

HWY_ATTR void MultiplyFloats(RowView<const float> a, RowView<const float> b, GridView<float> c, Index rows,
                             Index columns, Index terms, Sum sum) {
  Multiply<float, kBytes>(a, b, c, rows, columns, terms, sum);
}

HWY_ATTR void MultiplyDoubles(RowView<const double> a, RowView<const double> b, GridView<double> c,
                              Index rows, Index columns, Index terms, Sum sum) {
  Multiply<double, kBytes>(a, b, c, rows, columns, terms, sum);
}

}  // namespace strainwave::analysis::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strainwave::analysis {

HWY_EXPORT(CombineFloats);
HWY_EXPORT(CombineDoubles);
HWY_EXPORT(MultiplyFloats);
HWY_EXPORT(MultiplyDoubles);

template <>
void CombineRows(GridView<const float> a, RowView<const float> b, RowView<float> c, std::ptrdiff_t rows,
                 std::ptrdiff_t terms, std::ptrdiff_t width, Sum sum) {
  HWY_DYNAMIC_DISPATCH(CombineFloats)(a, b, c, rows, terms, width, sum);
}

template <>
void CombineRows(GridView<const double> a, RowView<const double> b, RowView<double> c, std::ptrdiff_t rows,
                 std::ptrdiff_t terms, std::ptrdiff_t width, Sum sum) {
  HWY_DYNAMIC_DISPATCH(CombineDoubles)(a, b, c, rows, terms, width, sum);
}

template <>
void MultiplyRows(RowView<const float> a, RowView<const float> b, GridView<float> c, std::ptrdiff_t rows,
                  std::ptrdiff_t columns, std::ptrdiff_t terms, Sum sum) {
  HWY_DYNAMIC_DISPATCH(MultiplyFloats)(a, b, c, rows, columns, terms, sum);
}

template <>
void MultiplyRows(RowView<const double> a, RowView<const double> b, GridView<double> c, std::ptrdiff_t rows,
                  std::ptrdiff_t columns, std::ptrdiff_t terms, Sum sum) {
  HWY_DYNAMIC_DISPATCH(MultiplyDoubles)(a, b, c, rows, columns, terms, sum);
}

}  // namespace strainwave::analysis
#endif
