// SPDX-License-Identifier: Apache-2.0
#include "analysis/samples/wraps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace strainwave::analysis::samples {
namespace {

// Of the modulus: noise at the zero reaches beyond it.
constexpr double kBeyond = 1.002;

double WrappedStep(double step, double modulus) { return step - modulus * std::round(step / modulus); }

bool IsReturn(const std::vector<bool>& returns, std::size_t i) { return !returns.empty() && returns[i]; }

// The jumps by more than half a modulus, if each leaves a step like those beside it once it is taken off.
std::vector<std::size_t> JumpsBy(double modulus, std::span<const double> values,
                                 const std::vector<bool>& returns) {
  constexpr std::size_t kBeside = 4;
  constexpr double kLikeBeside = 3.0;
  constexpr double kOfModulus = 1e-3;
  std::vector<std::size_t> rows;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (std::abs(step) <= 0.5 * modulus || IsReturn(returns, i)) continue;
    // A single bad sample jumps to and fro: its steps say nothing of the way. Where all jump, they do.
    double beside = 0.0;
    double beside_all = 0.0;
    bool any = false;
    for (std::size_t k = i > kBeside ? i - kBeside : 1; k <= i + kBeside && k < values.size(); ++k) {
      if (k == i || IsReturn(returns, k)) continue;
      const double step_beside = values[k] - values[k - 1];
      const double left = std::abs(WrappedStep(step_beside, modulus));
      beside_all = std::max(beside_all, left);
      if (std::abs(step_beside) > 0.5 * modulus) continue;
      beside = std::max(beside, left);
      any = true;
    }
    if (!any) beside = beside_all;
    if (std::abs(WrappedStep(step, modulus)) > kLikeBeside * beside + kOfModulus * modulus) return {};
    rows.push_back(i);
  }
  return rows;
}

}  // namespace

std::optional<Wraps> FindWraps(std::span<const double> values, double turn,
                               const std::vector<bool>& returns) {
  if (values.size() < 3) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const double span = *high - *low;
  std::vector<double> moduli;
  for (const double part : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 18.0, 20.0, 24.0, 36.0}) {
    moduli.push_back(turn / part);
    moduli.push_back(turn * part);
  }
  for (double turns = 32.0; turns <= 65536.0; turns *= 2.0) moduli.push_back(turn * turns);
  std::sort(moduli.begin(), moduli.end());
  for (const double modulus : moduli) {
    if (span > kBeyond * modulus || span <= 0.5 * modulus) continue;
    std::vector<std::size_t> rows = JumpsBy(modulus, values, returns);
    if (!rows.empty()) return Wraps{modulus, std::move(rows)};
  }
  return std::nullopt;
}

double UsualStep(std::span<const double> values, const Wraps& wraps) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i)
    steps.push_back(std::abs(WrappedStep(values[i] - values[i - 1], wraps.modulus)) / wraps.modulus);
  const auto quantile = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() * 19 / 20);
  std::nth_element(steps.begin(), quantile, steps.end());
  return *quantile;
}

void Unwrap(std::span<double> values, double modulus, const std::vector<bool>& returns) {
  double offset = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] + offset - values[i - 1];
    if (!IsReturn(returns, i)) offset += WrappedStep(step, modulus) - step;
    values[i] += offset;
  }
}

double UnwrapAlong(std::span<double> values, double modulus, std::span<const double> expected_steps) {
  double before = values.empty() ? 0.0 : values.front();
  double furthest = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double step = values[i] - before;
    before = values[i];
    const double off = WrappedStep(step - expected_steps[i], modulus);
    furthest = std::max(furthest, std::abs(off) / modulus);
    values[i] = values[i - 1] + expected_steps[i] + off;
  }
  return furthest;
}

}  // namespace strainwave::analysis::samples
