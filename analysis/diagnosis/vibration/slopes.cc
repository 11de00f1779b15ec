// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/vibration/impulse_train.h"
#include "analysis/diagnosis/vibration/terms.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

constexpr double kSlopeStep = 0.1;  // of a shape's step, where a slope is a difference

// By the base of the lines' orders.
void FillSlopesOfLines(const std::vector<double>& angle, const VibrationTerm& term,
                       const Ref<const MatrixXd>& columns, MatrixXd& slopes) {
  const auto along = Eigen::Map<const VectorXd>(angle.data(), columns.rows());
  for (std::size_t l = 0; l < term.lines.size(); ++l) {
    const auto pair = static_cast<Index>(2 * l);
    slopes.col(pair) = -term.lines[l].harmonic * along.cwiseProduct(columns.col(pair + 1));
    slopes.col(pair + 1) = term.lines[l].harmonic * along.cwiseProduct(columns.col(pair));
  }
}

// By frequency, centre and width.
void FillSlopesOfBurst(const VibrationRun& run, const VibrationTerm& term, const Ref<const MatrixXd>& columns,
                       MatrixXd& slopes) {
  const auto time_s = Eigen::Map<const VectorXd>(run.time_s.data(), columns.rows());
  const VectorXd since_s = time_s.array() - term.nonlinear_parameters[1];
  const double width_s = term.nonlinear_parameters[2];
  MatrixXd turned(columns.rows(), 2);  // by a quarter
  turned << -columns.col(1), columns.col(0);
  slopes.leftCols(2) = kTwoPi * since_s.asDiagonal() * turned;
  slopes.middleCols(2, 2) =
      since_s.asDiagonal() * columns / (width_s * width_s) - kTwoPi * term.nonlinear_parameters[0] * turned;
  slopes.rightCols(2) = since_s.cwiseAbs2().asDiagonal() * columns / (width_s * width_s * width_s);
}

// By an impact's time or height: the other impacts stay as they are.
void FillSlopeOfImpact(const VibrationRun& run, const VibrationTerm& term, std::size_t nonlinear_parameter,
                       double by, Ref<VectorXd> slope) {
  const bool first = nonlinear_parameter == 2;
  const bool is_height = !first && nonlinear_parameter % 2 == 0;
  const double start_s = term.nonlinear_parameters[is_height ? nonlinear_parameter - 1 : nonlinear_parameter];
  const double height = first || is_height ? 1.0 : term.nonlinear_parameters[nonlinear_parameter + 1];
  const auto add = [&](double at_s, double factor) {
    AddTransient(run, term.nonlinear_parameters[0], term.nonlinear_parameters[1], at_s, factor, slope);
  };
  slope.setZero();
  add(is_height ? start_s : start_s + by, is_height ? 1.0 : height / by);
  if (!is_height) add(start_s, -height / by);
}

// The phases of other records are none of its numbers.
void FillSlopesOfImpulseTrain(const VibrationRun& run, std::size_t which, const VibrationTerm& term,
                              MatrixXd& slopes) {
  const auto phases = static_cast<Index>(3 + 2 * term.lines.size());
  const MatrixXd own = ImpulseTrainSlopes(run, TrainOf(term, which));
  slopes.setZero();
  slopes.leftCols(phases) = own.leftCols(phases);
  slopes.col(phases + static_cast<Index>(which)) = own.col(phases);
}

}  // namespace

MatrixXd FillSlopes(const VibrationSamples& samples, std::size_t which, const VibrationTerm& term,
                    const Ref<const MatrixXd>& columns) {
  const VibrationRun& run = samples.runs[which];
  const std::vector<VibrationNonlinearParameter> nonlinear_parameters = NonlinearParametersOf(samples, term);
  const Index width = columns.cols();
  MatrixXd slopes(columns.rows(), width * static_cast<Index>(nonlinear_parameters.size()));
  switch (term.form) {
    case VibrationForm::kLines:
      if (!nonlinear_parameters.empty()) FillSlopesOfLines(run.angle_rad, term, columns, slopes);
      return slopes;
    case VibrationForm::kTones:
      FillSlopesOfLines(run.time_2pi, term, columns, slopes);
      return slopes;
    case VibrationForm::kBurst:
      FillSlopesOfBurst(run, term, columns, slopes);
      return slopes;
    case VibrationForm::kImpulseTrain:
      FillSlopesOfImpulseTrain(run, which, term, slopes);
      return slopes;
    default:
      break;
  }
  for (std::size_t s = 0; s < nonlinear_parameters.size(); ++s) {
    const double by = kSlopeStep * nonlinear_parameters[s].step;
    const Index first = width * static_cast<Index>(s);
    if (term.form == VibrationForm::kTransients && s >= 2) {
      FillSlopeOfImpact(run, term, s, by, slopes.col(first));
      continue;
    }
    VibrationTerm moved = term;
    moved.nonlinear_parameters[s] += by;
    slopes.middleCols(first, width) = (FillTerm(samples, which, moved) - columns) / by;
  }
  return slopes;
}

}  // namespace strainwave::analysis::diagnosis
