// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include "analysis/statistics/gaussian_process.h"
#include "analysis/units.h"
#include "analysis/vector_clones.h"

// The library's header says this itself only under -ffast-math, which would also forget what NaN is.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
extern "C" {
__attribute__((simd("notinbranch"))) double exp(double) noexcept;
}
#endif

namespace strainwave::analysis::statistics {
namespace {

using Index = std::ptrdiff_t;

STRAINWAVE_VECTOR_CLONES
void Exponentials(double* z, Index count) {
  for (Index i = 0; i < count; ++i) z[i] = ::exp(z[i]);
}

// A = UᵀU in the upper half of n rows of n; false where A is not positive definite.
STRAINWAVE_VECTOR_CLONES
bool FactorUpper(double* u, Index n) {
  for (Index k = 0; k < n; ++k) {
    double* row = u + k * n;
    if (!(row[k] > 0.0)) return false;
    const double scale = 1.0 / std::sqrt(row[k]);
    for (Index j = k; j < n; ++j) row[j] *= scale;
    for (Index i = k + 1; i < n; ++i) {
      double* other = u + i * n;
      const double share = row[i];
      for (Index j = i; j < n; ++j) other[j] -= share * row[j];
    }
  }
  return true;
}

// V = U⁻ᵀ, lower: Uᵀ V = 1, row after row.
STRAINWAVE_VECTOR_CLONES
void InvertTransposed(const double* u, double* v, Index n) {
  for (Index k = 0; k < n; ++k) {
    double* row = v + k * n;
    for (Index j = 0; j < k; ++j) row[j] = 0.0;
    for (Index i = 0; i < k; ++i) {
      const double share = u[i * n + k];
      const double* done = v + i * n;
      for (Index j = 0; j <= i; ++j) row[j] -= share * done[j];
    }
    const double scale = 1.0 / u[k * n + k];
    for (Index j = 0; j < k; ++j) row[j] *= scale;
    row[k] = scale;
  }
}

// The lower half of VᵀV.
STRAINWAVE_VECTOR_CLONES
void SquareOfLower(const double* v, double* inverse, Index n) {
  for (Index i = 0; i < n; ++i) {
    double* out = inverse + i * n;
    for (Index j = 0; j <= i; ++j) out[j] = 0.0;
    for (Index k = i; k < n; ++k) {
      const double* row = v + k * n;
      const double share = row[i];
      for (Index j = 0; j <= i; ++j) out[j] += share * row[j];
    }
  }
}

}  // namespace

ProfileLikelihood::ProfileLikelihood(const ReplicatedData& data, MeanOf mean, bool one_length)
    : data_(data),
      mean_(mean),
      lengths_(one_length ? 1 : data.points.cols()),
      groups_(data.means.size()),
      log_counts_(data.counts.array().log().sum()) {
  const Eigen::Index pairs = groups_ * (groups_ - 1) / 2;
  squares_ = Eigen::MatrixXd::Zero(pairs, lengths_);
  Eigen::Index pair = 0;
  for (Eigen::Index i = 0; i < groups_; ++i) {
    for (Eigen::Index j = 0; j < i; ++j, ++pair) {
      const Eigen::VectorXd square = (data.points.row(i) - data.points.row(j)).array().square();
      if (one_length) {
        squares_(pair, 0) = square.sum();
      } else {
        squares_.row(pair) = square;
      }
    }
  }
  const auto room = static_cast<std::size_t>(groups_ * groups_);
  kernel_.resize(static_cast<std::size_t>(pairs));
  factor_.resize(room);
  lower_.resize(room);
  inverse_.resize(room);
  weights_.resize(static_cast<std::size_t>(groups_));
}

double ProfileLikelihood::Compute(const Eigen::VectorXd& log_parameters, Eigen::VectorXd& gradient) {
  const Index n = groups_;
  const Eigen::Index pairs = squares_.rows();
  const double ratio = std::exp(log_parameters(lengths_));
  Eigen::Map<Eigen::VectorXd> kernel(kernel_.data(), pairs);
  kernel.setZero();
  for (Eigen::Index k = 0; k < lengths_; ++k)
    kernel += squares_.col(k) * (-0.5 * std::exp(-2.0 * log_parameters(k)));
  Exponentials(kernel_.data(), pairs);
  const double* from = kernel_.data();
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j) factor_[static_cast<std::size_t>(j * n + i)] = *from++;
    factor_[static_cast<std::size_t>(i * n + i)] = 1.0 + ratio / data_.counts(i);
  }
  gradient.setZero(lengths_ + 1);
  if (!FactorUpper(factor_.data(), n)) return -std::numeric_limits<double>::infinity();
  InvertTransposed(factor_.data(), lower_.data(), n);
  SquareOfLower(lower_.data(), inverse_.data(), n);
  const auto inverse = [this, n](Index i, Index j) {
    return inverse_[static_cast<std::size_t>(i >= j ? i * n + j : j * n + i)];
  };
  double log_determinant = 0.0;
  for (Index i = 0; i < n; ++i)
    log_determinant += 2.0 * std::log(factor_[static_cast<std::size_t>(i * n + i)]);
  // C⁻¹ ȳ and C⁻¹ 1 from the lower half.
  Eigen::VectorXd weighted = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd ones = Eigen::VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < i; ++j) {
      const double value = inverse(i, j);
      weighted(i) += value * data_.means(j);
      weighted(j) += value * data_.means(i);
      ones(i) += value;
      ones(j) += value;
    }
    weighted(i) += inverse(i, i) * data_.means(i);
    ones(i) += inverse(i, i);
  }
  double mean = 0.0;
  if (mean_ == MeanOf::kConstant) {
    mean = weighted.sum() / ones.sum();
    weighted -= mean * ones;
  }
  const double size = data_.size();
  const double quadratic = (data_.means.array() - mean).matrix().dot(weighted) + data_.within / ratio;
  signal_variance_ = quadratic / size;
  if (!(signal_variance_ > 0.0)) return -std::numeric_limits<double>::infinity();
  const double more = size - static_cast<double>(n);
  const double value = -0.5 * size * (std::log(kTwoPi * signal_variance_) + 1.0) - 0.5 * log_determinant -
                       0.5 * more * std::log(ratio) - 0.5 * log_counts_;
  const double inverse_variance = 1.0 / signal_variance_;
  Eigen::Index pair = 0;
  double by_ratio = 0.0;
  for (Index i = 0; i < n; ++i) {
    const double* row = inverse_.data() + i * n;
    const double share = weighted(i) * inverse_variance;
    for (Index j = 0; j < i; ++j, ++pair) kernel(pair) *= share * weighted(j) - row[j];
    by_ratio += (share * weighted(i) - row[i]) / data_.counts(i);
  }
  // A pair stands twice in the trace, which takes its half away.
  for (Eigen::Index k = 0; k < lengths_; ++k)
    gradient(k) = kernel.dot(squares_.col(k)) * std::exp(-2.0 * log_parameters(k));
  gradient(lengths_) =
      0.5 * ratio * (by_ratio + data_.within * inverse_variance / (ratio * ratio) - more / ratio);
  return value;
}

}  // namespace strainwave::analysis::statistics
