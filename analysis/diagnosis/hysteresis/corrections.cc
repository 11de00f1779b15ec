// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/hysteresis/correction.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Legendre polynomials of the torque over its peak, the same on both branches or turned with the direction.
class TorquePolynomial final : public NuisanceTerm {
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
    // By powers, worked out once: fits spend their time here.
    const Powers sum = SumOfPowers(v);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double x = std::clamp(grid.torque_Nm[i] / peak_Nm_, -1.0, 1.0);
      double value = 0.0;
      for (std::size_t power = sum.size(); power-- > 0;) value = value * x + sum[power];
      total_rad(static_cast<Eigen::Index>(i)) +=
          RadFromArcmin(by_branch_ ? grid.direction[i] * value : value);
    }
  }

  std::vector<std::vector<double>> Starts(const LoopResidual&) const override {
    return {std::vector<double>(kOrders, 0.0)};
  }

 private:
  static constexpr int kOrders = 6;
  using Powers = std::array<double, kOrders + 2>;  // of the torque, from 0

  // Of the polynomials, each by its number, with (n + 1) Pₙ₊₁ = (2n + 1) x Pₙ − n Pₙ₋₁.
  Powers SumOfPowers(std::span<const double> v) const {
    Powers before{1.0};
    Powers now{0.0, 1.0};
    Powers sum{first_order_ == 0 ? v[0] : 0.0};
    for (int order = 1; order < first_order_ + kOrders; ++order) {
      Powers next{};
      for (std::size_t power = 0; power < sum.size(); ++power) {
        if (order >= first_order_)
          sum[power] += v[static_cast<std::size_t>(order - first_order_)] * now[power];
        const double raised = power > 0 ? now[power - 1] : 0.0;
        next[power] = ((2.0 * order + 1.0) * raised - order * before[power]) / (order + 1.0);
      }
      before = now;
      now = next;
    }
    return sum;
  }

  double peak_Nm_;
  bool by_branch_;
  int first_order_;
};

enum class Over { kAngle, kTime, kTorque };

// Of squares. A ripple in the torque that the teeth make is as large in the twist as the spring is soft
// there: a line of one height leaves some hundredths of it where the stiffness doubles.
constexpr double kRippleMisfit = 0.06;

// What a line is counted over, and the words for it.
struct Abscissa {
  const char* name;
  const char* sentence;
  const char* frequency;
  const char* unit;
  double fewest_periods;  // slower than that it would stand in for any smooth shape
  double per_number;      // radians of phase a unit of the abscissa, at a frequency of 1
};

Abscissa AbscissaOf(Over over) {
  switch (over) {
    case Over::kTime:
      return {"line over time",
              "what is left goes up and down at one frequency: the building, a fan, a control loop",
              "frequency_Hz",
              "Hz",
              3.0,
              kTwoPi};
    case Over::kTorque:
      return {"line over torque",
              "what is left goes up and down with the torque",
              "periods_per_Nm",
              "1/Nm",
              4.0,
              kTwoPi};
    case Over::kAngle:
      break;
  }
  return {"line over output angle",
          "what is left repeats over the output angle: graduation of the encoder, teeth",
          "order_per_output_turn",
          "1",
          4.0,
          1.0};
}

// Numbers: cosine, sine, frequency.
class Line final : public NuisanceTerm {
 public:
  Line(const LoopRecords& records, Over over) : over_(over), abscissa_(AbscissaOf(over)) {
    const double most = ArcminFromRad(records.twist_range_rad);
    const double span = over == Over::kTime     ? records.duration_s
                        : over == Over::kTorque ? 2.0 * records.peak_torque_Nm
                                                : records.twist_range_rad / kTwoPi;
    lowest_ = abscissa_.fewest_periods / span;
    const auto records_there = static_cast<double>(records.samples.records());
    const double samples = static_cast<double>(records.samples.size()) / records_there;
    // Faster than a few samples a period it cannot be told from noise, nor where the noise of the position is
    // a part of the period.
    double fastest = over == Over::kTime ? 0.4 / records.step_s : 0.2 * samples / records.passes() / span;
    if (over == Over::kAngle) fastest = std::min(fastest, 0.3 / std::max(records.position_noise_rad, 1e-12));
    highest_ = std::max(2.0 * lowest_, std::min(fastest, 2000.0 / span));
    needs_all_samples = true;
    Number("cosine_arcmin", "arcmin", {-most, most, 1e-6 * most, false, true});
    Number("sine_arcmin", "arcmin", {-most, most, 1e-6 * most, false, true});
    Number(abscissa_.frequency, abscissa_.unit, {lowest_, highest_, 1e-4 / span, false, false});
    rule = {.name = abscissa_.name,
            .sentence = abscissa_.sentence,
            .degrees_of_freedom = 3,
            .location_parameters = 1,
            .trials_factor = (highest_ - lowest_) * span,
            .named = false};
    if (over == Over::kAngle) rule.misfit_share = kRippleMisfit;
  }

  void Add(std::span<const double> v, const LoopGrid& grid, const Eigen::VectorXd&,
           Eigen::VectorXd& total_rad) const override {
    const std::vector<double>& abscissa = AbscissaIn(grid);
    const double per_abscissa = abscissa_.per_number * v[2];
    // One sine a sample, not two functions: fits spend their time here.
    const double height = RadFromArcmin(std::hypot(v[0], v[1]));
    const double first = std::atan2(v[0], v[1]);
    for (std::size_t i = 0; i < grid.size(); ++i)
      total_rad(static_cast<Eigen::Index>(i)) += height * std::sin(per_abscissa * abscissa[i] + first);
  }

  double LogSearchLocations(std::span<const double> v) const override {
    return LogSearchLocationsOfLine(v[2], lowest_, highest_);
  }

  std::vector<std::vector<double>> Starts(const LoopResidual& residual) const override {
    const LoopGrid& grid = residual.grid;
    const double per_number = abscissa_.per_number;
    std::vector<std::vector<double>> starts;
    for (const LinePeak& peak : FindLines(AbscissaIn(grid), residual.residual_rad, grid.weight,
                                          lowest_ * per_number, highest_ * per_number, 3)) {
      starts.push_back({0.0, 0.0, std::clamp(peak.order / per_number, lowest_, highest_)});
    }
    return starts;
  }

 private:
  const std::vector<double>& AbscissaIn(const LoopGrid& grid) const {
    return over_ == Over::kTime ? grid.time_s : over_ == Over::kTorque ? grid.torque_Nm : grid.position_rad;
  }

  Over over_;
  Abscissa abscissa_;
  double lowest_{};
  double highest_{};
};

}  // namespace

void AppendNuisanceTerms(const LoopRecords& records, LoopEffects& effects) {
  AppendKneeNuisanceTerm(records, effects);
  effects.push_back(std::make_unique<TorquePolynomial>(records, false));
  effects.push_back(std::make_unique<TorquePolynomial>(records, true));
  for (const Over over : {Over::kAngle, Over::kTime, Over::kTorque}) {
    effects.push_back(std::make_unique<Line>(records, over));
  }
  AppendPositionNuisanceTerms(records, effects);
  AppendTimeNuisanceTerms(records, effects);
}

}  // namespace strainwave::analysis::diagnosis
