// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

using Shape = std::function<double(std::size_t sample)>;

/// A term of one column for each shape, whose numbers are called size_0, size_1 and so on.
inline SeparableTerm TermOf(std::vector<Shape> shapes) {
  SeparableTerm term;
  term.columns = shapes.size();
  std::vector<ShapeDescription> numbers;
  for (std::size_t k = 0; k < shapes.size(); ++k) numbers.push_back({"size_" + std::to_string(k), "1"});
  term.fill = [shapes = std::move(shapes)](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      for (Eigen::Index k = 0; k < design.cols(); ++k)
        design(i, k) = shapes[static_cast<std::size_t>(k)](static_cast<std::size_t>(i));
    }
  };
  DescribeEach(term, std::move(numbers));
  return term;
}

}  // namespace strainwave::analysis::diagnosis
