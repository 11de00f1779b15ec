// SPDX-License-Identifier: Apache-2.0
#include "bench/prediction/training_pictures.h"

#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace prediction = analysis::prediction;

// Half of the predictor's interval of each output; zero where there is no predictor.
Eigen::RowVectorXd HalfWidths(const TrainingOutcome& outcome, Eigen::Index outputs) {
  if (!outcome.predictor) return Eigen::RowVectorXd::Zero(outputs);
  const prediction::FittedPredictor& fitted = outcome.predictor->fitted;
  return fitted.band.factor.cwiseProduct(fitted.residual);
}

std::string PredictedName(const TrainingOutcome& outcome) {
  if (!outcome.predictor) return "predicted";
  return fmt::format("predicted, with the {:.0f} % interval of the predictor",
                     100.0 * outcome.predictor->fitted.band.coverage);
}

// Rows of a split: cycle, then measured, predicted and half the interval of each output.
std::string HeldOutBlock(const std::string& name, const HeldOut& held_out,
                         const Eigen::RowVectorXd& half_widths) {
  std::string block = fmt::format("${} << EOD\n", name);
  for (Eigen::Index row = 0; row < held_out.actual.rows(); ++row) {
    block += fmt::format("{}", held_out.cycle[static_cast<std::size_t>(row)]);
    for (Eigen::Index column = 0; column < held_out.actual.cols(); ++column) {
      block += fmt::format(" {} {} {}", held_out.actual(row, column), held_out.predicted(row, column),
                           half_widths(column));
    }
    block += "\n";
  }
  return block + "EOD\n";
}

constexpr std::string_view kErrorBars = "yerrorbars pt 7 ps 0.7 lw 1.2";

// Of one reducer: its life, measured and predicted.
std::filesystem::path DrawLife(const TrainingOutcome& outcome, const std::vector<std::string>& outputs,
                               const std::filesystem::path& stem) {
  constexpr int kPanelHeight_px = 320;
  const HeldOut& held_out = outcome.held_out.front();
  std::string script =
      HeldOutBlock("held_out", held_out, HalfWidths(outcome, held_out.actual.cols())) + CommonStyle();
  script +=
      fmt::format("set multiplot layout {},1 title {} font ',18'\nset offsets graph 0.02,graph 0.02,0,0\n",
                  outputs.size(), Quoted("records that the network had not seen: " + held_out.split));
  script += "set key above left horizontal Left reverse samplen 1.5\n";
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (i + 1 == outputs.size()) script += "set xlabel 'cycle'\n";
    script += fmt::format(
        "set ylabel {0}\nplot $held_out using 1:{1} with points pt 7 ps 0.8 lc rgb '{4}' title 'measured', "
        "'' using 1:{2}:{3} with {6} lc rgb '{5}' title {7}\n",
        Quoted(outputs[i]), 3 * i + 2, 3 * i + 3, 3 * i + 4, kFirstColour.plain, kLastColour.plain,
        kErrorBars, Quoted(PredictedName(outcome)));
  }
  script += "unset multiplot\n";
  return RenderPicture(script, stem, {1200, kPanelHeight_px * static_cast<int>(outputs.size())});
}

// Of several: predicted over measured, which is on the diagonal where all is well.
std::filesystem::path DrawAgreement(const TrainingOutcome& outcome, const std::vector<std::string>& outputs,
                                    const std::filesystem::path& stem) {
  constexpr int kPanel_px = 430;
  const std::string_view colours[] = {kFirstColour.plain, kLastColour.plain};
  const std::vector<HeldOut>& held_out = outcome.held_out;
  std::string script;
  for (std::size_t k = 0; k < held_out.size(); ++k) {
    script +=
        HeldOutBlock(fmt::format("split{}", k), held_out[k], HalfWidths(outcome, held_out[k].actual.cols()));
  }
  const int rows = (static_cast<int>(outputs.size()) + 1) / 2;
  script += CommonStyle();
  script += fmt::format(
      "set multiplot layout {},2 title {} font ',16'\n"
      "set key left top Left reverse samplen 1.5\nset xtics rotate by 40 right\nset size square\nset xlabel "
      "'measured'\nset ylabel 'predicted'\n",
      rows, Quoted("records that the network had not seen: " + PredictedName(outcome)));
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    script += fmt::format("set title {}\nplot x with lines lc rgb '#888888' notitle", Quoted(outputs[i]));
    for (std::size_t k = 0; k < held_out.size(); ++k) {
      script += fmt::format(", $split{} using {}:{}:{} with {} lc rgb '{}' title {}", k, 3 * i + 2, 3 * i + 3,
                            3 * i + 4, kErrorBars, colours[k % 2], Quoted(held_out[k].split));
    }
    script += "\n";
  }
  script += "unset multiplot\n";
  return RenderPicture(script, stem, {2 * kPanel_px + 120, kPanel_px * rows + 60});
}

std::filesystem::path DrawConfusion(const FoldResult& folds, const std::vector<std::string>& classes,
                                    const std::filesystem::path& stem) {
  const Eigen::MatrixXi& counts = folds.contestants.front().confusion;
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
      Quoted(fmt::format("accuracy {:.2f} %, by folds of {}",
                         100.0 - folds.contestants.front().Error_percent(), folds.of)),
      most, most, kFirstColour.pale, x_tics, y_tics, kFirstColour.dark);
  return RenderPicture(script, stem, {900, 800});
}

std::filesystem::path DrawCurve(const std::vector<prediction::LearningPoint>& curve, const std::string& split,
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
  return RenderPicture(script, stem, {900, 560});
}

}  // namespace

std::vector<std::filesystem::path> DrawTraining(const TrainingData& data, const TrainingOutcome& outcome,
                                                const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> pictures;
  if (data.samples.classes) {
    pictures.push_back(DrawConfusion(outcome.folds, data.samples.outputs, folder / "confusion"));
  } else if (prediction::SpecimenCount(data.samples) > 1) {
    pictures.push_back(DrawAgreement(outcome, data.samples.outputs, folder / "predicted"));
  } else {
    pictures.push_back(DrawLife(outcome, data.samples.outputs, folder / "predicted"));
  }
  if (!outcome.curve.empty()) {
    pictures.push_back(DrawCurve(outcome.curve, outcome.splits.front().name, folder / "learning_curve"));
  }
  return pictures;
}

}  // namespace strainwave::bench
