// SPDX-License-Identifier: Apache-2.0
#include "bench/faults/fault_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace fs = std::filesystem;

// Okabe and Ito, then again.
constexpr std::array<std::string_view, 7> kClassColours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                        "#E69F00", "#56B4E9", "#000000"};

std::string_view ColourOf(std::size_t k) { return kClassColours[k % kClassColours.size()]; }

// Rows that show one output alone; of labels, the first that show nothing are not drawn.
std::vector<Eigen::Index> RowsOf(const FaultRecords& records, Eigen::Index output) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index row = 0; row < records.labels.targets.rows(); ++row) {
    if (records.labels.targets(row, output) > 0.5 && records.labels.targets.row(row).sum() < 1.5)
      rows.push_back(row);
  }
  return rows;
}

fs::path DrawDeviations(const FaultRecords& records, const fs::path& stem) {
  const FaultTable& table = records.tables.front();
  const auto levels = static_cast<Eigen::Index>(table.settings.details.levels);
  const bool logarithm = table.settings.details.logarithm;
  const std::vector<std::string>& names = records.labels.outputs;
  std::string script;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::vector<Eigen::Index> rows = RowsOf(records, static_cast<Eigen::Index>(k));
    script += fmt::format("$class{} << EOD\n", k);
    for (Eigen::Index level = 0; level < levels; ++level) {
      script += fmt::format("{}", level + 1);
      for (std::size_t c = 0; c < records.channels.size(); ++c) {
        const Eigen::Index column = static_cast<Eigen::Index>(c) * levels + level;
        // The middle one, and the tenth from either end: mountings differ.
        std::vector<double> values;
        for (const Eigen::Index row : rows) values.push_back(table.values(row, column));
        std::ranges::sort(values);
        for (const double share : {0.5, 0.1, 0.9}) {
          if (values.empty()) {
            script += " NaN";
            continue;
          }
          const double value =
              values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
          script += fmt::format(" {:.6g}", logarithm ? std::exp(value) : value);
        }
      }
      script += "\n";
    }
    script += "EOD\n";
  }
  const auto channels = static_cast<int>(records.channels.size());
  script += CommonStyle() +
            fmt::format(
                "set multiplot layout {},1 title {} font ',18'\nset logscale y\nset xrange [0.5:{}]\n"
                "set xtics 1\nset key outside right top\n",
                channels, Quoted("standard deviation of the details; bars hold eight of ten records"),
                static_cast<double>(levels) + 0.7);
  for (int c = 0; c < channels; ++c) {
    if (c + 1 == channels) script += "set xlabel 'level'\n";
    script += fmt::format("set ylabel {}\nplot ", Quoted(records.channels[static_cast<std::size_t>(c)]));
    for (std::size_t k = 0; k < names.size(); ++k)
      script += fmt::format(
          "{}$class{} using ($1+{:.3f}):{}:{}:{} with yerrorlines pt 7 ps 0.6 lw 1.5 lc rgb '{}' title {}",
          k == 0 ? "" : ", ", k, 0.05 * static_cast<double>(k), 3 * c + 2, 3 * c + 3, 3 * c + 4, ColourOf(k),
          Quoted(names[k]));
    script += "\n";
  }
  return RenderPicture(script + "unset multiplot\n", stem, {1200, 320 * channels + 80});
}

fs::path DrawCourse(const FaultOutcome& outcome, const fs::path& stem) {
  const auto& course = outcome.course;
  std::vector<double> epochs(course.epoch.begin(), course.epoch.end());
  std::string script =
      DataBlock("course", {epochs, course.training, course.validation, course.test}) + CommonStyle();
  script += fmt::format(
      "set title {}\nset logscale xy\nset xlabel 'epoch'\nset ylabel 'mean squared error of the outputs'\n"
      "plot $course using 1:2 with lines lw 2 lc rgb '{}' title 'training, 70 %', '' using 1:3 with lines lw "
      "2 "
      "lc rgb '{}' title 'validation, 15 %', '' using 1:4 with lines lw 2 lc rgb '{}' title 'test, 15 %'\n",
      Quoted(fmt::format("a training on records at random; ended by: {}", course.end)), ColourOf(0),
      ColourOf(1), ColourOf(2));
  return RenderPicture(script, stem, {900, 560});
}

fs::path DrawOutputs(const FaultRecords& records, const FaultOutcome& outcome, const fs::path& stem) {
  const Eigen::MatrixXd& targets = records.labels.targets;
  // One class after the other, records of several faults last.
  std::vector<Eigen::Index> order(static_cast<std::size_t>(targets.rows()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::ranges::stable_sort(order, {}, [&](Eigen::Index row) {
    Eigen::Index own = 0;
    targets.row(row).maxCoeff(&own);
    return std::pair(targets.row(row).sum(), own);
  });
  std::string script = "$outputs << EOD\n";
  for (std::size_t i = 0; i < order.size(); ++i) {
    script += fmt::format("{}", i + 1);
    for (Eigen::Index k = 0; k < targets.cols(); ++k) {
      const double said = outcome.left_out(order[i], k);
      script += fmt::format(" {} {}", std::isfinite(said) ? fmt::format("{:.5g}", said) : "NaN",
                            targets(order[i], k));
    }
    script += "\n";
  }
  script += "EOD\n" + CommonStyle();
  script += fmt::format(
      "set multiplot layout {},1 title {} font ',18'\nset yrange [-0.1:1.1]\nset key off\n", targets.cols(),
      Quoted("outputs for each record (line: what it is), tested by " + outcome.left_out_by));
  for (Eigen::Index k = 0; k < targets.cols(); ++k) {
    if (k + 1 == targets.cols()) script += "set xlabel 'record'\n";
    script += fmt::format(
        "set ylabel {}\nplot $outputs using 1:{} with steps lw 2 lc rgb '#888888', '' using 1:{} with points "
        "pt 7 "
        "ps 0.4 lc rgb '{}'\n",
        Quoted(records.labels.outputs[static_cast<std::size_t>(k)]), 2 * k + 3, 2 * k + 2,
        ColourOf(static_cast<std::size_t>(k)));
  }
  return RenderPicture(script + "unset multiplot\n", stem,
                       {1200, 170 * static_cast<int>(targets.cols()) + 110});
}

fs::path DrawConfusionOf(const FaultSplit& split, const Eigen::MatrixXi& counts, double accuracy,
                         const std::vector<std::string>& classes, const fs::path& stem) {
  std::string script = "$confusion << EOD\n";
  std::string tics;
  for (Eigen::Index own = 0; own < counts.rows(); ++own) {
    const double all = std::max(1, counts.row(own).sum());
    for (Eigen::Index told = 0; told < counts.cols(); ++told)
      script += fmt::format("{} {} {} {}\n", told, own, counts(own, told) / all, counts(own, told));
    tics += fmt::format("{}{} {}", own == 0 ? "" : ", ", Quoted(classes[static_cast<std::size_t>(own)]), own);
  }
  const double most = static_cast<double>(counts.rows()) - 0.5;
  script += fmt::format(
      "EOD\nset title {}\nset xrange [-0.5:{}]\nset yrange [{}:-0.5]\nset cbrange [0:1]\nset size ratio -1\n"
      "set palette defined (0 'white', 1 '{}')\nset cblabel 'share of the records of a class'\nunset key\n"
      "set xlabel 'told'\nset ylabel 'own class'\nset xtics ({}) rotate by 30 right\nset ytics ({})\n"
      "plot $confusion using 1:2:3 with image, '' using 1:2:(sprintf('%d', $4)) with labels tc rgb '{}'\n",
      Quoted(fmt::format("{}: accuracy {:.1f} %, {}", split.name, 100.0 * accuracy, split.meaning)), most,
      most, kFirstColour.pale, tics, tics, kFirstColour.dark);
  return RenderPicture(script, stem, {900, 800});
}

fs::path DrawLevels(const FaultOutcome& outcome, const fs::path& stem) {
  std::string script = "$levels << EOD\n";
  for (std::size_t k = 0; k < outcome.by_levels.size(); ++k) {
    script += fmt::format("{}", k + 1);
    for (const FaultSplitResult& split : outcome.by_levels[k].splits) {
      const auto accuracy = split.Accuracy();
      script += accuracy ? fmt::format(" {:.5g}", 100.0 * *accuracy) : std::string(" NaN");
    }
    script += "\n";
  }
  script += "EOD\n" + CommonStyle() +
            "set title 'accuracy over the levels that are kept, from D1 on'\nset xlabel 'levels kept'\n"
            "set ylabel 'accuracy, %'\nset xtics 1\nset yrange [0:105]\nset key bottom right\nplot ";
  for (std::size_t k = 0; k < outcome.splits.size(); ++k)
    script += fmt::format("{}$levels using 1:{} with linespoints pt 7 lw 2 lc rgb '{}' title {}",
                          k == 0 ? "" : ", ", k + 2, ColourOf(k), Quoted(outcome.splits[k].name));
  return RenderPicture(script + "\n", stem, {900, 560});
}

}  // namespace

std::vector<fs::path> DrawFaults(const FaultRecords& records, const FaultOutcome& outcome,
                                 const fs::path& folder) {
  std::vector<fs::path> pictures;
  pictures.push_back(DrawDeviations(records, folder / "deviations"));
  if (!outcome.course.epoch.empty()) pictures.push_back(DrawCourse(outcome, folder / "training"));
  const FaultTableResult& chosen = outcome.tables[outcome.chosen];
  if (outcome.left_out.array().isFinite().any())
    pictures.push_back(DrawOutputs(records, outcome, folder / "outputs"));
  for (std::size_t k = 0; k < outcome.splits.size(); ++k) {
    const auto& scores = chosen.splits[k].classes;
    if (!scores) continue;
    pictures.push_back(DrawConfusionOf(outcome.splits[k], scores->confusion, scores->accuracy,
                                       records.labels.outputs,
                                       folder / ("confusion_" + outcome.splits[k].name)));
  }
  if (!outcome.by_levels.empty()) pictures.push_back(DrawLevels(outcome, folder / "levels"));
  return pictures;
}

fs::path DrawDetails(const daq::Record& record, const std::string& channel, double sample_rate_hz,
                     const analysis::features::DetailRecipe& recipe, const fs::path& stem) {
  const std::vector<double> signal = record.CopyAsDoubles(channel);
  analysis::features::DetailDeviations by_detail(recipe);
  std::vector<double> time_s(signal.size());
  for (std::size_t i = 0; i < time_s.size(); ++i) time_s[i] = static_cast<double>(i) / sample_rate_hz;
  std::vector<double> rest = signal;
  std::vector<double> most;  // of each part
  const auto add_most = [&most](const std::vector<double>& part) {
    double magnitude = 0.0;
    for (const double value : part) magnitude = std::max(magnitude, std::abs(value));
    most.push_back(magnitude > 0.0 ? magnitude : 1.0);
  };
  add_most(signal);
  std::string script = DataBlock("part0", {time_s, signal});
  for (int level = 1; level <= recipe.levels; ++level) {
    const std::vector<double> detail = by_detail.Detail(signal, level);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= detail[i];
    script += DataBlock(fmt::format("part{}", level), {time_s, detail});
    add_most(detail);
  }
  script += DataBlock(fmt::format("part{}", recipe.levels + 1), {time_s, rest});
  add_most(rest);
  script +=
      CommonStyle() +
      fmt::format("set multiplot layout {},1 title {} font ',18'\nset key off\n", recipe.levels + 2,
                  Quoted(fmt::format("{} of {}, {}", channel,
                                     fs::path(record.source.file).filename().string(), recipe.wavelet)));
  for (int part = 0; part <= recipe.levels + 1; ++part) {
    const double high_hz = 0.5 * sample_rate_hz / std::exp2(std::clamp(part - 1, 0, recipe.levels));
    const std::string name = part == 0 ? std::string("record")
                             : part <= recipe.levels
                                 ? fmt::format("D{}: {:.4g} to {:.4g} Hz", part, 0.5 * high_hz, high_hz)
                                 : fmt::format("A{}: 0 to {:.4g} Hz", recipe.levels, high_hz);
    script += part == recipe.levels + 1 ? "set xtics format '%g'\nset xlabel 's'\n" : "set xtics format ''\n";
    script += fmt::format(
        "set title {0} offset 0,-1.2\nset yrange [-{1:.3g}:{1:.3g}]\nset ytics (-{1:.3g}, 0, {1:.3g})\n"
        "plot $part{2} using 1:2 with lines lw 0.6 lc rgb '{3}'\n",
        Quoted(name), 1.05 * most[static_cast<std::size_t>(part)], part,
        part == 0 ? kMeasuredColour : kFirstColour.plain);
  }
  return RenderPicture(script + "unset multiplot\n", stem, {1300, 150 * (recipe.levels + 2) + 110});
}

}  // namespace strainwave::bench
