// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

/// A record with nothing but regressors, for what looks at residuals.
struct PlainRecord {
  std::vector<double> measured;
  std::vector<Regressor> regressors;
  std::vector<std::size_t> segments{0};
  std::string unit{"arcmin"};
  double unit_per_si{1.0};
  std::size_t block_length{60};
};

using PlainStudy = std::unique_ptr<Study>;

/// Its nominal model is a constant, and it has no causes.
inline PlainStudy MakePlainStudy(PlainRecord record) {
  SeparableModel model;
  model.measured = std::move(record.measured);
  model.regressors = std::move(record.regressors);
  model.segments = std::move(record.segments);
  model.unit = std::move(record.unit);
  model.unit_per_si = record.unit_per_si;
  model.block_length = record.block_length;
  SeparableTerm constant;
  constant.fill = [](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) { design.setOnes(); };
  DescribeEach(constant, {{"offset", model.unit, model.unit_per_si}});
  model.nominal.push_back(std::move(constant));
  return std::make_unique<SeparableStudy>(std::move(model));
}

}  // namespace strainwave::analysis::diagnosis
