// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/narrowband.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {

InnovationFilter FilterOf(const Narrowband& narrowband, double period_s) {
  using Complex = std::complex<double>;
  const double angle = std::min(kTwoPi * narrowband.frequency_Hz * period_s, 0.999 * kPi);
  const double radius = std::exp(-narrowband.damping_ratio * angle);
  InnovationFilter filter;
  filter.a1 =
      -2.0 * radius *
      std::cos(angle * std::sqrt(std::max(0.0, 1.0 - narrowband.damping_ratio * narrowband.damping_ratio)));
  filter.a2 = radius * radius;
  const double a1 = filter.a1;
  const double a2 = filter.a2;
  // Variance of the oscillator under unit noise.
  const double gain = (1.0 + a2) / ((1.0 - a2) * ((1.0 + a2) * (1.0 + a2) - a1 * a1));
  const double drive = std::exp(narrowband.log_ratio) / gain;
  // drive + A(z) A(1/z) is a polynomial of second degree in z + 1/z; its roots inside the unit circle make C.
  const double g0 = drive + 1.0 + a1 * a1 + a2 * a2;
  const double g1 = a1 * (1.0 + a2);
  const double g2 = a2;
  const Complex root = std::sqrt(Complex(g1 * g1 - 4.0 * g2 * (g0 - 2.0 * g2)));
  Complex product = 1.0;
  Complex sum = 0.0;
  for (const Complex x : {(-g1 + root) / (2.0 * g2), (-g1 - root) / (2.0 * g2)}) {
    const Complex w = std::sqrt(x * x - 4.0);
    Complex z = 0.5 * (x + w);
    if (std::norm(z) > 1.0) z = 0.5 * (x - w);
    product *= z;
    sum += z;
  }
  filter.c1 = -sum.real();
  filter.c2 = product.real();
  filter.variance = g2 / std::max(filter.c2, 1e-300);
  return filter;
}

namespace {

// Each sample waits for the one before: columns side by side fill the waiting.
// @param filters  one a column, or one for all
template <int kWidth>
void PredictColumns(std::span<const InnovationFilter> filters, std::span<const char> breaks,
                    std::span<const char> missing, Eigen::Ref<Eigen::MatrixXd> columns,
                    Eigen::Ref<PredictionState> state, Eigen::Index first) {
  using Row = Eigen::Array<double, kWidth, 1>;
  const Row zero = Row::Zero();
  Row a1, a2, c1, c2;
  for (int c = 0; c < kWidth; ++c) {
    const InnovationFilter& own = filters[std::min(filters.size() - 1, static_cast<std::size_t>(first + c))];
    a1(c) = own.a1;
    a2(c) = own.a2;
    c1(c) = own.c1;
    c2(c) = own.c2;
  }
  const auto known = [&](Eigen::Index row) {
    return state.row(row).template segment<kWidth>(first).transpose();
  };
  Row y1 = known(0), y2 = known(1), e1 = known(2), e2 = known(3);
  for (Eigen::Index i = 0; i < columns.rows(); ++i) {
    if (breaks[static_cast<std::size_t>(i)] != 0) y1 = y2 = e1 = e2 = zero;
    // What is known last comes last.
    const Row expected = (c2 * e2 - a2 * y2 - a1 * y1) + c1 * e1;
    Row y = expected;
    if (missing.empty() || missing[static_cast<std::size_t>(i)] == 0) {
      for (int c = 0; c < kWidth; ++c) y(c) = columns(i, first + c);
    }
    y2 = y1;
    y1 = y;
    e2 = e1;
    e1 = y - expected;
    for (int c = 0; c < kWidth; ++c) columns(i, first + c) = expected(c);
  }
  for (const auto& [row, values] : {std::pair{0, &y1}, {1, &y2}, {2, &e1}, {3, &e2}})
    state.row(row).template segment<kWidth>(first) = values->matrix().transpose();
}

}  // namespace

void Predict(std::span<const InnovationFilter> filters, std::span<const char> breaks,
             std::span<const char> missing, Eigen::Ref<Eigen::MatrixXd> columns,
             Eigen::Ref<PredictionState> state) {
  Eigen::Index first = 0;
  for (; first + 4 <= columns.cols(); first += 4) {
    PredictColumns<4>(filters, breaks, missing, columns, state, first);
  }
  for (; first + 2 <= columns.cols(); first += 2) {
    PredictColumns<2>(filters, breaks, missing, columns, state, first);
  }
  for (; first < columns.cols(); ++first) {
    PredictColumns<1>(filters, breaks, missing, columns, state, first);
  }
}

void Predict(std::span<const InnovationFilter> filters, std::span<const char> breaks,
             std::span<const char> missing, Eigen::Ref<Eigen::MatrixXd> columns) {
  PredictionState state = PredictionState::Zero(4, columns.cols());
  Predict(filters, breaks, missing, columns, state);
}

}  // namespace strainwave::analysis::diagnosis
