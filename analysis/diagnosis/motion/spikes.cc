// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/spikes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/lone_samples.h"
#include "analysis/noise_level.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr int kRounds = 4;            // of a fit without what the one before has left far off
constexpr double kFarOff = 6.0;       // standard deviations
constexpr double kMuchQuieter = 0.8;  // than the torque is what the motion leaves, to be looked at instead

// Acceleration, velocity, its sign and a constant, by differences of neighbours; rows at uneven or repeated
// stamps, and the first and last, stay zero.
Eigen::MatrixXd MotionColumns(const MotionData& record) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Index>(record.time_s.size()), 4);
  for (std::size_t i = 1; i + 1 < record.time_s.size(); ++i) {
    const double before_s = record.time_s[i] - record.time_s[i - 1];
    const double after_s = record.time_s[i + 1] - record.time_s[i];
    if (!(before_s > 0.0) || !(after_s > 0.5 * before_s && after_s < 2.0 * before_s)) continue;
    const double arriving = (record.position[i] - record.position[i - 1]) / before_s;
    const double leaving = (record.position[i + 1] - record.position[i]) / after_s;
    const double velocity = (arriving * after_s + leaving * before_s) / (before_s + after_s);
    const double acceleration =
        record.velocity.empty() ? 2.0 * (leaving - arriving) / (before_s + after_s)
                                : (record.velocity[i + 1] - record.velocity[i - 1]) / (before_s + after_s);
    columns.row(static_cast<Index>(i)) << acceleration, velocity, velocity > 0.0 ? 1.0 : -1.0, 1.0;
  }
  return columns;
}

// What the motion makes of the torque, by least squares without what is far off; where it is not known, in
// line with its neighbours.
Eigen::VectorXd ByMotion(const MotionData& record, const Eigen::MatrixXd& columns) {
  const Eigen::Map<const Eigen::VectorXd> torque(record.torque.data(), columns.rows());
  Eigen::VectorXd used = columns.col(3);
  Eigen::VectorXd made = Eigen::VectorXd::Zero(columns.rows());
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd weighted = used.asDiagonal() * columns;
    made =
        columns * ShortestLeastSquares(weighted.transpose() * weighted, weighted.transpose() * torque).col(0);
    const Eigen::VectorXd left = columns.col(3).cwiseProduct(torque - made);
    const double usual = RobustStandardDeviation({left.data(), record.torque.size()});
    used = (left.array().abs() < kFarOff * usual).cast<double>().matrix().cwiseProduct(columns.col(3));
  }
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < record.torque.size(); ++i) {
    if (columns(static_cast<Index>(i), 3) == 0.0) unknown.push_back(i);
  }
  InterpolateOver({made.data(), record.torque.size()}, unknown);
  return made;
}

// Where the sign of friction may be off by a sample.
bool IsAtReversal(const Eigen::MatrixXd& columns, std::size_t sample) {
  constexpr Index kReach = 2;
  const auto at = static_cast<Index>(sample);
  const Index first = std::max<Index>(at - kReach, 0);
  const auto signs = columns.col(2).segment(first, std::min(at + kReach + 1, columns.rows()) - first);
  return signs.minCoeff() != signs.maxCoeff();
}

// Size of the changes from sample to sample, but for a straight course.
double Roughness(std::span<const double> signal) {
  std::vector<double> bends;
  for (std::size_t i = 1; i + 1 < signal.size(); ++i)
    bends.push_back(signal[i - 1] - 2.0 * signal[i] + signal[i + 1]);
  return RobustStandardDeviation(bends);
}

}  // namespace

std::size_t BridgeSpikes(MotionData& record, double resolution) {
  std::vector<std::size_t> spikes = FindLoneSamples(record.torque, resolution);
  const Eigen::MatrixXd columns = MotionColumns(record);
  const Eigen::VectorXd made = ByMotion(record, columns);
  std::vector<double> left(record.torque);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] -= made(static_cast<Index>(i));
  if (Roughness(left) > kMuchQuieter * Roughness(record.torque)) {
    InterpolateOver(record.torque, spikes);
    return spikes.size();
  }
  for (const std::size_t spike : FindLoneSamples(left, resolution)) {
    if (!IsAtReversal(columns, spike)) spikes.push_back(spike);
  }
  std::ranges::sort(spikes);
  spikes.erase(std::unique(spikes.begin(), spikes.end()), spikes.end());
  InterpolateOver(left, spikes);
  for (const std::size_t spike : spikes) record.torque[spike] = left[spike] + made(static_cast<Index>(spike));
  return spikes.size();
}

}  // namespace strainwave::analysis::diagnosis
