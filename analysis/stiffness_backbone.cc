// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/linear_regression.h"
#include "analysis/prepared_loop.h"
#include "analysis/stiffness_start.h"
#include "analysis/torsional_stiffness.h"

namespace strainwave::analysis {
namespace {

// Shares of the twist's range after a reversal: left out before anything is known, and the most that may be
// left out.
constexpr double kFirstGuess = 0.25;
constexpr double kLongest = 0.45;

struct Sample {
  double torque_Nm{};
  double twist_rad{};
  double direction{};  // +1 rising, −1 falling
  double
      twist_since_reversal_rad{};  // from the reversal that opened the branch, or the record's first sample
};

// φ = φ₀ + Σ cₖ aₖ(T − direction · W), aₖ the part of a torque in segment k.
struct BackboneLine {
  double offset_rad{};
  std::array<double, 3> compliance_rad_per_Nm{};
  double half_height_Nm{};
  LinearFit fit;  // columns: offset, the three compliances, W
  std::array<int, 3> samples{};
};

std::vector<Sample> MakeSamples(const PreparedLoop& loop) {
  const LoopInputs inputs = MakeLoopInputs(loop);
  std::vector<Sample> samples;
  for (const Branch& branch : loop.branches) {
    for (std::size_t i = branch.first + (branch.first == 0 ? 0 : 1); i <= branch.last; ++i) {
      samples.push_back({inputs.torque_Nm[i], loop.twist_rad[i], branch.rising ? 1.0 : -1.0,
                         std::abs(inputs.twist_rad[i] - inputs.twist_rad[branch.first])});
    }
  }
  return samples;
}

std::size_t SegmentOf(double torque_Nm, const TestTorques& torques) {
  const double size = std::abs(torque_Nm);
  return (size > torques.t1_Nm ? 1U : 0U) + (size > torques.t2_Nm ? 1U : 0U);
}

std::array<double, 3> SegmentParts(double torque_Nm, const TestTorques& torques) {
  const double sign = torque_Nm < 0.0 ? -1.0 : 1.0;
  const double size = std::abs(torque_Nm);
  return {sign * std::min(size, torques.t1_Nm),
          sign * std::clamp(size - torques.t1_Nm, 0.0, torques.t2_Nm - torques.t1_Nm),
          sign * std::max(size - torques.t2_Nm, 0.0)};
}

double TwistOnLine(const BackboneLine& line, const Sample& sample, const TestTorques& torques) {
  const auto parts = SegmentParts(sample.torque_Nm - sample.direction * line.half_height_Nm, torques);
  double twist_rad = line.offset_rad;
  for (std::size_t k = 0; k < 3; ++k) {
    twist_rad += line.compliance_rad_per_Nm[k] * parts[k];
  }
  return twist_rad;
}

// Gauss–Newton in W; all else is linear.
BackboneLine FitBackboneLine(const std::vector<Sample>& all, double left_out_rad, const TestTorques& torques,
                             BackboneLine line) {
  std::vector<Sample> samples;
  std::copy_if(all.begin(), all.end(), std::back_inserter(samples),
               [&](const Sample& sample) { return sample.twist_since_reversal_rad >= left_out_rad; });
  line.samples = {};
  if (samples.size() < 16) {
    return line;
  }
  const auto n = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd design(n, 5);
  Eigen::VectorXd twist(n);
  constexpr int kIterations = 30;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    for (Eigen::Index row = 0; row < n; ++row) {
      const Sample& sample = samples[static_cast<std::size_t>(row)];
      const double spring_Nm = sample.torque_Nm - sample.direction * line.half_height_Nm;
      const auto parts = SegmentParts(spring_Nm, torques);
      design.row(row) << 1.0, parts[0], parts[1], parts[2],
          -sample.direction * line.compliance_rad_per_Nm[SegmentOf(spring_Nm, torques)];
      twist(row) = sample.twist_rad;
    }
    line.fit = FitLinear(design, twist, ErrorModel::kIndependent);
    const Eigen::VectorXd& b = line.fit.coefficients;
    line.offset_rad = b(0);
    line.compliance_rad_per_Nm = {b(1), b(2), b(3)};
    const double step_Nm = std::clamp(b(4), -0.2 * torques.t1_Nm, 0.2 * torques.t1_Nm);
    line.half_height_Nm += step_Nm;
    if (std::abs(step_Nm) < 1e-12 * torques.t3_Nm) {
      break;
    }
  }
  line.fit.covariance = SandwichCovariance(design, line.fit.residuals);
  for (const Sample& sample : samples) {
    ++line.samples[SegmentOf(sample.torque_Nm - sample.direction * line.half_height_Nm, torques)];
  }
  return line;
}

// Distance from a reversal at which the samples have come down to the mid-line of the others, in bins of 0.5
// % of the twist's range; negative if they have not by the longest segment allowed.
double StickLength(const std::vector<Sample>& samples, const BackboneLine& line, double range_rad,
                   const TestTorques& torques) {
  constexpr std::size_t kBins = 90;  // up to kLongest
  std::array<double, kBins> sums_Nm{};
  std::array<int, kBins> counts{};
  double noise_square = 0.0;
  int quiet = 0;
  for (const Sample& sample : samples) {
    const double spring_Nm = sample.torque_Nm - sample.direction * line.half_height_Nm;
    const double compliance = line.compliance_rad_per_Nm[SegmentOf(spring_Nm, torques)];
    if (!(compliance > 0.0)) {
      continue;
    }
    const double off_Nm =
        sample.direction * (sample.twist_rad - TwistOnLine(line, sample, torques)) / compliance;
    const auto bin =
        static_cast<std::size_t>(sample.twist_since_reversal_rad / (kLongest * range_rad) * kBins);
    if (bin < kBins) {
      sums_Nm[bin] += off_Nm;
      ++counts[bin];
    } else {
      noise_square += off_Nm * off_Nm;
      ++quiet;
    }
  }
  const double noise_Nm = quiet > 0 ? std::sqrt(noise_square / quiet) : 0.0;
  int still = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (counts[bin] == 0) {
      continue;
    }
    const double off_Nm = std::abs(sums_Nm[bin] / counts[bin]);
    const double allowed_Nm = std::max({0.05 * 2.0 * std::abs(line.half_height_Nm),
                                        3.0 * noise_Nm / std::sqrt(counts[bin]), 1e-6 * torques.t3_Nm});
    still = off_Nm <= allowed_Nm ? still + 1 : 0;
    if (still == 3) {
      return static_cast<double>(bin - 1) / kBins * kLongest * range_rad;
    }
  }
  return -1.0;
}

}  // namespace

TorsionalStiffness FitStiffnessBackbone(const TorsionLoop& raw, const TestTorques& torques) {
  const PreparedLoop loop = PrepareLoop(raw, torques);
  const std::vector<Sample> samples = MakeSamples(loop);
  const auto [low, high] = std::minmax_element(loop.twist_rad.begin(), loop.twist_rad.end());
  const auto [low_Nm, high_Nm] = std::minmax_element(loop.torque_Nm.begin(), loop.torque_Nm.end());
  const double range_rad = std::max(*high - *low, 1e-12);

  TorsionalStiffness result;
  BackboneLine line;
  line.compliance_rad_per_Nm.fill(range_rad / std::max(*high_Nm - *low_Nm, 1e-12));
  line = FitBackboneLine(samples, kFirstGuess * range_rad, torques, line);
  for (int round = 0; round < 3; ++round) {
    const double length_rad = StickLength(samples, line, range_rad, torques);
    if (length_rad < 0.0) {
      result.failed_checks.push_back("friction still sticks half-way between the reversals");
      break;
    }
    // A tenth more, for the 5 % of the height that the length leaves.
    line = FitBackboneLine(samples, std::min(1.1 * length_rad, kLongest * range_rad), torques, line);
  }

  result.friction_torque_Nm = std::abs(line.half_height_Nm);
  Estimate* slopes[3] = {&result.k1_Nm_per_rad, &result.k2_Nm_per_rad, &result.k3_Nm_per_rad};
  for (std::size_t k = 0; k < 3; ++k) {
    constexpr int kMinPerSegment = 8;
    if (line.samples[k] < kMinPerSegment) {
      *slopes[k] = kNotEstimated;
      result.failed_checks.push_back(
          fmt::format("too few samples for K{} where friction slides: {} (expected at least {})", k + 1,
                      line.samples[k], kMinPerSegment));
      continue;
    }
    const double compliance = line.compliance_rad_per_Nm[k];
    const double error = line.fit.StandardError(static_cast<Eigen::Index>(k) + 1);
    *slopes[k] = {1.0 / compliance, error / (compliance * compliance)};
  }
  MeasureLoopWidth(loop, &result);
  CheckLoop(loop, &result);
  return result;
}

}  // namespace strainwave::analysis
