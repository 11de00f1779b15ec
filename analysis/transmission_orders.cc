// SPDX-License-Identifier: Apache-2.0
#include "analysis/transmission_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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
};

std::size_t MaxLines(std::size_t samples) { return samples / 4; }

// Candidates at the orders where they appear; those that appear at one order become one line.
std::vector<PlacedLine> PlaceCandidates(double ratio, double samples_per_rev,
                                        std::vector<std::string>* notes) {
  std::vector<PlacedLine> placed;
  for (const OrderCandidate& candidate : KnownOrders(ratio)) {
    const double appears_at = FoldedOrder(candidate.order, samples_per_rev);
    const bool folded = std::abs(appears_at - candidate.order) > kResolution;
    if (folded) {
      notes->push_back(
          fmt::format("order {:.6g} ({}) appears at order {:.4g}: {:.4g} samples per output turn",
                      candidate.order, candidate.name, appears_at, samples_per_rev));
    }
    if (appears_at < kResolution) {
      notes->push_back(
          fmt::format("order {:.6g} ({}) cannot be told from a constant", candidate.order, candidate.name));
      continue;
    }
    const auto same = std::find_if(placed.begin(), placed.end(), [&](const PlacedLine& line) {
      return std::abs(line.appears_at - appears_at) < kResolution;
    });
    if (same == placed.end()) {
      placed.push_back({appears_at, candidate.order, candidate.name});
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
                     std::size_t max_lines, std::vector<PlacedLine>* placed) {
  const std::vector<double> spectrum = IntegerOrderSpectrum(angle_rad, residuals);
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
      placed->push_back({order, order, ""});
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
  const double travel_rad = std::abs(output_angle_rad.back() - output_angle_rad.front());
  const double samples_per_rev = kTwoPi * static_cast<double>(output_angle_rad.size() - 1) / travel_rad;
  OrderAnalysis analysis;
  std::vector<PlacedLine> placed = PlaceCandidates(ratio, samples_per_rev, &analysis.notes);
  const std::size_t max_lines = MaxLines(error_rad.size());
  if (placed.size() > max_lines) {
    placed.resize(max_lines);
  }
  const std::vector<double> known = Orders(placed);
  analysis.fit = FitHarmonics(output_angle_rad, error_rad, known, ErrorModel::kIndependent);
  AddFurtherLines(output_angle_rad, analysis.fit.residuals,
                  std::min(max_lines, placed.size() + kMaxFurtherLines), &placed);
  analysis.fit = FitHarmonics(output_angle_rad, error_rad, Orders(placed), ErrorModel::kAutocorrelated);

  for (std::size_t k = 0; k < placed.size(); ++k) {
    const Harmonic& harmonic = analysis.fit.harmonics[k];
    OrderLine line;
    line.order_per_output_rev = placed[k].order;
    line.order_per_input_rev = placed[k].order / std::abs(ratio);
    line.amplitude_rad = harmonic.amplitude;
    line.phase_rad = harmonic.phase_rad.value;
    line.name = placed[k].name;
    line.aliased = std::abs(placed[k].appears_at - placed[k].order) > kResolution;
    line.alias_order_per_output_rev = placed[k].appears_at;
    analysis.lines.push_back(std::move(line));
  }
  std::stable_sort(analysis.lines.begin(), analysis.lines.end(), [](const OrderLine& a, const OrderLine& b) {
    return a.amplitude_rad.value > b.amplitude_rad.value;
  });
  return analysis;
}

}  // namespace strainwave::analysis
