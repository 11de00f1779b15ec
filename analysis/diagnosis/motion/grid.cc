// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/motion/grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "analysis/decompositions.h"
#include "analysis/diagnosis/motion/acceleration_transients.h"
#include "analysis/diagnosis/motion/rows.h"
#include "analysis/diagnosis/temperature.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr std::size_t kFewestGridRows = 60;
constexpr double kPointsPerSigma = 2.5;  // steps of the points in a σ of the low-pass, at least
constexpr double kUnknownInertia = 3.0;  // standard errors
constexpr double kShows = 0.5;           // of the noise, from which on what is wrong with a row does
// Over the smoothing of the path, which takes next to nothing of what a low-pass half an octave lower lets
// through.
const double kWideningFactor = std::numbers::sqrt2;
constexpr double kMuchSmoother = 1.9;  // than the low-pass: an octave
// Part of what is wrong with an acceleration transient's acceleration that comes from above half the sampling
// rate, and so lies in all that is below it.
constexpr double kFoldedBack = 0.3;

// Goes on beyond both ends as the cubic through what is next to them does, so that what depends on the past
// motion (a second inertia that oscillates) knows it from the record's first sample.
std::vector<double> Extended(const std::vector<double>& values, std::size_t count) {
  const std::size_t used = std::min(values.size(), count + 4);
  Eigen::MatrixXd powers(static_cast<Index>(used), 4);
  for (Index i = 0; i < powers.rows(); ++i) {
    const double x = static_cast<double>(i) / static_cast<double>(used);
    powers.row(i) << 1.0, x, x * x, x * x * x;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor(powers);
  const auto beyond = [&](const auto& value_at) {
    Eigen::VectorXd next(powers.rows());
    for (Index i = 0; i < next.size(); ++i) next(i) = value_at(static_cast<std::size_t>(i));
    const Eigen::Vector4d cubic = factor.solve(next);
    std::vector<double> outwards;
    for (std::size_t k = 1; k <= count; ++k) {
      const double x = -static_cast<double>(k) / static_cast<double>(used);
      outwards.push_back(cubic(0) + x * (cubic(1) + x * (cubic(2) + x * cubic(3))));
    }
    return outwards;
  };
  const std::vector<double> before = beyond([&](std::size_t i) { return values[i]; });
  const std::vector<double> after = beyond([&](std::size_t i) { return values[values.size() - 1 - i]; });
  std::vector<double> extended(before.rbegin(), before.rend());
  extended.insert(extended.end(), values.begin(), values.end());
  extended.insert(extended.end(), after.begin(), after.end());
  return extended;
}

void AddPoints(const EvenSegment& samples, const MotionBandwidth& bandwidth, const PointLayout& layout,
               MotionGrid& grid) {
  const double step_s = samples.step_s;
  const int from_velocity = bandwidth.by_velocity ? 1 : 0;
  const std::vector<double> positions = Extended(samples.position, layout.margin);
  const std::vector<double> speeds =
      bandwidth.by_velocity ? Extended(samples.velocity, layout.margin) : std::vector<double>{};
  const std::vector<double> torque = Extended(samples.torque, layout.margin);
  const std::vector<double>& moved = bandwidth.by_velocity ? speeds : positions;
  const KernelTaps position = MakeKernel(bandwidth.path_sigma_s, step_s, 0);
  const KernelTaps velocity = MakeKernel(bandwidth.path_sigma_s, step_s, 1 - from_velocity);
  const KernelTaps passed_acceleration = MakeKernel(bandwidth.path_sigma_s, step_s, 2 - from_velocity);
  const KernelTaps passed_torque =
      bandwidth.passes_all ? PassAll() : MakeKernel(bandwidth.sigma_s, step_s, 0);
  const std::vector<double> temperature_degC = SlowTemperature(samples.temperature_degC);
  for (std::size_t i = 0; i < samples.position.size(); i += layout.stride) {
    const std::size_t at = layout.margin + i;
    grid.time_s.push_back(samples.start_s + static_cast<double>(i) * step_s);
    grid.position.push_back(position.At(positions, at));
    grid.velocity.push_back(velocity.At(moved, at));
    grid.passed_acceleration.push_back(passed_acceleration.At(moved, at));
    grid.passed_torque.push_back(passed_torque.At(torque, at));
    if (!temperature_degC.empty()) grid.temperature_degC.push_back(temperature_degC[i]);
  }
}

// Where the low-pass lets more of an acceleration transient through than is known of its acceleration, torque
// and terms pass one that is wider than the smoothing of the path: what is slow about an acceleration
// transient is known all the same, and of a motion that turns in short ramps it is all that tells how late
// the torque acts. Neighbours of such rows are alike, and the noise in them is as much less: each counts as
// one.
void WidenRowsAroundAccelerationTransients(double inertia, MotionGrid& grid) {
  grid.wide.assign(grid.time_s.size(), false);
  if (grid.path_sigma_s < kMuchSmoother * grid.sigma_s) return;
  for (MotionGrid::Segment& segment : grid.segments)
    segment.wide_low_pass = MakeKernel(kWideningFactor * grid.path_sigma_s, segment.step_s, 0);
  const double left = kFoldedBack * std::sqrt(grid.sigma_s / grid.path_sigma_s);
  for (std::size_t i = 0; i < grid.wide.size(); ++i) {
    if (std::abs(inertia) * grid.acceleration_error[i] < kShows * grid.noise_floor) continue;
    grid.wide[i] = true;
    grid.acceleration_error[i] *= left;
  }
}

// Rows count by how well their acceleration is known. What is wrong with it around an acceleration transient
// is no chance: all its rows are wrong together, and are worth no more than one that is; its noise is alike
// over the smoothing's width.
std::vector<double> WeightsOf(const MotionGrid& grid, double inertia) {
  std::vector<double> weights(grid.rows(), 1.0);
  const double noise = std::max(grid.noise_floor, 1e-300);
  const auto error = [&](std::size_t row) {
    return inertia / noise * grid.acceleration_error[grid.point_of_row[row]];
  };
  // As many rows as the smoothing of the path makes wrong alike.
  const double correlated = std::max(kRowSpacing * grid.path_sigma_s / grid.row_spacing_s, 1.0);
  const auto more_noise = [&](std::size_t row) {
    const double own = grid.noise_of_acceleration[grid.point_of_row[row]];
    const double more = own * own - grid.acceleration_noise * grid.acceleration_noise;
    return correlated * std::max(inertia * inertia * more, 0.0) / (noise * noise);
  };
  for (std::size_t row = 0; row < weights.size();) {
    std::size_t next = row + 1;
    while (next < weights.size() && error(row) != 0.0 && error(next) != 0.0) ++next;
    const auto together = static_cast<double>(next - row);
    for (; row < next; ++row)
      weights[row] = 1.0 / (1.0 + more_noise(row) + together * error(row) * error(row));
  }
  return weights;
}

// Rows and what they are of, but for the nominal model's friction.
void FillRows(const MotionSamples& samples, std::span<const PointLayout> layouts,
              const MotionBandwidth& bandwidth, double expected_delay_s,
              std::span<const double> reversal_smoothing_error, MotionGrid& grid) {
  ChooseMotionRows(samples, layouts, bandwidth, expected_delay_s, reversal_smoothing_error, grid);
  const auto rows = static_cast<Index>(grid.rows());
  if (grid.rows() < kFewestGridRows) {
    throw std::invalid_argument(
        "too little of the record moves to hold any of it out (expected an axis that is in motion for some "
        "150 "
        "samples and more)");
  }
  grid.nominal.setZero(rows, 3 + static_cast<Index>(samples.records));
  grid.nominal.col(0) = grid.ProjectPassed(grid.passed_acceleration);
  grid.nominal.col(1) = grid.ProjectPassed(grid.velocity);
  for (Index row = 0; row < rows; ++row) {
    const std::size_t record = grid.segments[grid.segment_of_row[static_cast<std::size_t>(row)]].record;
    grid.nominal(row, 3 + static_cast<Index>(record)) = 1.0;
  }
  grid.weights = WeightsOf(grid, bandwidth.inertia);
}

// At each point, by how much the reversal smoothings that are left open differ there.
std::vector<double> ReversalSmoothingErrors(const MotionGrid& grid, std::span<const ReversalSmoothing> open,
                                            double coulomb) {
  std::vector<double> errors(grid.velocity.size(), 0.0);
  std::vector<double> difference(grid.velocity.size());
  for (const ReversalSmoothing& reversal_smoothing : open) {
    const std::vector<double> signs = DirectionBy(reversal_smoothing, grid, 0.0);
    for (std::size_t i = 0; i < signs.size(); ++i) difference[i] = signs[i] - grid.direction[i];
    for (const MotionGrid::Segment& segment : grid.segments) {
      for (std::size_t i = segment.low_pass.reach; i + segment.low_pass.reach < segment.count; ++i) {
        double& error = errors[segment.first + i];
        error = std::max(error, coulomb * std::abs(segment.low_pass.At(difference, segment.first + i)));
      }
    }
  }
  return errors;
}

// Standard error of the inertia, of the nominal model alone.
double InertiaError(const MotionGrid& grid) {
  const Eigen::Map<const Eigen::VectorXd> measured(grid.measured.data(), grid.nominal.rows());
  const Eigen::MatrixXd nominal = grid.Weighted(grid.nominal);
  const double left = (grid.Weighted(measured) - nominal * grid.prefit).squaredNorm() /
                      std::accumulate(grid.weights.begin(), grid.weights.end(), 0.0);
  const Eigen::MatrixXd others = nominal.rightCols(nominal.cols() - 1);
  const Eigen::VectorXd acceleration = nominal.col(0);
  const double own = (acceleration - others * LeastSquares(others, acceleration)).squaredNorm();
  return std::sqrt(left / std::max(own, 1e-300));
}

}  // namespace

std::size_t MotionGrid::Reversals() const {
  std::size_t reversals = 0;
  double last = 0.0;
  const double certain = 0.05 * QuantileOfMagnitude(velocity, 0.95);
  for (const double now : velocity) {
    if (std::abs(now) < certain) continue;
    if (last * now < 0.0) ++reversals;
    last = now;
  }
  return reversals;
}

Eigen::VectorXd MotionGrid::Project(std::span<const double> points) const {
  Eigen::VectorXd values(static_cast<Index>(rows()));
  for (std::size_t row = 0; row < rows(); ++row) {
    values(static_cast<Index>(row)) =
        LowPassAt(segments[segment_of_row[row]], point_of_row[row]).At(points, point_of_row[row]);
  }
  return values;
}

void MotionGrid::AddProjected(std::span<const double> points, std::size_t first, std::size_t last,
                              Eigen::Ref<Eigen::VectorXd> values) const {
  if (first >= last) return;
  const auto after = std::ranges::upper_bound(segments, first, {}, &Segment::first);
  const std::size_t reach = std::max(std::prev(after)->low_pass.reach, std::prev(after)->wide_low_pass.reach);
  auto row = std::ranges::lower_bound(point_of_row, first > reach ? first - reach : 0);
  for (; row != point_of_row.end() && *row < last + reach; ++row) {
    const auto at = static_cast<std::size_t>(row - point_of_row.begin());
    if (segment_of_row[at] == static_cast<std::size_t>(std::prev(after) - segments.begin())) {
      values(static_cast<Index>(at)) += LowPassAt(*std::prev(after), *row).At(points, *row);
    }
  }
}

Eigen::VectorXd MotionGrid::ProjectPassed(std::span<const double> points) const {
  Eigen::VectorXd values(static_cast<Index>(rows()));
  for (std::size_t row = 0; row < rows(); ++row) {
    const std::size_t point = point_of_row[row];
    values(static_cast<Index>(row)) =
        wide[point] ? segments[segment_of_row[row]].wide_low_pass.At(points, point) : points[point];
  }
  return values;
}

std::vector<double> MotionGrid::Later(std::span<const double> passed_points, double shift_s) const {
  std::vector<double> later(passed_points.size());
  for (const Segment& segment : segments) {
    const auto last = static_cast<std::ptrdiff_t>(segment.count) - 1;
    const auto value = [&](std::ptrdiff_t k) {
      return passed_points[segment.first + static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
    };
    const double shift = shift_s / segment.step_s;
    const double whole = std::floor(shift);
    const double u = shift - whole;
    for (std::ptrdiff_t i = 0; i <= last; ++i) {
      // Cubic through four neighbours: what has passed the low-pass is smooth at the points' step.
      const std::ptrdiff_t k = i + static_cast<std::ptrdiff_t>(whole);
      const double a = value(k - 1);
      const double b = value(k);
      const double c = value(k + 1);
      const double d = value(k + 2);
      later[segment.first + static_cast<std::size_t>(i)] =
          -u * (u - 1.0) * (u - 2.0) / 6.0 * a + (u * u - 1.0) * (u - 2.0) / 2.0 * b -
          u * (u + 1.0) * (u - 2.0) / 2.0 * c + u * (u * u - 1.0) / 6.0 * d;
    }
  }
  return later;
}

PathPoints PathLater(const MotionGrid& grid, double shift_s) {
  return {grid.Later(grid.position, shift_s), grid.Later(grid.velocity, shift_s),
          grid.Later(grid.passed_acceleration, shift_s)};
}

Eigen::MatrixXd UsualEffects(const MotionGrid& grid) {
  return UsualEffects(grid, {grid.position, grid.velocity, grid.passed_acceleration});
}

Eigen::MatrixXd UsualEffects(const MotionGrid& grid, const PathPoints& path) {
  Eigen::MatrixXd usual(grid.nominal.rows(), grid.linear ? 5 : 7);
  const double middle_s = 0.5 * (grid.time_s.front() + grid.time_s.back());
  std::vector<double> points(grid.time_s.size());
  for (Index column = 0; column < usual.cols(); ++column) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double v = path.velocity[i];
      const double s = v > 0.0 ? 1.0 : -1.0;
      const double t = grid.time_s[i] - middle_s;
      const double all[] = {std::abs(v),
                            v * v * s,
                            s * std::abs(path.passed_acceleration[i]),
                            t * v,
                            t * s,
                            std::cos(path.position[i]),
                            std::sin(path.position[i])};
      points[i] = all[column];
    }
    usual.col(column) = grid.Project(points);
  }
  return usual;
}

Eigen::MatrixXd MotionGrid::Weighted(const Eigen::MatrixXd& columns) const {
  const Eigen::Map<const Eigen::ArrayXd> all(weights.data(), static_cast<Index>(weights.size()));
  return all.sqrt().matrix().asDiagonal() * columns;
}

Eigen::MatrixXd MotionGrid::BesideNominal(const Eigen::MatrixXd& columns) const {
  return columns - nominal_basis * (nominal_basis.transpose() * columns).eval();
}

MotionGrid MakeMotionGrid(const MotionSamples& samples, const MotionBandwidth& bandwidth,
                          double expected_delay_s, double reversal_smoothing_delay_s) {
  MotionGrid grid;
  grid.linear = samples.linear;
  grid.sigma_s = bandwidth.sigma_s;
  grid.path_sigma_s = bandwidth.path_sigma_s;
  grid.velocity_noise = bandwidth.velocity_noise;
  grid.position_noise = samples.position_noise;
  std::vector<PointLayout> layouts;
  for (const EvenSegment& raw : samples.segments) {
    PointLayout layout;
    layout.margin = std::max(MakeKernel(bandwidth.path_sigma_s, raw.step_s, 0).reach,
                             MakeKernel(bandwidth.sigma_s, raw.step_s, 0).reach);
    layout.stride = std::max<std::size_t>(
        1, static_cast<std::size_t>(bandwidth.sigma_s / (kPointsPerSigma * raw.step_s)));
    layouts.push_back(layout);
    if (raw.resampled) {
      grid.reversal_error_s = std::max(grid.reversal_error_s, raw.step_s / std::sqrt(12.0));
    }
    MotionGrid::Segment segment;
    segment.record = raw.record;
    segment.first = grid.time_s.size();
    segment.step_s = raw.step_s * static_cast<double>(layout.stride);
    segment.low_pass = bandwidth.passes_all ? PassAll() : MakeKernel(bandwidth.sigma_s, segment.step_s, 0);
    segment.wide_low_pass = segment.low_pass;
    AddPoints(raw, bandwidth, layout, grid);
    segment.count = grid.time_s.size() - segment.first;
    grid.segments.push_back(std::move(segment));
  }
  if (grid.temperature_degC.size() != grid.time_s.size()) grid.temperature_degC.clear();

  const double step_s = samples.segments.front().step_s;
  const auto gain = [&](int derivative) {
    if (derivative == 0 && bandwidth.passes_all) return 1.0;
    return NoiseGain(
        MakeKernel(derivative == 0 ? bandwidth.sigma_s : bandwidth.path_sigma_s, step_s, derivative));
  };
  grid.filtered_out_variance = (1.0 - gain(0) * gain(0)) * samples.torque_noise * samples.torque_noise;
  grid.acceleration_noise =
      bandwidth.by_velocity ? gain(1) * samples.velocity_noise : gain(2) * samples.position_noise;
  grid.noise_of_acceleration = CalmAcceleration(samples, bandwidth, layouts, grid);
  grid.acceleration_noise = QuantileOfMagnitude(grid.noise_of_acceleration, 0.5);
  grid.noise_floor = std::hypot(gain(0) * samples.torque_noise, bandwidth.inertia * grid.acceleration_noise);
  grid.last_band = LastBand(samples, bandwidth, layouts, grid);
  grid.acceleration_error = AddAccelerationTransients(samples, bandwidth, layouts, grid);
  WidenRowsAroundAccelerationTransients(bandwidth.inertia, grid);
  // First with the rows beside reversals, which tell over which speed friction turns round; then without
  // those of which they do not.
  FillRows(samples, layouts, bandwidth, expected_delay_s, std::vector<double>(grid.time_s.size(), 0.0), grid);
  const std::vector<ReversalSmoothing> open =
      ChooseReversalSmoothing(grid, grid.ProjectPassed(grid.passed_torque), reversal_smoothing_delay_s);
  FillRows(samples, layouts, bandwidth, expected_delay_s,
           ReversalSmoothingErrors(grid, open, bandwidth.coulomb), grid);
  const Eigen::VectorXd torque = grid.ProjectPassed(grid.passed_torque);
  ChooseReversalSmoothing(grid, torque, reversal_smoothing_delay_s);
  const auto rows = static_cast<Index>(grid.rows());
  grid.measured.assign(torque.data(), torque.data() + rows);
  grid.prefit = LeastSquares(grid.Weighted(grid.nominal), grid.Weighted(torque));
  grid.inertia_error = InertiaError(grid);
  if (std::abs(grid.prefit(0)) < kUnknownInertia * grid.inertia_error) {
    // What is left of the acceleration is noise: a number for it would only grow large where it is not
    // fitted.
    grid.nominal.col(0).setZero();
    grid.prefit = ShortestLeastSquares(grid.Weighted(grid.nominal), grid.Weighted(torque));
  }
  grid.nominal_basis = OrthonormalBasis(grid.nominal);
  return grid;
}

}  // namespace strainwave::analysis::diagnosis
