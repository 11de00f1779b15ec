// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "analysis/diagnosis/motion/bandwidth.h"
#include "analysis/diagnosis/motion/kernel.h"
#include "analysis/diagnosis/motion/reversal_smoothing.h"
#include "analysis/diagnosis/motion/samples.h"

namespace strainwave::analysis::diagnosis {

/// As many rows as a grid has at most: what fits can go over a few hundred times.
inline constexpr std::size_t kMostRows = 16000;

/// A motion record as the terms need it, on two grids.
///
/// Points: position, velocity and so on at (nearly) the record's own rate, smoothed only as much as their
/// noise asks for. Terms that are not linear in the motion are evaluated there.
///
/// Rows: the response. Torque and all terms pass one and the same low-pass (motion/kernel.h) and are taken at
/// a spacing that leaves white noise white, so that noise of the acceleration does not shrink the inertia
/// (parallel filtering; Gautier, ICRA 1997). Around acceleration transients that the path is too noisy for it
/// is a wider one; where every sample is known there may be none (motion/settled_grid.h).
///
/// Left out of the rows: what lies within a low-pass's length of a gap, of clipped torque, or of a rest,
/// where Coulomb friction may take any value below its limit; and what motion/rows.h says of reversals.
struct MotionGrid {
  /// A segment of points at even steps.
  struct Segment {
    std::size_t record{};
    std::size_t first{};  // point
    std::size_t count{};
    double step_s{};
    KernelTaps low_pass;
    KernelTaps wide_low_pass;  // around acceleration transients; the same where no row needs a wider one
  };
  std::vector<Segment> segments;
  bool linear{};
  double sigma_s{};         // of the low-pass
  double path_sigma_s{};    // of position, velocity and acceleration
  double velocity_noise{};  // of the points
  double position_noise{};
  double acceleration_noise{};           // of most points
  ReversalSmoothing reversal_smoothing;  // how the sign of velocity changes
  double reversal_error_s{};  // standard deviation of each reversal's time in a torque that is resampled

  // Points.
  std::vector<double> time_s;
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> direction;         // −1 to 1: smooth sign of velocity
  std::vector<double> temperature_degC;  // empty: none; as smooth as temperatures are
  std::vector<double> passed_acceleration;
  std::vector<double> passed_torque;
  std::vector<double> noise_of_acceleration;  // more where an axis is not calm
  std::vector<bool> wide;                     // where rows pass the wider low-pass
  // Around acceleration transients (motion/acceleration_transients.h): how wrong the acceleration may be, and
  // the acceleration in the last half octave.
  std::vector<double> acceleration_error;
  std::vector<double> last_band;
  std::vector<double>
      jump_error;  // standard error where it jumps: when, between two samples of the torque, is unknown

  // Rows.
  std::vector<std::size_t> point_of_row;
  std::vector<std::size_t> segment_of_row;
  std::vector<std::size_t> response_segments;  // first row of each run without a gap
  std::vector<double> measured;                // torque, low-passed
  std::vector<double> weights;                 // less than one where the acceleration is known badly
  Eigen::MatrixXd nominal;        // rows × (acceleration, velocity, direction, one for each record)
  Eigen::MatrixXd nominal_basis;  // orthonormal, of the same space
  Eigen::VectorXd prefit;         // the nominal numbers by least squares
  double inertia_error{};  // standard error of the first of them; its column is zero where that drowns it
  double noise_floor{};    // of the low-passed torque
  double filtered_out_variance{};  // of the torque's noise, by the low-pass
  double row_spacing_s{};

  /// Half power of the low-pass, and of the smoothing of the path: nothing faster is known of the motion.
  double cutoff_rad_per_s() const { return kHalfPower / sigma_s; }
  double path_cutoff_rad_per_s() const { return kHalfPower / path_sigma_s; }
  std::size_t rows() const { return point_of_row.size(); }
  /// How often the velocity changes its sign for certain.
  std::size_t Reversals() const;
  /// That a row at a point passes.
  const KernelTaps& LowPassAt(const Segment& segment, std::size_t point) const {
    return wide[point] ? segment.wide_low_pass : segment.low_pass;
  }
  double RowTime_s(std::size_t row) const { return time_s[point_of_row[row]]; }
  /// Low-pass of a quantity of the points, at the rows.
  Eigen::VectorXd Project(std::span<const double> points) const;
  /// The same of a quantity that is zero but at the points [first, last) of a segment.
  void AddProjected(std::span<const double> points, std::size_t first, std::size_t last,
                    Eigen::Ref<Eigen::VectorXd> values) const;
  /// A quantity that has passed the low-pass already, but for the wider one, at the rows.
  Eigen::VectorXd ProjectPassed(std::span<const double> points) const;
  /// A passed quantity a time later, at the points.
  std::vector<double> Later(std::span<const double> passed_points, double shift_s) const;
  /// Columns of the rows, each row by the root of its weight.
  Eigen::MatrixXd Weighted(const Eigen::MatrixXd& columns) const;
  /// What least squares by the nominal terms leaves of columns.
  Eigen::MatrixXd BesideNominal(const Eigen::MatrixXd& columns) const;
};

/// @param expected_delay_s  by which the torque acts late: reversals show in it that much earlier; negative
///   where it was recorded late, 0 where neither.
/// @param reversal_smoothing_delay_s  the same, for choosing over which speed the sign of velocity changes.
/// @throws std::invalid_argument where too little motion is left.
MotionGrid MakeMotionGrid(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                          double expected_delay_s, double reversal_smoothing_delay_s);

/// The path at the grid's points, or where it is a time later.
struct PathPoints {
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<double> passed_acceleration;
};
PathPoints PathLater(const MotionGrid& grid, double shift_s);

/// Columns of effects that may be in any record, so that they do not decide on its details: drag, asymmetry,
/// load, drift, weight.
Eigen::MatrixXd UsualEffects(const MotionGrid& grid, const PathPoints& path);
Eigen::MatrixXd UsualEffects(const MotionGrid& grid);

}  // namespace strainwave::analysis::diagnosis
