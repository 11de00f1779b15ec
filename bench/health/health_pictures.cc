// SPDX-License-Identifier: Apache-2.0
#include "bench/health/health_pictures.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "analysis/decompositions.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace health = analysis::health;

std::vector<double> Copied(const Eigen::VectorXd& values) { return {values.begin(), values.end()}; }

std::vector<double> Counting(std::size_t count) {
  std::vector<double> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 1.0);
  return numbers;
}

// Features by their score, the best last.
std::vector<Eigen::Index> Ranked(const Eigen::VectorXd& score) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(score.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, [&](Eigen::Index a, Eigen::Index b) { return score(a) < score(b); });
  return order;
}

std::filesystem::path DrawSelection(const HealthData& data, const HealthOutcome& outcome,
                                    const std::filesystem::path& stem) {
  std::string script = CommonStyle();
  std::string panels = fmt::format(
      "set multiplot layout 3,{} title 'scores of features' font ',16'\nunset key\n", data.components.size());
  const char* labels[] = {"score", "frequency of the score", "weighted difference"};
  for (int row = 0; row < 3; ++row) {
    for (std::size_t c = 0; c < data.components.size(); ++c) {
      const health::ScoreThreshold& threshold = outcome.chosen.of_component[c].threshold;
      const std::string name = fmt::format("scores{}_{}", row, c);
      if (row == 0) {
        Eigen::VectorXd sorted = outcome.chosen.scores[c].score;
        std::sort(sorted.begin(), sorted.end());
        script += DataBlock(name, {Counting(static_cast<std::size_t>(sorted.size())), Copied(sorted)});
      } else if (row == 1) {
        script += DataBlock(name, {threshold.unique, std::vector<double>(threshold.frequency.begin(),
                                                                         threshold.frequency.end())});
      } else {
        script += DataBlock(name, {threshold.unique, threshold.difference});
      }
      panels += fmt::format(
          "set title {}\nset xlabel '{}'\nset ylabel '{}'\nplot ${} using 1:2 with {} lc rgb '{}'",
          Quoted(fmt::format("{}: threshold {:.2f}", data.components[c], threshold.threshold)),
          row == 0 ? "feature, by score" : "score", labels[row], name,
          row == 0 ? "points pt 7 ps 0.4" : "impulses lw 2", kFirstColour.plain);
      panels +=
          row == 0 ? fmt::format(", {} with lines dt 2 lc rgb '{}'\n", threshold.threshold, kLastColour.plain)
                   : "\n";
    }
  }
  return RenderPicture(script + panels + "unset multiplot\n", stem,
                       {650 * static_cast<int>(data.components.size()), 900});
}

// A histogram of one feature a level of a component, as a block and plots.
void AddHistogram(const HealthData& data, Eigen::Index feature, Eigen::Index component,
                  const std::string& name, std::string& script, std::string& panels) {
  constexpr int kBins = 40;
  const Eigen::VectorXd values = data.samples.features.col(feature);
  const double low = values.minCoeff();
  const double width = std::max(1e-300, (values.maxCoeff() - low) / kBins);
  std::vector<double> levels(data.conditions.col(component).begin(), data.conditions.col(component).end());
  std::ranges::sort(levels);
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  constexpr std::size_t kMostLevelsShown = 6;
  panels += fmt::format("set title {}\nset ylabel 'cycles'\nset xlabel ''\nset key top right\n",
                        Quoted(data.samples.inputs[static_cast<std::size_t>(feature)]));
  for (std::size_t l = 0; l < std::min(levels.size(), kMostLevelsShown); ++l) {
    std::vector<double> at(kBins);
    std::vector<double> counts(kBins, 0.0);
    for (int bin = 0; bin < kBins; ++bin) at[static_cast<std::size_t>(bin)] = low + (bin + 0.5) * width;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (data.samples.targets(i, component) != levels[l]) continue;
      counts[static_cast<std::size_t>(
          std::clamp(static_cast<int>((values(i) - low) / width), 0, kBins - 1))] += 1.0;
    }
    script += DataBlock(fmt::format("{}_{}", name, l), {at, counts});
    panels += fmt::format("{}${}_{} using 1:2 with histeps lw 2 title '{} {:.2g}'", l == 0 ? "plot " : ", ",
                          name, l, data.components[static_cast<std::size_t>(component)], levels[l]);
  }
  panels += "\n";
}

// The first two principal components of four features, coloured by the health of a component.
void AddPrincipal(const HealthData& data, const std::vector<Eigen::Index>& features, Eigen::Index component,
                  const std::string& title, const std::string& name, std::string& script,
                  std::string& panels) {
  Eigen::MatrixXd values = data.samples.features(Eigen::all, features);
  values.rowwise() -= values.colwise().mean().eval();
  for (Eigen::Index f = 0; f < values.cols(); ++f) {
    const double size = values.col(f).norm();
    if (size > 0.0) values.col(f) /= size;
  }
  const analysis::SymmetricParts parts = analysis::SymmetricEigen(values.transpose() * values);
  const Eigen::Index last = parts.vectors.cols() - 1;
  const Eigen::VectorXd first = values * parts.vectors.col(last);
  const Eigen::VectorXd second = values * parts.vectors.col(std::max<Eigen::Index>(0, last - 1));
  script += DataBlock(name, {Copied(first), Copied(second), Copied(data.samples.targets.col(component))});
  panels += fmt::format(
      "set title {}\nset xlabel 'first principal component'\nset ylabel 'second'\nunset key\n"
      "plot ${} using 1:2:3 with points pt 7 ps 0.4 lc palette\n",
      Quoted(title), name);
}

std::filesystem::path DrawFeatures(const HealthData& data, const HealthOutcome& outcome,
                                   const std::filesystem::path& stem) {
  std::string script = CommonStyle() + "set palette defined (0 '#0072B2', 0.5 '#CCCCCC', 1 '#D55E00')\n";
  std::string panels = fmt::format("set multiplot layout {},4 title 'best and worst features' font ',16'\n",
                                   data.components.size());
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    const std::vector<Eigen::Index> ranked = Ranked(outcome.chosen.scores[c].score);
    const auto component = static_cast<Eigen::Index>(c);
    AddHistogram(data, ranked.back(), component, fmt::format("best{}", c), script, panels);
    AddHistogram(data, ranked.front(), component, fmt::format("worst{}", c), script, panels);
    const std::size_t four = std::min<std::size_t>(4, ranked.size());
    AddPrincipal(data, {ranked.end() - static_cast<std::ptrdiff_t>(four), ranked.end()}, component,
                 data.components[c] + ": the four best, by principal components", fmt::format("pbest{}", c),
                 script, panels);
    AddPrincipal(data, {ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(four)}, component,
                 data.components[c] + ": the four worst", fmt::format("pworst{}", c), script, panels);
  }
  return RenderPicture(script + panels + "unset multiplot\n", stem,
                       {1800, 420 * static_cast<int>(data.components.size()) + 60});
}

std::filesystem::path DrawErrors(const HealthData& data, const HealthOutcome& outcome,
                                 const std::filesystem::path& stem) {
  constexpr int kBins = 61;
  constexpr double kWidth = 0.02;
  std::string script = CommonStyle();
  std::string panels = fmt::format(
      "set multiplot layout {},{} title 'error of the health of cycles that were not trained on' font ',16'\n"
      "unset key\nset xlabel 'estimated less true'\nset ylabel 'cycles'\nset xrange [-0.62:0.62]\n",
      data.components.size(), outcome.splits.size());
  for (std::size_t c = 0; c < data.components.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    for (std::size_t s = 0; s < outcome.splits.size(); ++s) {
      const HealthSplit& split = outcome.splits[s];
      std::vector<double> at(kBins);
      std::vector<double> counts(kBins, 0.0);
      for (int bin = 0; bin < kBins; ++bin) at[static_cast<std::size_t>(bin)] = (bin - kBins / 2) * kWidth;
      for (std::size_t i = 0; i < split.rows.size(); ++i) {
        const double off = split.predicted(static_cast<Eigen::Index>(i), column) -
                           data.samples.targets(split.rows[i], column);
        const int bin = std::clamp(static_cast<int>(std::lround(off / kWidth)) + kBins / 2, 0, kBins - 1);
        counts[static_cast<std::size_t>(bin)] += 1.0;
      }
      const std::string name = fmt::format("errors{}_{}", c, s);
      script += DataBlock(name, {at, counts});
      panels += fmt::format(
          "set title {}\nplot ${} using 1:2 with boxes fs solid 0.6 lc rgb '{}'\n",
          Quoted(fmt::format("{}, {}: RMSE {:.4f}", data.components[c], split.name, split.rmse(column))),
          name, split.name == "random" ? kLastColour.plain : kFirstColour.plain);
    }
  }
  return RenderPicture(script + panels + "unset multiplot\n", stem,
                       {1500, 380 * static_cast<int>(data.components.size()) + 60});
}

// Sections through the surface: along each component, with the others as new and at their worst.
std::filesystem::path DrawSurface(const HealthData& data, const SystemModel& system,
                                  const std::filesystem::path& stem) {
  constexpr int kPoints = 51;
  const auto n = static_cast<Eigen::Index>(data.components.size());
  std::string script = CommonStyle();
  std::string panels = fmt::format(
      "set multiplot layout 1,{} title 'the system over health, with 95 % intervals of a new measurement' "
      "font ',16'\n"
      "set yrange [*:*]\nset xrange [-0.02:1.02]\nset ylabel 'index of the system'\nset key top left\n",
      n);
  for (Eigen::Index c = 0; c < n; ++c) {
    panels +=
        fmt::format("set xlabel {}\nset title ''\n", Quoted(data.components[static_cast<std::size_t>(c)]));
    for (int others = 0; others < 2; ++others) {
      Eigen::MatrixXd points = Eigen::MatrixXd::Constant(kPoints, n, others == 0 ? 0.0 : 0.67);
      std::vector<double> at(kPoints);
      for (int i = 0; i < kPoints; ++i) {
        at[static_cast<std::size_t>(i)] = i / (kPoints - 1.0);
        points(i, c) = at[static_cast<std::size_t>(i)];
      }
      std::vector<double> value;
      std::vector<double> low;
      std::vector<double> high;
      for (const health::SystemAt& one :
           health::SystemsAt(system.surface, system.scale, points, health::IntervalOf::kMeasurement)) {
        value.push_back(one.index.value);
        low.push_back(one.index.low);
        high.push_back(one.index.high);
      }
      const std::string name = fmt::format("section{}_{}", c, others);
      script += DataBlock(name, {at, value, low, high});
      const std::string_view colour = others == 0 ? kFirstColour.plain : kLastColour.plain;
      panels += fmt::format(
          "{}${} using 1:3:4 with filledcurves fs transparent solid 0.18 lc rgb '{}' notitle, "
          "${} using 1:2 with lines lw 2 lc rgb '{}' title 'others at {}'",
          others == 0 ? "plot " : ", ", name, colour, name, colour, others == 0 ? "0" : "0.67");
    }
    // Measured with all others as new.
    std::vector<double> at;
    std::vector<double> measured;
    for (const SystemValue& one : data.system) {
      Eigen::VectorXd rest = one.health;
      rest(c) = 0.0;
      if (!rest.isZero()) continue;
      at.push_back(one.health(c));
      measured.push_back(system.scale.Index(one.value));
    }
    if (!at.empty()) {
      const std::string name = fmt::format("measured{}", c);
      script += DataBlock(name, {at, measured});
      panels +=
          fmt::format(", ${} using 1:2 with points pt 7 ps 0.6 lc rgb '{}' title 'measured, others at 0'",
                      name, kMeasuredColour);
    }
    panels += "\n";
  }
  return RenderPicture(script + panels + "unset multiplot\n", stem, {700 * static_cast<int>(n), 620});
}

}  // namespace

std::vector<std::filesystem::path> DrawHealthTraining(const HealthData& data, const HealthOutcome& outcome,
                                                      const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> pictures{DrawSelection(data, outcome, folder / "selection"),
                                              DrawFeatures(data, outcome, folder / "features"),
                                              DrawErrors(data, outcome, folder / "errors")};
  if (outcome.system) pictures.push_back(DrawSurface(data, *outcome.system, folder / "system"));
  return pictures;
}

std::filesystem::path DrawWhatIf(const std::vector<std::string>& components, const Eigen::VectorXd& state,
                                 const health::WhatIf& answer, const std::filesystem::path& stem) {
  std::string script = CommonStyle();
  std::string now = "$now << EOD\n";
  std::string shares = "$shares << EOD\n";
  std::string after = "$after << EOD\n";
  std::size_t row = 0;
  for (; row < components.size(); ++row) {
    const std::string name = Quoted(components[row]);
    now += fmt::format("{} \"{}\" {} {} {}\n", row, components[row], state(static_cast<Eigen::Index>(row)),
                       state(static_cast<Eigen::Index>(row)), state(static_cast<Eigen::Index>(row)));
    shares += fmt::format("{} \"{}\" {} {} {}\n", row, components[row], answer.shapley[row].value,
                          answer.shapley[row].low, answer.shapley[row].high);
    const health::Bounded& restored = answer.restored[row].index;
    after += fmt::format("{} \"{} replaced\" {} {} {}\n", row, components[row], restored.value, restored.low,
                         restored.high);
  }
  const health::Bounded& system = answer.system.index;
  const health::Bounded& baseline = answer.baseline.index;
  now += fmt::format("{} \"system\" {} {} {}\n", row, system.value, system.low, system.high);
  shares += fmt::format("{} \"no component\" {} {} {}\n", row, baseline.value, baseline.low, baseline.high);
  after += fmt::format("{} \"as it is\" {} {} {}\n", row, system.value, system.low, system.high);
  script += now + "EOD\n" + shares + "EOD\n" + after + "EOD\n" +
            "set multiplot layout 1,3\nunset key\nset boxwidth 0.6\nset yrange [*<0:*]\nset xtics rotate by "
            "25 right\n";
  constexpr std::pair<const char*, const char*> kPanels[] = {
      {"now", "health now"},
      {"shares", "where the system's index comes from (Shapley)"},
      {"after", "the system's index after"}};
  for (const auto& [name, title] : kPanels) {
    script += fmt::format(
        "set title {}\nplot ${} using 1:3:xtic(2) with boxes fs solid 0.5 lc rgb '{}', ${} using 1:3:4:5 "
        "with "
        "yerrorbars pt 0 lw 2 lc rgb '{}'\n",
        Quoted(title), name, kFirstColour.plain, name, kFirstColour.dark);
  }
  return RenderPicture(script + "unset multiplot\n", stem, {1400, 520});
}

}  // namespace strainwave::bench
