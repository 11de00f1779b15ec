// SPDX-License-Identifier: Apache-2.0
#include "analysis/prediction/samples.h"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <stdexcept>

namespace strainwave::analysis::prediction {
namespace {

void RequireLength(const char* name, std::size_t length, Eigen::Index expected) {
  if (length != static_cast<std::size_t>(expected)) {
    throw std::invalid_argument(fmt::format("{} has {} values (expected {})", name, length, expected));
  }
}

void RequireFinite(const char* what, const Eigen::MatrixXd& values, const std::vector<std::string>& names) {
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    for (Eigen::Index row = 0; row < values.rows(); ++row) {
      if (!std::isfinite(values(row, column))) {
        throw std::invalid_argument(fmt::format("{} {} of row {} is {} (expected a finite number)", what,
                                                names[static_cast<std::size_t>(column)], row,
                                                values(row, column)));
      }
    }
  }
}

}  // namespace

int SpecimenCount(const Samples& samples) {
  return static_cast<int>(std::set<int>(samples.specimen.begin(), samples.specimen.end()).size());
}

Eigen::MatrixXd Values(const Samples& samples, const Eigen::MatrixXd& targets) {
  return samples.origin.size() > 0 ? samples.origin + targets : targets;
}

Samples Rows(const Samples& samples, const std::vector<Eigen::Index>& rows) {
  Samples chosen{.features = samples.features(rows, Eigen::all),
                 .targets = samples.targets(rows, Eigen::all),
                 .specimen = {},
                 .cycle = {},
                 .inputs = samples.inputs,
                 .outputs = samples.outputs,
                 .classes = samples.classes,
                 .origin = {}};
  if (samples.origin.size() > 0) chosen.origin = samples.origin(rows, Eigen::all);
  chosen.specimen.reserve(rows.size());
  chosen.cycle.reserve(rows.size());
  for (const Eigen::Index row : rows) {
    chosen.specimen.push_back(samples.specimen[static_cast<std::size_t>(row)]);
    chosen.cycle.push_back(samples.cycle[static_cast<std::size_t>(row)]);
  }
  return chosen;
}

Samples Inputs(const Samples& samples, const std::vector<Eigen::Index>& columns) {
  Samples chosen{.features = samples.features(Eigen::all, columns),
                 .targets = samples.targets,
                 .specimen = samples.specimen,
                 .cycle = samples.cycle,
                 .inputs = {},
                 .outputs = samples.outputs,
                 .classes = samples.classes,
                 .origin = samples.origin};
  chosen.inputs.reserve(columns.size());
  for (const Eigen::Index column : columns) {
    chosen.inputs.push_back(samples.inputs[static_cast<std::size_t>(column)]);
  }
  return chosen;
}

void Check(const Samples& samples) {
  RequireLength("inputs", samples.inputs.size(), samples.features.cols());
  RequireLength("outputs", samples.outputs.size(), samples.targets.cols());
  RequireLength("targets", static_cast<std::size_t>(samples.targets.rows()), samples.size());
  RequireLength("specimen", samples.specimen.size(), samples.size());
  RequireLength("cycle", samples.cycle.size(), samples.size());
  RequireFinite("feature", samples.features, samples.inputs);
  RequireFinite("target", samples.targets, samples.outputs);
}

}  // namespace strainwave::analysis::prediction
