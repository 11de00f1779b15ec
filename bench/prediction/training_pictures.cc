// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/training_pictures.h"

#include <algorithm>

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace prediction = analysis::prediction;

void DrawPredictions(const HeldOut& held_out, const std::vector<std::string>& outputs,
                     const std::filesystem::path& stem) {
  constexpr int kPanelHeight_px = 320;
  std::string script = "$held_out << EOD\n";
  for (Eigen::Index row = 0; row < held_out.actual.rows(); ++row) {
    script += fmt::format("{}", held_out.cycle[static_cast<std::size_t>(row)]);
    for (Eigen::Index column = 0; column < held_out.actual.cols(); ++column) {
      script += fmt::format(" {} {}", held_out.actual(row, column), held_out.predicted(row, column));
    }
    script += "\n";
  }
  script += fmt::format("EOD\nset multiplot layout {},1 title {}\nset grid\nset key outside right top\n",
                        outputs.size(), Quoted("records that the network had not seen: " + held_out.split));
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (i + 1 == outputs.size()) script += "set xlabel 'cycle'\n";
    script += fmt::format(
        "set ylabel {}\nplot $held_out using 1:{} with points pt 7 ps 0.4 lc rgb '{}' title 'measured', "
        "'' using 1:{} with points pt 7 ps 0.4 lc rgb '{}' title 'predicted'\n",
        Quoted(outputs[i]), 2 * i + 2, kFirstColour.plain, 2 * i + 3, kLastColour.plain);
  }
  script += "unset multiplot\n";
  RenderPicture(script, stem, {1200, kPanelHeight_px * static_cast<int>(outputs.size())});
}

void DrawConfusion(const FoldResult& folds, const std::vector<std::string>& classes,
                   const std::filesystem::path& stem) {
  const Eigen::MatrixXi& counts = folds.all.confusion;
  std::string script = "$confusion << EOD\n";
  std::string x_tics;
  std::string y_tics;
  for (Eigen::Index own = 0; own < counts.rows(); ++own) {
    const double all = std::max(1, counts.row(own).sum());
    for (Eigen::Index given = 0; given < counts.cols(); ++given) {
      script += fmt::format("{} {} {} {}\n", given, own, counts(own, given) / all, counts(own, given));
    }
    const std::string name = Quoted(classes[static_cast<std::size_t>(own)]);
    x_tics += fmt::format("{}{} {}", own == 0 ? "" : ", ", name, own);
    y_tics += fmt::format("{}{} {}", own == 0 ? "" : ", ", name, own);
  }
  const double most = static_cast<double>(counts.rows()) - 0.5;
  script += fmt::format(
      "EOD\nset title {}\nset xrange [-0.5:{}]\nset yrange [{}:-0.5]\nset cbrange [0:1]\nset size ratio -1\n"
      "set palette defined (0 'white', 1 '{}')\nset cblabel 'share of the records of a class'\nunset key\n"
      "set xlabel 'predicted'\nset ylabel 'own class'\nset xtics ({}) rotate by 30 right\nset ytics ({})\n"
      "plot $confusion using 1:2:3 with image, '' using 1:2:(sprintf('%d', $4)) with labels tc rgb '{}'\n",
      Quoted(fmt::format("accuracy {:.2f} %, by folds of {}", 100.0 - folds.all.Error_percent(), folds.of)),
      most, most, kFirstColour.pale, x_tics, y_tics, kFirstColour.dark);
  RenderPicture(script, stem, {900, 800});
}

void DrawCurve(const std::vector<prediction::LearningPoint>& curve, const std::string& split,
               const std::filesystem::path& stem) {
  std::string script = "$curve << EOD\n";
  for (const prediction::LearningPoint& point : curve) {
    script += fmt::format("{} {} {}\n", point.count, point.active_percent, point.even_percent);
  }
  script += fmt::format(
      "EOD\nset title {}\nset logscale x 2\nset grid\nset xlabel 'measured records that were trained on'\n"
      "set ylabel 'error, %'\nset yrange [0:*]\n"
      "plot $curve using 1:2 with linespoints pt 7 lw 2 lc rgb '{}' title 'chosen actively', "
      "'' using 1:3 with linespoints pt 5 lw 2 lc rgb '{}' title 'spread evenly'\n",
      Quoted("how few measured records would do: error on " + split), kFirstColour.plain, kLastColour.plain);
  RenderPicture(script, stem, {900, 560});
}

}  // namespace

std::vector<std::filesystem::path> DrawTraining(const TrainingData& data, const TrainingOutcome& outcome,
                                                const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> pictures;
  if (data.samples.classes) {
    pictures.push_back(folder / "confusion");
    DrawConfusion(outcome.folds, data.samples.outputs, pictures.back());
  } else {
    pictures.push_back(folder / "predicted");
    DrawPredictions(outcome.held_out, data.samples.outputs, pictures.back());
  }
  if (!outcome.curve.empty()) {
    pictures.push_back(folder / "learning_curve");
    DrawCurve(outcome.curve, outcome.splits.front().name, pictures.back());
  }
  return pictures;
}

}  // namespace strainwave::bench
