// SPDX-License-Identifier: Apache-2.0
#include "bench/controller/encoder_skew.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace strainwave::bench {
namespace {

constexpr std::size_t kFewestMoves = 8;
constexpr double kLeastEigenvalue = 1e-9;

}  // namespace

void EncoderSkew::BeginMove(double direction) noexcept {
  direction_ = direction;
  in_move_ = 0;
  ++moves_;
}

void EncoderSkew::Add(const AlignedSample& sample) noexcept {
  if (in_move_ > 0 && sample.time <= last_[1].time) return;  // nothing new came in
  if (in_move_ >= 2) Take(last_[0], last_[1], sample);
  last_ = {last_[1], sample};
  ++in_move_;
}

void EncoderSkew::Take(const AlignedSample& before, const AlignedSample& at,
                       const AlignedSample& after) noexcept {
  const double difference_rad = at.input_angle_rad / ratio_ - at.output_angle_rad;
  if (!begun_) first_rad_ = difference_rad;
  begun_ = true;
  using Seconds = std::chrono::duration<double>;
  const double to_s = Seconds(at.time - before.time).count();
  const double from_s = Seconds(after.time - at.time).count();
  const double speed_to = (at.output_angle_rad - before.output_angle_rad) / to_s;
  const double speed_from = (after.output_angle_rad - at.output_angle_rad) / from_s;
  const double input_rad = at.input_angle_rad;
  const double output_rad = at.output_angle_rad;
  const std::array<double, kUnknowns> row{(speed_to * to_s + speed_from * from_s) / (to_s + from_s),
                                          (speed_from - speed_to) / (0.5 * (to_s + from_s)),
                                          at.output_torque_Nm,
                                          direction_,
                                          1.0,
                                          std::cos(input_rad),
                                          std::sin(input_rad),
                                          std::cos(2.0 * input_rad),
                                          std::sin(2.0 * input_rad),
                                          std::cos(output_rad),
                                          std::sin(output_rad),
                                          std::cos(2.0 * output_rad),
                                          std::sin(2.0 * output_rad)};
  const double value = difference_rad - first_rad_;
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t j = 0; j < kUnknowns; ++j) normal_[kUnknowns * i + j] += row[i] * row[j];
    right_[i] += row[i] * value;
  }
  squares_ += value * value;
  speeds_rad_per_s_ += std::abs(row[0]);
  ++count_;
}

std::optional<daq::acquisition::Skew> EncoderSkew::Estimate() const {
  if (moves_ < kFewestMoves || count_ <= 2 * kUnknowns) return std::nullopt;
  constexpr auto kSize = static_cast<Eigen::Index>(kUnknowns);
  using Matrix = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;
  const Eigen::Map<const Matrix> normal(normal_.data());
  const Eigen::Map<const Vector> right(right_.data());
  const Vector scale = normal.diagonal().cwiseSqrt();
  if (!(scale.minCoeff() > 0.0)) return std::nullopt;
  const Matrix scaled = scale.cwiseInverse().asDiagonal() * normal * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scaled);
  if (!(eigen.eigenvalues()(0) > kLeastEigenvalue)) return std::nullopt;
  const Matrix inverse = scaled.inverse();
  const Vector x = (inverse * right.cwiseQuotient(scale)).cwiseQuotient(scale);
  const double left = std::max(0.0, squares_ - x.dot(right));
  const auto count = static_cast<double>(count_);
  // As many readings as carry the estimate: those at rest do not.
  const double moving = speeds_rad_per_s_ * speeds_rad_per_s_ / normal_[0];
  const double in_a_move = std::max(1.0, moving / static_cast<double>(moves_));
  const double variance = left / (count - static_cast<double>(kUnknowns)) * in_a_move;
  return daq::acquisition::Skew{-x(0), std::sqrt(variance * inverse(0, 0)) / scale(0)};
}

}  // namespace strainwave::bench
