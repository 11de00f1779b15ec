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

constexpr int kRounds = 4;        // of a fit without what the one before has left far off
constexpr double kFarOff = 6.0;   // standard deviations
constexpr double kAsQuiet = 1.1;  // as the torque is what the motion leaves, to be looked at instead
constexpr double kTakenByDifferences = 0.3;
constexpr double kResidual = 0.5;     // of a bend: with less left of it, the motion has made it
constexpr double kOffTheNoise = 4.0;  // standard deviations of bends

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

constexpr Index kReach = 2;  // samples by which the sign of friction may be early or late

// Has friction change its sign where the torque, all in all, says so.
void ShiftReversals(const Eigen::Map<const Eigen::VectorXd>& torque, const Eigen::MatrixXd& columns,
                    double friction, Eigen::VectorXd& made) {
  for (Index turn = kReach; turn + kReach < columns.rows(); ++turn) {
    const double before = columns(turn - 1, 2);
    const double after = columns(turn, 2);
    if (before == after || before == 0.0 || after == 0.0) continue;
    const Index first = turn - kReach;
    const auto shifted = [&](Index by) {
      Eigen::VectorXd values = made.segment(first, 2 * kReach);
      for (Index i = turn; i < turn + by; ++i) values(i - first) += friction * (before - after);
      for (Index i = turn + by; i < turn; ++i) values(i - first) += friction * (after - before);
      return values;
    };
    const auto off = [&](Index by) { return (torque.segment(first, 2 * kReach) - shifted(by)).lpNorm<1>(); };
    Index best = 0;
    for (Index by = -kReach; by <= kReach; ++by) best = off(by) < off(best) ? by : best;
    made.segment(first, 2 * kReach) = shifted(best);
  }
}

bool IsAtReversal(const Eigen::MatrixXd& columns, Index sample) {
  const Index first = std::max<Index>(sample - kReach, 0);
  const auto signs = columns.col(2).segment(first, std::min(sample + kReach + 1, columns.rows()) - first);
  return signs.minCoeff() != signs.maxCoeff();
}

// What the motion makes of the torque, by least squares without what is far off; where it is not known, in
// line with its neighbours.
struct MadeByMotion {
  Eigen::VectorXd torque;
  double friction{};  // Coulomb's
};
MadeByMotion ByMotion(const MotionData& record, const Eigen::MatrixXd& columns) {
  const Eigen::Map<const Eigen::VectorXd> torque(record.torque.data(), columns.rows());
  Eigen::VectorXd used = columns.col(3);
  MadeByMotion made{Eigen::VectorXd::Zero(columns.rows())};
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::MatrixXd weighted = used.asDiagonal() * columns;
    const Eigen::VectorXd numbers =
        ShortestLeastSquares(weighted.transpose() * weighted, weighted.transpose() * torque).col(0);
    made = {columns * numbers, std::abs(numbers(2))};
    const Eigen::VectorXd left = columns.col(3).cwiseProduct(torque - made.torque);
    const double usual = RobustStandardDeviation({left.data(), record.torque.size()});
    used = (left.array().abs() < kFarOff * usual).cast<double>().matrix().cwiseProduct(columns.col(3));
    if (round + 1 == kRounds) ShiftReversals(torque, columns, numbers(2), made.torque);
  }
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < record.torque.size(); ++i) {
    if (columns(static_cast<Index>(i), 3) == 0.0) unknown.push_back(i);
  }
  InterpolateOver({made.torque.data(), record.torque.size()}, unknown);
  return made;
}

// Size of the changes from sample to sample, but for a straight course.
double Roughness(std::span<const double> signal) {
  std::vector<double> bends;
  for (std::size_t i = 1; i + 1 < signal.size(); ++i)
    bends.push_back(signal[i - 1] - 2.0 * signal[i] + signal[i + 1]);
  return RobustStandardDeviation(bends);
}

// How far a sample stands off the straight course between its neighbours.
double Bend(std::span<const double> signal, std::size_t at) {
  if (at == 0 || at + 1 >= signal.size()) return 0.0;
  return std::abs(signal[at] - 0.5 * (signal[at - 1] + signal[at + 1]));
}

}  // namespace

std::vector<std::size_t> BridgeSpikes(MotionData& record, double resolution,
                                      std::span<const std::size_t> kept) {
  const auto is_kept = [&](std::size_t spike) { return std::ranges::binary_search(kept, spike); };
  const Eigen::MatrixXd columns = MotionColumns(record);
  const MadeByMotion made = ByMotion(record, columns);
  std::vector<double> left(record.torque);
  for (std::size_t i = 0; i < left.size(); ++i) left[i] -= made.torque(static_cast<Index>(i));
  if (Roughness(left) > kAsQuiet * Roughness(record.torque)) {
    std::vector<std::size_t> spikes = FindLoneSamples(record.torque, resolution);
    // The top of an acceleration transient, when the axis turns back within a few samples, is no spike. It
    // bends the motion more than the noise does by which the motion is known.
    const std::span<const double> by_motion{made.torque.data(), left.size()};
    const double least = kOffTheNoise * 0.5 * Roughness(by_motion);
    std::erase_if(spikes, [&](std::size_t spike) {
      return is_kept(spike) ||
             (Bend(by_motion, spike) > least && Bend(left, spike) < kResidual * Bend(record.torque, spike));
    });
    InterpolateOver(record.torque, spikes);
    return spikes;
  }
  std::vector<std::size_t> spikes = FindLoneSamples(left, resolution);
  // Half-way through a reversal friction is off by as much as it is, and at the top of an acceleration
  // transient of a few samples differences of neighbours take a part of it.
  std::erase_if(spikes, [&](std::size_t spike) {
    const double friction = IsAtReversal(columns, static_cast<Index>(spike)) ? made.friction : 0.0;
    const double bend = Bend({made.torque.data(), left.size()}, spike);
    return is_kept(spike) || Bend(left, spike) < std::max(friction, kTakenByDifferences * bend);
  });
  InterpolateOver(left, spikes);
  for (const std::size_t spike : spikes)
    record.torque[spike] = left[spike] + made.torque(static_cast<Index>(spike));
  return spikes;
}

}  // namespace strainwave::analysis::diagnosis
