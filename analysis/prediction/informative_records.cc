// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/informative_records.h"

#include <fmt/format.h>

#include <stdexcept>

namespace strainwave::analysis::prediction {

std::vector<Eigen::Index> ChooseInformative(const Eigen::MatrixXd& features, Eigen::Index count) {
  if (count < 1 || count > features.rows()) {
    throw std::invalid_argument(fmt::format("count = {} (expected 1 to {})", count, features.rows()));
  }
  const auto squared_distance = [&features](const Eigen::RowVectorXd& from) -> Eigen::VectorXd {
    return (features.rowwise() - from).rowwise().squaredNorm();
  };
  std::vector<Eigen::Index> chosen(1);
  squared_distance(features.colwise().mean()).minCoeff(&chosen.front());
  Eigen::VectorXd nearest = squared_distance(features.row(chosen.front()));
  while (static_cast<Eigen::Index>(chosen.size()) < count) {
    nearest(chosen.back()) = -1.0;  // never twice, even among equal records
    Eigen::Index farthest = 0;
    nearest.maxCoeff(&farthest);
    chosen.push_back(farthest);
    nearest = nearest.cwiseMin(squared_distance(features.row(farthest)));
  }
  return chosen;
}

}  // namespace strainwave::analysis::prediction
