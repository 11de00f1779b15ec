// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/sparse_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/diagnosis/residual_views.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;

constexpr double kHighestOrderPerTurn = 1000.0;
constexpr std::size_t kLinesFound = 3;

class Library {
 public:
  explicit Library(std::span<const double> weights)
      : weights_(Eigen::Map<const Eigen::VectorXd>(weights.data(), static_cast<Index>(weights.size()))) {}

  void Add(Eigen::MatrixXd columns, std::function<std::string(std::span<const double>)> describe) {
    constexpr double kRepeats = 0.95;
    Eigen::MatrixXd standard = columns;
    for (Index j = 0; j < standard.cols(); ++j) {
      auto column = standard.col(j);
      column.array() -= weights_.dot(column) / weights_.sum();
      const double norm = std::sqrt(weights_.dot(column.cwiseAbs2()));
      if (!(norm > 1e-9 * std::sqrt(weights_.sum()) * columns.col(j).cwiseAbs().maxCoeff())) return;
      column /= norm;
    }
    for (const Eigen::MatrixXd& earlier : standardised_) {
      const Eigen::MatrixXd shared = earlier.transpose() * weights_.asDiagonal() * standard;
      if (shared.norm() >
          kRepeats * std::sqrt(static_cast<double>(std::min(earlier.cols(), standard.cols())))) {
        return;
      }
    }
    standardised_.push_back(std::move(standard));
    terms_.push_back({std::move(columns), std::move(describe)});
  }

  void AddProduct(const Eigen::VectorXd& column, const std::string& text) {
    Add(column, [text](std::span<const double> c) { return fmt::format("{:.3g} {}", c[0], text); });
  }

  std::vector<LibraryTerm> Take() { return std::move(terms_); }

 private:
  Eigen::VectorXd weights_;
  std::vector<LibraryTerm> terms_;
  std::vector<Eigen::MatrixXd> standardised_;
};

Eigen::VectorXd VectorOf(std::span<const double> values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Index>(values.size()));
}

void AddOrder(Library& library, const Regressor& regressor, double order, const Eigen::VectorXd* direction) {
  const Eigen::VectorXd angle = order * VectorOf(regressor.values);
  Eigen::MatrixXd columns(angle.size(), 2);
  columns << angle.array().cos().matrix(), angle.array().sin().matrix();
  if (direction != nullptr) columns = direction->asDiagonal() * columns;
  const std::string factor = direction != nullptr ? "direction " : "";
  library.Add(std::move(columns), [factor, order, name = regressor.name](std::span<const double> c) {
    const double phase_deg = DegFromRad(std::atan2(c[1], c[0]));
    const std::string whole = std::abs(order - std::round(order)) < 5e-3 ? fmt::format("{:.0f}", order)
                                                                         : fmt::format("{:.2f}", order);
    return fmt::format("{:.3g} {}cos({} {} {} {:.0f} deg)", std::hypot(c[0], c[1]), factor, whole, name,
                       phase_deg < 0.0 ? '+' : '-', std::abs(phase_deg));
  });
}

void AddAngle(Library& library, const Regressor& regressor, std::span<const double> residual,
              std::span<const double> weights, const Eigen::VectorXd* direction, bool with_lines) {
  const auto [low, high] = std::minmax_element(regressor.values.begin(), regressor.values.end());
  const double span = *high - *low;
  if (!(span > 0.0)) return;
  const double lowest = kTwoPi / span;
  double highest = std::min(0.5 * lowest * static_cast<double>(residual.size()), kHighestOrderPerTurn);
  const double folding = FoldingOrder(regressor.values, weights);
  if (folding > 0.0) highest = std::min(highest, 0.5 * folding * (1.0 + 1e-9));
  std::vector<double> orders;
  // A line that could be one at a whole order is that one; two of them would share every selection.
  const double cell = lowest;
  if (with_lines && highest > lowest) {
    for (const LinePeak& peak :
         FindLines(regressor.values, residual, weights, lowest, highest, kLinesFound)) {
      const double whole = std::round(peak.order);
      orders.push_back(whole >= 1.0 && std::abs(peak.order - whole) < 0.35 * cell ? whole : peak.order);
    }
  }
  for (double order = 1.0; order <= 4.0 && order <= highest; order += 1.0) {
    const bool known = std::any_of(orders.begin(), orders.end(),
                                   [&](double other) { return std::abs(other - order) < 0.7 * cell; });
    if (order >= 0.95 * lowest && !known) orders.push_back(order);
  }
  for (const double order : orders) {
    AddOrder(library, regressor, order, nullptr);
  }
  for (const double order : orders) {
    if (direction != nullptr) AddOrder(library, regressor, order, direction);
  }
}

void AddPowers(Library& library, const Regressor& regressor, std::span<const double> weights,
               const Eigen::VectorXd* direction) {
  const Eigen::VectorXd x = regressor.per_unit * VectorOf(regressor.values);
  const Eigen::VectorXd w = VectorOf(weights);
  const double mean = w.dot(x) / w.sum();
  const Eigen::VectorXd centred = x.array() - mean;
  const std::string centred_text =
      fmt::format("({} {} {:.4g})", regressor.name, mean < 0.0 ? '+' : '-', std::abs(mean));
  library.AddProduct(centred, centred_text);
  library.AddProduct(centred.array().square().matrix(), centred_text + "^2");
  library.AddProduct(centred.array().cube().matrix(), centred_text + "^3");
  const double positive = (x.array() > 0.0).select(w, 0.0).sum() / w.sum();
  const bool both_signs = positive > 0.05 && positive < 0.95;
  if (both_signs) {
    library.AddProduct(x.cwiseAbs(), fmt::format("abs({})", regressor.name));
    library.AddProduct(x.array().sign().matrix(), fmt::format("sign({})", regressor.name));
  }
  if (direction != nullptr) {
    library.AddProduct(direction->cwiseProduct(centred), "direction " + centred_text);
    if (both_signs) {
      library.AddProduct(direction->cwiseProduct(x.cwiseAbs()),
                         fmt::format("direction abs({})", regressor.name));
    }
  }
}

void AddDecays(Library& library, const Regressor& time) {
  const Eigen::VectorXd t = time.per_unit * VectorOf(time.values);
  const double first = t.minCoeff();
  const double span = t.maxCoeff() - first;
  for (const double share : {0.05, 0.2}) {
    const double constant = share * span;
    if (!(constant > 0.0)) continue;
    library.AddProduct((-(t.array() - first) / constant).exp().matrix(),
                       fmt::format("exp(-({} {} {:.4g}) / {:.3g})", time.name, first < 0.0 ? '+' : '-',
                                   std::abs(first), constant));
  }
}

}  // namespace

std::vector<LibraryTerm> BuildLibrary(const Study& study, std::span<const double> residual,
                                      std::span<const double> weights, bool with_lines) {
  Library library(weights);
  Eigen::VectorXd direction;
  for (const Regressor& regressor : study.regressors()) {
    if (regressor.name != "direction") continue;
    direction = VectorOf(regressor.values);
    library.AddProduct(direction, "direction");
  }
  const Eigen::VectorXd* by_direction = direction.size() > 0 ? &direction : nullptr;
  for (const Regressor& regressor : study.regressors()) {
    if (regressor.angle) {
      AddAngle(library, regressor, residual, weights, by_direction, with_lines);
    } else if (regressor.name != "direction") {
      AddPowers(library, regressor, weights, by_direction);
    }
    if (regressor.name == "time") AddDecays(library, regressor);
  }
  return library.Take();
}

}  // namespace strainwave::analysis::diagnosis
