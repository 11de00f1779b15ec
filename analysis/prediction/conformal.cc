// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/conformal.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

namespace strainwave::analysis::prediction {
namespace {

void RequireShape(const char* name, const Eigen::MatrixXd& values, const Eigen::MatrixXd& like) {
  if (values.rows() != like.rows() || values.cols() != like.cols()) {
    throw std::invalid_argument(fmt::format("{} is {} × {} (expected {} × {}, as actual)", name,
                                            values.rows(), values.cols(), like.rows(), like.cols()));
  }
}

struct WeightedScore {
  double score{};
  double weight{};
};

}  // namespace

ConformalBand CalibrateBand(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted,
                            const Eigen::MatrixXd& spread, std::span<const int> group, double coverage) {
  RequireShape("predicted", predicted, actual);
  RequireShape("spread", spread, actual);
  if (group.size() != static_cast<std::size_t>(actual.rows()) || group.empty()) {
    throw std::invalid_argument(
        fmt::format("group has {} values (expected {}, one or more)", group.size(), actual.rows()));
  }
  if (!(spread.array() > 0.0).all()) throw std::invalid_argument("spread has a value that is not positive");
  if (!(coverage > 0.0 && coverage < 1.0)) {
    throw std::invalid_argument(fmt::format("coverage = {} is not between 0 and 1", coverage));
  }
  std::map<int, double> members;
  for (const int number : group) members[number] += 1.0;
  const double per_group = 1.0 / (static_cast<double>(members.size()) + 1.0);

  ConformalBand band{
      .coverage = coverage, .factor = Eigen::RowVectorXd::Zero(actual.cols()), .guaranteed = true};
  std::vector<WeightedScore> scores(group.size());
  for (Eigen::Index column = 0; column < actual.cols(); ++column) {
    for (std::size_t i = 0; i < group.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      scores[i] = {std::abs(actual(row, column) - predicted(row, column)) / spread(row, column),
                   per_group / members[group[i]]};
    }
    std::sort(scores.begin(), scores.end(),
              [](const WeightedScore& a, const WeightedScore& b) { return a.score < b.score; });
    constexpr double kRounding = 1e-12;
    double mass = 0.0;
    auto at = scores.begin();
    for (; at != scores.end(); ++at) {
      mass += at->weight;
      if (mass >= coverage - kRounding) break;
    }
    if (at == scores.end()) {
      band.guaranteed = false;
      --at;
    }
    band.factor(column) = at->score;
  }
  return band;
}

Eigen::RowVectorXd CoverageOf(const ConformalBand& band, const Eigen::MatrixXd& actual,
                              const Eigen::MatrixXd& predicted, const Eigen::MatrixXd& spread) {
  RequireShape("predicted", predicted, actual);
  RequireShape("spread", spread, actual);
  const Eigen::ArrayXXd width = spread.array().rowwise() * band.factor.array();
  return ((actual - predicted).array().abs() <= width).cast<double>().colwise().mean();
}

Eigen::RowVectorXd LeftOutCoverage(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& predicted,
                                   const Eigen::MatrixXd& spread, std::span<const int> group,
                                   std::span<const Split> folds, double coverage) {
  Eigen::RowVectorXd inside = Eigen::RowVectorXd::Zero(actual.cols());
  double records = 0.0;
  for (const Split& fold : folds) {
    std::vector<int> others;
    for (const Eigen::Index row : fold.train) others.push_back(group[static_cast<std::size_t>(row)]);
    const ConformalBand band =
        CalibrateBand(actual(fold.train, Eigen::all), predicted(fold.train, Eigen::all),
                      spread(fold.train, Eigen::all), others, coverage);
    const auto tested = static_cast<double>(fold.test.size());
    inside += tested * CoverageOf(band, actual(fold.test, Eigen::all), predicted(fold.test, Eigen::all),
                                  spread(fold.test, Eigen::all));
    records += tested;
  }
  return inside / records;
}

}  // namespace strainwave::analysis::prediction
