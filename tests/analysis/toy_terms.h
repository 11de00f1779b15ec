// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "analysis/diagnosis/separable_study.h"

namespace strainwave::analysis::diagnosis {

using BasisFunction = std::function<double(std::size_t sample)>;

/// A term of one column for each basis function, whose numbers are called size_0, size_1 and so on.
inline SeparableTerm TermOf(std::vector<BasisFunction> basis_functions) {
  SeparableTerm term;
  term.columns = basis_functions.size();
  std::vector<NonlinearParameterDescription> numbers;
  for (std::size_t k = 0; k < basis_functions.size(); ++k)
    numbers.push_back({"size_" + std::to_string(k), "1"});
  term.fill = [basis_functions = std::move(basis_functions)](std::span<const double>,
                                                             Eigen::Ref<Eigen::MatrixXd> design) {
    for (Eigen::Index i = 0; i < design.rows(); ++i) {
      for (Eigen::Index k = 0; k < design.cols(); ++k)
        design(i, k) = basis_functions[static_cast<std::size_t>(k)](static_cast<std::size_t>(i));
    }
  };
  DescribeEach(term, std::move(numbers));
  return term;
}

}  // namespace strainwave::analysis::diagnosis
