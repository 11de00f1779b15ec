// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/joint_records.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "analysis/joint_dynamics/savitzky_golay.h"
#include "bench/errors/bench_error.h"
#include "daq/joint_columns.h"
#include "daq/read_records.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
using daq::JointQuantity;

// The middle of all steps; the first and the last time would take a gap for a lower rate.
double StepOf(const std::filesystem::path& path, std::span<const double> time_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  if (steps.empty()) Refuse(path, "has one sample", "two windows of the filter or more");
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  if (!(*middle > 0.0)) Refuse(path, "its time stands still", "time_s that goes on evenly");
  return *middle;
}

int WindowOf(const std::filesystem::path& path, const Smoothing& smoothing, double rate_hz,
             std::vector<std::string>& warnings) {
  const double samples = smoothing.window_s * rate_hz;
  const auto nearest = static_cast<int>(std::lround(std::min(samples, 1e6)));
  if (smoothing.as_given && nearest % 2 == 0)
    Refuse(
        path,
        fmt::format("a window of {:g} s is {} samples at {:g} Hz", smoothing.window_s, nearest, rate_hz),
        fmt::format("an odd number, so that it has a middle, for instance {:g} s", (nearest + 1) / rate_hz));
  const int least = smoothing.order + 1 + smoothing.order % 2;  // odd, above the order
  if (smoothing.as_given && nearest < least)
    Refuse(path,
           fmt::format("a window of {:g} s is {} samples at {:g} Hz", smoothing.window_s, nearest, rate_hz),
           fmt::format("{} or more for a polynomial of order {}", least, smoothing.order));
  if (smoothing.as_given) return nearest;
  const int odd = 2 * static_cast<int>(std::floor(std::min(samples, 1e6) / 2.0)) + 1;
  if (odd >= least) return odd;
  warnings.push_back(fmt::format("at {:g} Hz a window of {:g} s has {} samples; {} were taken", rate_hz,
                                 smoothing.window_s, odd, least));
  return least;
}

// Where times are uneven, a gap or a jitter becomes a wrong acceleration.
void JudgeTimes(std::span<const double> time_s, double step_s, std::vector<std::string>& warnings) {
  std::size_t uneven = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i)
    uneven += std::abs(time_s[i] - time_s[i - 1] - step_s) > 0.5 * step_s ? 1 : 0;
  if (uneven > 0)
    warnings.push_back(
        fmt::format("{} of {} steps of time_s differ from {:g} s by more than half of it; the filter "
                    "takes all as even",
                    uneven, time_s.size() - 1, step_s));
}

dynamics::JointMotion MotionBy(const dynamics::SavitzkyGolay& filter, const daq::Record& record,
                               double step_s, bool measured) {
  const std::size_t joints = daq::JointCount(record);
  const auto columns = static_cast<Eigen::Index>(joints);
  const auto rows = static_cast<Eigen::Index>(record.rows());
  dynamics::JointMotion motion{Eigen::MatrixXd(rows, 3 * columns), Eigen::MatrixXd(rows, columns)};
  const auto into = [&](Eigen::MatrixXd& matrix, Eigen::Index column, const std::vector<double>& values) {
    matrix.col(column) = Eigen::Map<const Eigen::VectorXd>(values.data(), rows);
  };
  for (std::size_t j = 0; j < joints; ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const auto series = [&](JointQuantity quantity) {
      return record.CopyAsDoubles(daq::JointColumnName(quantity, j + 1));
    };
    const std::vector<double> velocity = series(JointQuantity::kVelocity);
    into(motion.states, column, dynamics::Smoothed(filter, series(JointQuantity::kPosition)));
    into(motion.states, columns + column, dynamics::Smoothed(filter, velocity));
    into(motion.states, 2 * columns + column,
         measured ? dynamics::Smoothed(filter, series(JointQuantity::kAcceleration))
                  : dynamics::Derivative(filter, velocity, step_s));
    into(motion.torques_Nm, column, dynamics::Smoothed(filter, series(JointQuantity::kTorque)));
  }
  return motion;
}

bool HasAcceleration(const daq::Record& record) {
  return record.FindColumn(daq::JointColumnName(JointQuantity::kAcceleration, 1)) != nullptr;
}

}  // namespace

JointFile ReadJointFile(const std::filesystem::path& path, const Smoothing& smoothing,
                        Acceleration acceleration) {
  const std::vector<daq::Record> records = daq::ReadRecords(path);
  JointFile file;
  file.path = path;
  std::vector<dynamics::JointMotion> motions;
  for (const daq::Record& record : records) {
    if (record.kind != daq::RecordKind::kJoints)
      Refuse(path, fmt::format("is a record of kind {}", record.kind.name()), "kind: joints");
    for (const daq::RecordNote& note : record.notes) file.warnings.push_back(note.text);
    const std::vector<double> time_s = record.CopyAsDoubles("time_s");
    const double step_s = StepOf(path, time_s);
    // Times with few digits: 1/0.001 is no whole number of Hz.
    const double rate_hz = std::round(1e6 / step_s) / 1e6;
    if (!motions.empty() && std::abs(rate_hz - file.sample_rate_hz) > 0.01 * file.sample_rate_hz)
      Refuse(path, fmt::format("has records at {:g} and {:g} Hz", file.sample_rate_hz, rate_hz),
             "one rate within a file");
    file.sample_rate_hz = rate_hz;
    JudgeTimes(time_s, step_s, file.warnings);
    file.window = WindowOf(path, smoothing, rate_hz, file.warnings);
    if (record.rows() < 2 * static_cast<std::size_t>(file.window))
      Refuse(path,
             fmt::format("{} samples, less than two windows of {} ({:g} s at {:g} Hz)", record.rows(),
                         file.window, file.window / rate_hz, rate_hz),
             fmt::format("{} or more, or a shorter --window", 2 * file.window));
    const dynamics::SavitzkyGolay filter = dynamics::MakeSavitzkyGolay(file.window, smoothing.order);
    file.half_power_hz = dynamics::HalfPowerFrequency(filter) * rate_hz;
    file.acceleration_measured = acceleration == Acceleration::kAsThere && HasAcceleration(record);
    motions.push_back(MotionBy(filter, record, step_s, file.acceleration_measured));
    const double duration_s = static_cast<double>(record.rows()) / rate_hz;
    file.duration_s = motions.size() == 1 ? duration_s : std::min(file.duration_s, duration_s);
    if (motions.back().joints() != motions.front().joints())
      Refuse(
          path,
          fmt::format("has records of {} and {} joints", motions.front().joints(), motions.back().joints()),
          "the same joints in all");
  }
  if (motions.empty()) Refuse(path, "holds no record", "one of kind joints");
  file.motion = motions.size() == 1 ? std::move(motions.front()) : dynamics::Stacked(motions);
  return file;
}

dynamics::JointMotion SmoothedMotion(const daq::Record& record, const Smoothing& smoothing,
                                     double sample_rate_hz, Acceleration acceleration) {
  std::vector<std::string> warnings;
  const int window = WindowOf({}, {smoothing.window_s, smoothing.order, false}, sample_rate_hz, warnings);
  if (record.rows() < static_cast<std::size_t>(window))
    throw std::invalid_argument(fmt::format("{} samples, less than a window of {}", record.rows(), window));
  return MotionBy(dynamics::MakeSavitzkyGolay(window, smoothing.order), record, 1.0 / sample_rate_hz,
                  acceleration == Acceleration::kAsThere && HasAcceleration(record));
}

}  // namespace strainwave::bench
