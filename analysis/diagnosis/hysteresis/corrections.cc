// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/hysteresis/correction.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Legendre polynomials of the torque over its peak, the same on both branches or turned with the direction.
class TorquePolynomial final : public Correction {
 public:
  TorquePolynomial(const LoopRecords& records, bool by_branch)
      : peak_Nm_(records.peak_torque_Nm), by_branch_(by_branch), first_order_(by_branch ? 0 : 2) {
    const double most = ArcminFromRad(records.twist_range_rad);
    for (int order = first_order_; order < first_order_ + kOrders; ++order) {
      Number(fmt::format("torque_order_{}_arcmin", order), "arcmin", {-most, most, 1e-6 * most, false, true});
    }
    rule = {.name = by_branch ? "smooth function of torque by branch" : "smooth function of torque",
            .sentence =
                by_branch
                    ? "what is left is a smooth function of the torque that turns its sign with the direction"
                    : "what is left is a smooth function of the torque",
            .degrees_of_freedom = kOrders,
            .named = false};
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double x = std::clamp(grid.torque_Nm[i] / peak_Nm_, -1.0, 1.0);
      double before = 1.0;
      double value = x;
      double sum = first_order_ == 0 ? v[0] : 0.0;
      for (int order = 1; order < first_order_ + kOrders; ++order) {
        if (order >= first_order_) sum += v[static_cast<std::size_t>(order - first_order_)] * value;
        const double next = ((2.0 * order + 1.0) * x * value - order * before) / (order + 1.0);
        before = value;
        value = next;
      }
      total_rad(static_cast<Eigen::Index>(i)) += RadFromArcmin(by_branch_ ? grid.direction[i] * sum : sum);
    }
  }

  std::vector<std::vector<double>> Starts(const LoopRemainder&) const override {
    return {std::vector<double>(kOrders, 0.0)};
  }

 private:
  static constexpr int kOrders = 6;
  double peak_Nm_;
  bool by_branch_;
  int first_order_;
};

// A line over output angle or time. Numbers: cosine, sine, order per output turn or frequency in Hz.
class Line final : public Correction {
 public:
  Line(const LoopRecords& records, bool over_time) : over_time_(over_time) {
    const double most = ArcminFromRad(records.twist_range_rad);
    const double span = over_time ? records.duration_s : records.twist_range_rad / kTwoPi;
    // Slower than a few periods a record it would stand in for any smooth shape; faster than a few samples a
    // period it cannot be told from noise, nor where the noise of the place is a part of the period.
    lowest_ = (over_time ? 3.0 : 4.0) / span;
    const auto records_there = static_cast<double>(records.samples.records());
    const double samples = static_cast<double>(records.samples.size()) / records_there;
    const double passes = static_cast<double>(records.branches.size() - 1) / records_there;
    const double noise_rad = std::max(records.noise_floor_rad, 1e-12);
    const double fastest =
        over_time ? 0.4 / records.step_s : std::min(0.2 * samples / passes / span, 0.15 / noise_rad);
    highest_ = std::max(2.0 * lowest_, std::min(fastest, 2000.0 / span));
    needs_all_samples = true;
    Number("cosine_arcmin", "arcmin", {-most, most, 1e-6 * most, false, true});
    Number("sine_arcmin", "arcmin", {-most, most, 1e-6 * most, false, true});
    Number(over_time ? "frequency_Hz" : "order_per_output_turn", over_time ? "Hz" : "1",
           {lowest_, highest_, 1e-4 / span, false, false});
    rule = {.name = over_time ? "line over time" : "line over output angle",
            .sentence =
                over_time
                    ? "what is left goes up and down at one frequency: the building, a fan, a control loop"
                    : "what is left repeats over the output angle: graduation of the encoder, teeth",
            .degrees_of_freedom = 3,
            .trials = (highest_ - lowest_) * span,
            .named = false};
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    const std::vector<double>& place = over_time_ ? grid.time_s : grid.place_rad;
    const double per_place = over_time_ ? kTwoPi * v[2] : v[2];
    const double c = RadFromArcmin(v[0]);
    const double s = RadFromArcmin(v[1]);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double phase = per_place * place[i];
      total_rad(static_cast<Eigen::Index>(i)) += c * std::cos(phase) + s * std::sin(phase);
    }
  }

  std::vector<std::vector<double>> Starts(const LoopRemainder& remainder) const override {
    const LoopGrid& grid = remainder.grid;
    const double per_number = over_time_ ? kTwoPi : 1.0;
    std::vector<std::vector<double>> starts;
    for (const LinePeak& peak : FindLines(over_time_ ? grid.time_s : grid.place_rad, remainder.residual_rad,
                                          grid.weight, lowest_ * per_number, highest_ * per_number, 3)) {
      starts.push_back({0.0, 0.0, std::clamp(peak.order / per_number, lowest_, highest_)});
    }
    return starts;
  }

 private:
  bool over_time_;
  double lowest_{};
  double highest_{};
};

}  // namespace

void AppendCorrections(const LoopRecords& records, LoopEffects& effects) {
  effects.push_back(std::make_unique<TorquePolynomial>(records, false));
  effects.push_back(std::make_unique<TorquePolynomial>(records, true));
  effects.push_back(std::make_unique<Line>(records, false));
  effects.push_back(std::make_unique<Line>(records, true));
  AppendTimeCorrections(records, effects);
}

}  // namespace strainwave::analysis::diagnosis
