// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/channel_fits.h"

#include <algorithm>
#include <utility>

#include "analysis/diagnosis/vibration/column_blocks.h"
#include "analysis/products.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using ConstColumns = Eigen::Ref<const MatrixXd>;

constexpr Index kRowsTogether = 1024;  // of a few dozen columns, that the second cache holds
constexpr Index kRowsOfPart = 16384;   // some milliseconds of work for a thread

// Of the squares that are left: a change that takes off no more moves the residual by 1e-9 of itself.
constexpr double kNegligibleSquares = 1e-18;

// The sum of what `add(first, rows, sums)` adds for blocks of rows.
template <typename Sums, typename Add>
Sums SumOverRows(Index rows, const Sums& zero, const ParallelFor& parallel, Add add) {
  std::vector<Sums> parts(
      static_cast<std::size_t>(std::max<Index>(1, (rows + kRowsOfPart - 1) / kRowsOfPart)), zero);
  parallel(parts.size(), [&](std::size_t p) {
    const Index begin = static_cast<Index>(p) * kRowsOfPart;
    const Index end = std::min(rows, begin + kRowsOfPart);
    for (Index first = begin; first < end; first += kRowsTogether)
      add(first, std::min(kRowsTogether, end - first), parts[p]);
  });
  for (std::size_t p = 1; p < parts.size(); ++p) parts.front() += parts[p];
  return std::move(parts.front());
}

struct Matrices {
  std::vector<MatrixXd> each;

  Matrices& operator+=(const Matrices& other) {
    for (std::size_t i = 0; i < each.size(); ++i) each[i] += other.each[i];
    return *this;
  }
};

// Columns under weights: themselves where all weights are one.
class Weighted {
 public:
  Weighted(const ColumnBlock& columns, const Eigen::Ref<const VectorXd>& weights) : block_(columns) {
    if ((weights.array() == 1.0).all()) return;
    const Eigen::Map<const MatrixXd, 0, Eigen::OuterStride<>> own(
        columns.data, weights.size(), columns.columns, Eigen::OuterStride<>(columns.stride));
    copy_ = weights.asDiagonal() * own;
    block_ = {copy_.data(), copy_.outerStride(), copy_.cols()};
  }
  const ColumnBlock& block() const { return block_; }

 private:
  MatrixXd copy_;
  ColumnBlock block_;
};

// values += columns · factors, of a block of rows.
void AddCombinations(const ColumnBlock& columns, const ConstColumns& factors, Index rows, double* values,
                     Index stride) {
  CombineRows<double>({factors.data(), factors.outerStride(), 1}, {columns.data, columns.stride},
                      {values, stride}, factors.cols(), columns.columns, rows, Sum::kAdd);
}

bool HaveEqualColumns(const ConstColumns& matrix) {
  for (Index c = 1; c < matrix.cols(); ++c) {
    if (matrix.col(c) != matrix.col(0)) return false;
  }
  return true;
}

// Parameters that lie side by side.
struct ParameterRange {
  Index first;
  Index count;
};

// Those by which the channels' models change.
std::vector<ParameterRange> MovingParameters(const ChannelSlopes& slopes) {
  std::vector<ParameterRange> ranges;
  Index s = 0;
  for (const TermSlopes& term : slopes.terms) {
    if (term.slopes != nullptr && term.parameters > 0) {
      if (!ranges.empty() && ranges.back().first + ranges.back().count == s) {
        ranges.back().count += term.parameters;
      } else {
        ranges.push_back({s, term.parameters});
      }
    }
    s += term.parameters;
  }
  return ranges;
}

// Derivatives of the channels' models, of a block of rows: of channel c by parameter s
// at values + c · channel_stride + s · stride.
void FillDerivatives(const ChannelSlopes& slopes, Index first, Index rows, double* values,
                     Index channel_stride, Index stride) {
  const auto channels = static_cast<Index>(slopes.fits.size());
  Index s = 0;
  for (const TermSlopes& term : slopes.terms) {
    if (term.slopes == nullptr) {
      const Index end = s + term.parameters;
      for (; s < end; ++s) {
        for (Index c = 0; c < channels && !term.filled_by_others; ++c)
          std::fill_n(values + c * channel_stride + s * stride, rows, 0.0);
      }
      continue;
    }
    MatrixXd coefficients(term.width, channels);
    for (Index c = 0; c < channels; ++c)
      coefficients.col(c) =
          slopes.fits[static_cast<std::size_t>(c)]->coefficients.segment(term.first, term.width);
    for (Index k = 0; k < term.parameters; ++k, ++s) {
      CombineRows<double>({coefficients.data(), coefficients.outerStride(), 1},
                          {term.slopes->col(k * term.width).data() + first, term.slopes->outerStride()},
                          {values + s * stride, channel_stride}, channels, term.width, rows, Sum::kOverwrite);
    }
  }
}

}  // namespace

MatrixXd SharedColumns::Rows(Index first, Index count) const {
  MatrixXd rows(count, columns_);
  Index column = 0;
  for (const MatrixXd* part : parts_) {
    for (Index k = 0; k < part->cols(); ++k) std::copy_n(&(*part)(first, k), count, &rows(0, column++));
  }
  return rows;
}

std::vector<ChannelFit> FitChannels(const SharedColumns& columns, const ConstColumns& responses,
                                    const ConstColumns& weights, const ParallelFor& parallel) {
  const Index width = columns.cols();
  const Index channels = responses.cols();
  const auto squares = static_cast<std::size_t>(HaveEqualColumns(weights) ? 1 : channels);
  // The columns' products with the channels, then with themselves.
  Matrices zero{std::vector<MatrixXd>(squares, MatrixXd::Zero(width, width))};
  zero.each.push_back(MatrixXd::Zero(width, channels));
  const Matrices products =
      SumOverRows(columns.rows(), zero, parallel, [&](Index first, Index rows, Matrices& sums) {
        const MatrixXd block = columns.Rows(first, rows);
        const ColumnBlock own = BlockOf(block, 0);
        for (std::size_t c = 0; c < squares; ++c) {
          const Weighted weighted(own, weights.col(static_cast<Index>(c)).segment(first, rows));
          AddSymmetric(weighted.block(), own, rows, sums.each[c]);
        }
        const MatrixXd values =
            weights.middleRows(first, rows).cwiseProduct(responses.middleRows(first, rows));
        AddProducts(own, BlockOf(values, 0), rows, sums.each.back());
      });
  std::vector<ChannelFit> fits(static_cast<std::size_t>(channels));
  for (std::size_t c = 0; c < fits.size(); ++c)
    fits[c].inverse = c < squares ? PseudoInverse(WithUpperHalf(products.each[c])) : fits[0].inverse;
  MatrixXd left = responses;
  const auto take_off = [&](const MatrixXd& common) {
    MatrixXd change(width, channels);
    for (Index c = 0; c < channels; ++c) {
      ChannelFit& fit = fits[static_cast<std::size_t>(c)];
      change.col(c) = fit.inverse * common.col(c);
      fit.coefficients =
          fit.coefficients.size() == 0 ? VectorXd(change.col(c)) : fit.coefficients + change.col(c);
    }
    return MatrixXd(-change);
  };
  // Once more on what is left: the normal equations lose half of the digits.
  const auto square_sum = [&](Index channel, Index first, Index rows) {
    return weights.col(channel).segment(first, rows).dot(left.col(channel).segment(first, rows).cwiseAbs2());
  };
  const MatrixXd first_change = take_off(products.each.back());
  const Matrices again = SumOverRows(
      columns.rows(), Matrices{{MatrixXd::Zero(width, channels), MatrixXd::Zero(channels, 1)}}, parallel,
      [&](Index first, Index rows, Matrices& sums) {
        const MatrixXd block = columns.Rows(first, rows);
        const ColumnBlock own = BlockOf(block, 0);
        AddCombinations(own, first_change, rows, left.data() + first, left.outerStride());
        const MatrixXd values = weights.middleRows(first, rows).cwiseProduct(left.middleRows(first, rows));
        AddProducts(own, BlockOf(values, 0), rows, sums.each[0]);
        for (Index c = 0; c < channels; ++c) sums.each[1](c) += square_sum(c, first, rows);
      });
  const MatrixXd second_change = take_off(again.each[0]);
  VectorXd square_sums = again.each[1];
  // Squares that the second change takes off, beside those that are left.
  const VectorXd taken = -second_change.cwiseProduct(again.each[0]).colwise().sum();
  if ((taken.array() > kNegligibleSquares * square_sums.array()).any()) {
    square_sums = SumOverRows(columns.rows(), VectorXd(VectorXd::Zero(channels)), parallel,
                              [&](Index first, Index rows, VectorXd& sums) {
                                const MatrixXd block = columns.Rows(first, rows);
                                AddCombinations(BlockOf(block, 0), second_change, rows, left.data() + first,
                                                left.outerStride());
                                for (Index c = 0; c < channels; ++c) sums(c) += square_sum(c, first, rows);
                              });
  }
  for (Index c = 0; c < channels; ++c) {
    fits[static_cast<std::size_t>(c)].residual = left.col(c);
    fits[static_cast<std::size_t>(c)].square_sum = square_sums(c);
  }
  return fits;
}

std::vector<ChannelFit> FitChannels(const MatrixXd& columns, const ConstColumns& responses) {
  SharedColumns shared;
  shared.Add(columns);
  return FitChannels(shared, responses, MatrixXd::Ones(responses.rows(), responses.cols()), InTurn);
}

Index ChannelSlopes::parameters() const {
  Index sum = 0;
  for (const TermSlopes& term : terms) sum += term.parameters;
  return sum;
}

std::vector<MatrixXd> AddChannels(const ChannelSlopes& slopes, const ParallelFor& parallel,
                                  SharedStep& step) {
  const Index parameters = slopes.parameters();
  const Index width = slopes.columns.cols();
  const std::size_t channels = slopes.fits.size();
  // Of each channel: columns · derivatives, then derivatives · derivatives, then derivatives · what is left.
  Matrices zero;
  for (std::size_t c = 0; c < channels; ++c) {
    for (const auto& [rows, cols] :
         {std::pair{width, parameters}, {parameters, parameters}, {parameters, Index{1}}})
      zero.each.push_back(MatrixXd::Zero(rows, cols));
  }
  const Matrices sums =
      SumOverRows(slopes.columns.rows(), zero, parallel, [&](Index first, Index rows, Matrices& sum) {
        MatrixXd derivatives(rows, parameters * static_cast<Index>(channels));
        FillDerivatives(slopes, first, rows, derivatives.data(), rows * parameters, rows);
        const MatrixXd columns = slopes.columns.Rows(first, rows);
        for (std::size_t c = 0; c < channels; ++c) {
          const auto channel = static_cast<Index>(c);
          const ColumnBlock own{derivatives.data() + channel * rows * parameters, rows, parameters};
          const Weighted weighted(own, slopes.weights.col(channel).segment(first, rows));
          AddProducts(BlockOf(columns, 0), weighted.block(), rows, sum.each[3 * c]);
          AddSymmetric(weighted.block(), own, rows, sum.each[3 * c + 1]);
          AddProducts(weighted.block(), {slopes.fits[c]->residual.data() + first, rows, 1}, rows,
                      sum.each[3 * c + 2]);
        }
      });
  std::vector<MatrixXd> follows;
  for (std::size_t c = 0; c < channels; ++c) {
    const MatrixXd& common = sums.each[3 * c];
    const MatrixXd coupling = slopes.fits[c]->inverse * common;
    step.normal += WithUpperHalf(sums.each[3 * c + 1]) - coupling.transpose() * common;
    step.gradient += sums.each[3 * c + 2];
    follows.push_back(-coupling);
  }
  return follows;
}

std::vector<MatrixXd> ProjectedDerivatives(const ChannelSlopes& slopes, const ParallelFor& parallel,
                                           Eigen::Ref<MatrixXd> derivatives) {
  const Index parameters = slopes.parameters();
  const Index samples = slopes.columns.rows();
  const std::size_t channels = slopes.fits.size();
  const auto at = [&](std::size_t channel, Index row) {
    return derivatives.data() + static_cast<Index>(channel) * samples + row;
  };
  const Index stride = derivatives.outerStride();
  const std::vector<ParameterRange> moving = MovingParameters(slopes);
  const Matrices common = SumOverRows(
      samples, Matrices{std::vector<MatrixXd>(channels, MatrixXd::Zero(slopes.columns.cols(), parameters))},
      parallel, [&](Index first, Index rows, Matrices& sum) {
        FillDerivatives(slopes, first, rows, at(0, first), samples, stride);
        const MatrixXd columns = slopes.columns.Rows(first, rows);
        for (std::size_t c = 0; c < channels; ++c) {
          for (const ParameterRange& range : moving) {
            const Weighted weighted({at(c, first) + range.first * stride, stride, range.count},
                                    slopes.weights.col(static_cast<Index>(c)).segment(first, rows));
            AddProducts(BlockOf(columns, 0), weighted.block(), rows,
                        sum.each[c].middleCols(range.first, range.count));
          }
        }
      });
  std::vector<MatrixXd> follows;
  for (std::size_t c = 0; c < channels; ++c) follows.push_back(-slopes.fits[c]->inverse * common.each[c]);
  SumOverRows(samples, 0, parallel, [&](Index first, Index rows, int&) {
    const MatrixXd columns = slopes.columns.Rows(first, rows);
    for (std::size_t c = 0; c < channels; ++c) {
      for (const ParameterRange& range : moving)
        AddCombinations(BlockOf(columns, 0), follows[c].middleCols(range.first, range.count), rows,
                        at(c, first) + range.first * stride, stride);
    }
  });
  return follows;
}

SharedStep StepOfDerivatives(const ConstColumns& derivatives, const Eigen::Ref<const VectorXd>& left,
                             const Eigen::Ref<const VectorXd>& weights, const ParallelFor& parallel) {
  const Index parameters = derivatives.cols();
  const Matrices sums = SumOverRows(
      derivatives.rows(), Matrices{{MatrixXd::Zero(parameters, parameters), MatrixXd::Zero(parameters, 1)}},
      parallel, [&](Index first, Index rows, Matrices& sum) {
        const ColumnBlock own = BlockOf(derivatives, first);
        const Weighted weighted(own, weights.segment(first, rows));
        AddSymmetric(weighted.block(), own, rows, sum.each[0]);
        AddProducts(weighted.block(), {left.data() + first, rows, 1}, rows, sum.each[1]);
      });
  SharedStep step(parameters);
  step.normal = WithUpperHalf(sums.each[0]);
  step.gradient = sums.each[1];
  return step;
}

ProductsOfFurther ProductsBeside(const ConstColumns& columns, const ConstColumns& others,
                                 const ConstColumns& residuals,
                                 const Eigen::Ref<const VectorXd>& root_weights,
                                 const ParallelFor& parallel) {
  const Index width = columns.cols();
  Matrices sums =
      SumOverRows(columns.rows(),
                  Matrices{{MatrixXd::Zero(width, width), MatrixXd::Zero(others.cols(), width),
                            MatrixXd::Zero(width, residuals.cols())}},
                  parallel, [&](Index first, Index rows, Matrices& sum) {
                    const Weighted weighted(BlockOf(columns, first), root_weights.segment(first, rows));
                    const ColumnBlock& own = weighted.block();
                    AddSymmetric(own, own, rows, sum.each[0]);
                    AddProducts(BlockOf(others, first), own, rows, sum.each[1]);
                    AddProducts(own, BlockOf(residuals, first), rows, sum.each[2]);
                  });
  return {WithUpperHalf(sums.each[0]), std::move(sums.each[1]), std::move(sums.each[2])};
}

}  // namespace strainwave::analysis::diagnosis
