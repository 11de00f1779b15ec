// SPDX-License-Identifier: Apache-2.0
#include "analysis/transmission_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/angle_weights.h"
#include "analysis/noise_level.h"
#include "analysis/units.h"

namespace strainwave::analysis {
namespace {

// Orders nearer than this cannot be told apart over one revolution.
constexpr double kResolution = 0.5;
constexpr std::size_t kMaxFurtherLines = 24;

struct PlacedLine {
  double appears_at{};
  double order{};
  std::string name;
  bool seen_in_part{};  // at half the samples a turn
};

// Where along a turn the error was seen.
struct Sampling {
  double per_turn{};
  /// Whether the way is made in steps of one size, so that an order beyond half of them a turn cannot be told
  /// from the one that it folds to. With steps of several sizes it is only where it is.
  bool even{};
};

Sampling SamplingOf(std::span<const double> angle_rad) {
  // Of rows that come in time many may lie at one angle: beyond this the usual step counts, not the mean one.
  constexpr double kUneven = 1.5;  // usual step over mean step
  // A sweep from position to position repeats its steps to a few percent, and begins and ends with others; a
  // tenth of another size turns an order of twice the samples by more than half a period somewhere.
  constexpr double kOfUsual = 0.1;
  constexpr double kShareOfWay = 0.9;
  const double usual_rad = UsualStep(angle_rad);
  double way_rad = 0.0;
  double even_rad = 0.0;
  for (std::size_t i = 1; i < angle_rad.size(); ++i) {
    const double step_rad = std::abs(angle_rad[i] - angle_rad[i - 1]);
    way_rad += step_rad;
    if (std::abs(step_rad - usual_rad) <= kOfUsual * usual_rad) even_rad += step_rad;
  }
  const double travel_rad = std::abs(angle_rad.back() - angle_rad.front());
  const double mean_rad = travel_rad / static_cast<double>(angle_rad.size() - 1);
  return {kTwoPi / (usual_rad > kUneven * mean_rad ? usual_rad : mean_rad),
          even_rad >= kShareOfWay * way_rad};
}

// Candidates at the orders where they appear; those that appear at one order become one line.
std::vector<PlacedLine> PlaceCandidates(double ratio, const Sampling& sampling, OrderAnalysis* analysis) {
  const double samples_per_rev = sampling.per_turn;
  std::vector<PlacedLine> placed;
  std::vector<std::string>* notes = &analysis->notes;
  for (const OrderCandidate& candidate : KnownOrders(ratio)) {
    const double appears_at = sampling.even ? FoldedOrder(candidate.order, samples_per_rev) : candidate.order;
    const bool folded = std::abs(appears_at - candidate.order) > kResolution;
    if (folded) {
      notes->push_back(
          fmt::format("order {:.6g} ({}) appears at order {:.4g}: {:.4g} samples per output turn",
                      candidate.order, candidate.name, appears_at, samples_per_rev));
    }
    const bool is_second = candidate.order == 2.0 * std::abs(ratio);
    if (appears_at < kResolution) {
      notes->push_back(
          fmt::format("order {:.6g} ({}) cannot be told from a constant", candidate.order, candidate.name));
      if (is_second) analysis->second_harmonic_hidden = notes->back();
      continue;
    }
    const bool in_part = sampling.even && 0.5 * samples_per_rev - appears_at < kResolution;
    if (in_part) {
      notes->push_back(
          fmt::format("order {:.6g} ({}) is half of {:.4g} samples per output turn: how much of it "
                      "is seen hangs on its phase",
                      candidate.order, candidate.name, samples_per_rev));
      if (is_second) analysis->second_harmonic_hidden = notes->back();
    }
    const auto same = std::find_if(placed.begin(), placed.end(), [&](const PlacedLine& line) {
      return std::abs(line.appears_at - appears_at) < kResolution;
    });
    if (same == placed.end()) {
      placed.push_back({appears_at, candidate.order, candidate.name, in_part});
    } else {
      notes->push_back(fmt::format("orders {:.6g} ({}) and {:.6g} ({}) appear at one order, {:.4g}",
                                   same->order, same->name, candidate.order, candidate.name, appears_at));
      same->name += " or " + candidate.name;
    }
  }
  return placed;
}

// Integer orders that stand out of the noise. The floor comes from the median over all orders, so that lines
// do not raise it: the squared amplitude of white noise is exponentially distributed.
void AddFurtherLines(std::span<const double> angle_rad, std::span<const double> residuals,
                     double samples_per_rev, std::size_t max_lines, std::vector<PlacedLine>* placed) {
  std::vector<double> spectrum = IntegerOrderSpectrum(angle_rad, residuals);
  // Beyond half of the samples a turn each order is another one's alias.
  spectrum.resize(std::min(spectrum.size(), static_cast<std::size_t>(0.5 * samples_per_rev + 1.0) + 1));
  std::vector<double> powers;
  for (std::size_t order = 1; order < spectrum.size(); ++order) {
    powers.push_back(spectrum[order] * spectrum[order]);
  }
  const double mean_power = Median(powers) / std::log(2.0);
  constexpr double kFalseLinesPerRecord = 0.01;
  const double stands_out = mean_power * std::log(static_cast<double>(powers.size()) / kFalseLinesPerRecord);
  std::vector<std::size_t> strongest;
  for (std::size_t i = 0; i < powers.size(); ++i) {
    if (powers[i] > stands_out) {
      strongest.push_back(i);
    }
  }
  std::stable_sort(strongest.begin(), strongest.end(),
                   [&](std::size_t a, std::size_t b) { return powers[a] > powers[b]; });
  for (std::size_t i : strongest) {
    const auto order = static_cast<double>(i + 1);
    const bool taken = std::any_of(placed->begin(), placed->end(), [&](const PlacedLine& line) {
      return std::abs(line.appears_at - order) < kResolution;
    });
    if (!taken && placed->size() < max_lines) {
      placed->push_back({order, order, "", false});
    }
  }
}

std::vector<double> Orders(const std::vector<PlacedLine>& placed) {
  std::vector<double> orders;
  for (const PlacedLine& line : placed) {
    orders.push_back(line.appears_at);
  }
  return orders;
}

}  // namespace

std::vector<OrderCandidate> KnownOrders(double ratio) {
  const double size = std::abs(ratio);
  return {{1.0, "output, once per turn (eccentricity)"}, {2.0, "output, twice per turn (ovality)"},
          {size, "wave generator, 1st harmonic"},        {2.0 * size, "wave generator, 2nd harmonic"},
          {2.0 * size + 2.0, "tooth engagement"},        {4.0 * size, "wave generator, 4th harmonic"}};
}

OrderAnalysis AnalyseOrders(std::span<const double> output_angle_rad, std::span<const double> error_rad,
                            double ratio) {
  const Sampling sampling = SamplingOf(output_angle_rad);
  const double samples_per_rev = sampling.per_turn;
  OrderAnalysis analysis;
  std::vector<PlacedLine> placed = PlaceCandidates(ratio, sampling, &analysis);
  const auto max_lines =
      static_cast<std::size_t>(std::min(static_cast<double>(error_rad.size()), samples_per_rev + 1.0) / 4.0);
  if (placed.size() > max_lines) {
    placed.resize(max_lines);
  }
  const std::vector<double> known = Orders(placed);
  analysis.fit = FitHarmonics(output_angle_rad, error_rad, known, ErrorModel::kIndependent);
  AddFurtherLines(output_angle_rad, analysis.fit.residuals, samples_per_rev,
                  std::min(max_lines, placed.size() + kMaxFurtherLines), &placed);
  analysis.fit = FitHarmonics(output_angle_rad, error_rad, Orders(placed), ErrorModel::kAutocorrelated);

  for (std::size_t k = 0; k < placed.size(); ++k) {
    const Harmonic& harmonic = analysis.fit.harmonics[k];
    OrderLine line;
    line.order_per_output_rev = placed[k].order;
    line.order_per_input_rev = placed[k].order / std::abs(ratio);
    line.amplitude_rad = placed[k].seen_in_part ? kNotEstimated : harmonic.amplitude;
    line.phase_rad = harmonic.phase_rad.value;
    line.name = placed[k].name;
    line.aliased = std::abs(placed[k].appears_at - placed[k].order) > kResolution;
    line.alias_order_per_output_rev = placed[k].appears_at;
    analysis.lines.push_back(std::move(line));
  }
  const auto strength = [](const OrderLine& line) {
    return std::isnan(line.amplitude_rad.value) ? -1.0 : line.amplitude_rad.value;
  };
  std::stable_sort(analysis.lines.begin(), analysis.lines.end(),
                   [&](const OrderLine& a, const OrderLine& b) { return strength(a) > strength(b); });
  return analysis;
}

}  // namespace strainwave::analysis
