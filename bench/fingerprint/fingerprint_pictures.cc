// SPDX-License-Identifier: Apache-2.0
#include "bench/fingerprint/fingerprint_pictures.h"

#include <algorithm>
#include <numeric>
#include <string>

#include <fmt/format.h>

#include "analysis/joint_dynamics/nominal.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace dynamics = analysis::joint_dynamics;
using Eigen::Index;

constexpr int kPanel_px = 260;

// The first file of a class.
std::size_t FileOf(const FingerprintData& data, int faulty) {
  return static_cast<std::size_t>(std::ranges::find(data.facts.faulty, faulty) - data.facts.faulty.begin());
}

// Figure 6: a panel a joint, a column a file.
std::filesystem::path DrawTorques(const FingerprintData& data, const FingerprintOutcome& outcome,
                                  const std::filesystem::path& stem) {
  constexpr Index kPoints = 600;
  constexpr Index kMostJoints = 8;
  const Index joints = std::min(data.joints(), kMostJoints);
  std::string script;
  const std::size_t files[] = {FileOf(data, 0), FileOf(data, 1)};
  for (const std::size_t f : files) {
    const dynamics::JointMotion& motion = data.files[f].motion;
    const std::vector<Index> rows = dynamics::EvenRows(motion.size(), kPoints);
    const dynamics::JointMotion shown = dynamics::RowsOf(motion, rows);
    const Eigen::MatrixXd predicted = outcome.model->nominal.Predict(shown.states).mean;
    script += fmt::format("$file{} << EOD\n", f);
    for (Index i = 0; i < shown.size(); ++i) {
      script += fmt::format("{:.4g}", static_cast<double>(i) / static_cast<double>(shown.size() - 1));
      for (Index j = 0; j < joints; ++j)
        script += fmt::format(" {:.5g} {:.5g}", shown.torques_Nm(i, j), predicted(i, j));
      script += "\n";
    }
    script += "EOD\n";
  }
  script += CommonStyle();
  script +=
      fmt::format("set multiplot layout {},2 title {} font ',16'\nset key above left horizontal\n", joints,
                  Quoted("torques as measured and by the network of healthy units, and what it leaves over"));
  for (Index j = 0; j < joints; ++j) {
    for (const std::size_t f : files) {
      script += fmt::format(
          "set title {}\nset ylabel 'Nm'\nplot $file{} using 1:{} with lines lw 1.5 lc rgb '{}' title "
          "'measured', "
          "'' using 1:{} with lines lw 1.5 lc rgb '{}' title 'network', '' using 1:(${}-${}) with lines lc "
          "rgb '{}' "
          "title 'left over'\n",
          Quoted(fmt::format("joint {}, {} ({})", j + 1, data.names[f], data.classes[f])), f, 2 * j + 2,
          kMeasuredColour, 2 * j + 3, kLastColour.plain, 2 * j + 2, 2 * j + 3, kFirstColour.plain);
    }
  }
  return RenderPicture(script + "unset multiplot\n", stem, {1300, kPanel_px * static_cast<int>(joints) + 60});
}

// Figure 8: the mean share of each number of the files' own fingerprints, by class.
std::filesystem::path DrawShares(const FingerprintData& data, const FingerprintOutcome& outcome,
                                 const std::filesystem::path& stem) {
  const Eigen::MatrixXd sizes = outcome.per_file_fingerprints.cwiseAbs();
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(2, sizes.cols());
  Eigen::Vector2d samples = Eigen::Vector2d::Zero();
  for (Index i = 0; i < sizes.rows(); ++i) {
    const int faulty =
        data.facts.faulty[static_cast<std::size_t>(outcome.file_of_sample[static_cast<std::size_t>(i)])];
    mean.row(faulty) += sizes.row(i) / std::max(sizes.row(i).sum(), 1e-300);
    samples(faulty) += 1.0;
  }
  const std::vector<std::string> names =
      dynamics::NamesOf(outcome.model->attribution.fingerprint, data.joints());
  std::string script = "$share << EOD\n";
  for (Index i = 0; i < mean.cols(); ++i)
    script += fmt::format("{} {} {:.6g} {:.6g}\n", i, names[static_cast<std::size_t>(i)],
                          mean(0, i) / samples(0), mean(1, i) / samples(1));
  script += "EOD\n" + CommonStyle();
  script += fmt::format(
      "set title 'share of all attributions, by the network of each file'\nset style data histograms\nset "
      "style fill "
      "solid 0.8\nset yrange [0:*]\nset xtics rotate by 60 right\nset key top right\n"
      "plot $share using 3:xtic(2) lc rgb '{}' title 'healthy', '' using 4 lc rgb '{}' title 'faulty'\n",
      kFirstColour.plain, kLastColour.plain);
  return RenderPicture(script, stem, {1200, 600});
}

// Figure 7 c, d: each number of the nominal fingerprints, a dot a sample.
std::filesystem::path DrawSamples(const FingerprintData& data, const FingerprintOutcome& outcome,
                                  const std::filesystem::path& stem) {
  constexpr Index kDots = 800;
  constexpr Index kMostNumbers = 40;
  const Eigen::MatrixXd& all = outcome.nominal_fingerprints;
  const std::vector<std::string> names =
      dynamics::NominalNames(outcome.model->attribution.fingerprint, data.joints());
  const Index numbers = std::min(all.cols(), kMostNumbers);
  std::string script;
  std::vector<Index> count(2, 0);
  for (const int faulty : {0, 1}) {
    script += fmt::format("$dots{} << EOD\n", faulty);
    for (const Index i : dynamics::EvenRows(all.rows(), kDots)) {
      const auto file = static_cast<std::size_t>(outcome.file_of_sample[static_cast<std::size_t>(i)]);
      if (data.facts.faulty[file] != faulty) continue;
      // Dots of one row lie above each other by a fixed pattern, so that the same training gives the same
      // picture.
      const double lift = 0.35 * (static_cast<double>((i * 7919) % 100) / 50.0 - 1.0);
      for (Index c = 0; c < numbers; ++c)
        script += fmt::format("{:.5g} {:.3f}\n", all(i, c), static_cast<double>(c) + lift);
    }
    script += "EOD\n";
  }
  script += CommonStyle() + "set ytics (";
  for (Index c = 0; c < numbers; ++c)
    script += fmt::format("{}{} {}", c == 0 ? "" : ", ", Quoted(names[static_cast<std::size_t>(c)]), c);
  script += fmt::format(
      ")\nset yrange [{}:-0.7]\nunset key\nset xlabel 'torque, in standard deviations of it'\nset multiplot "
      "layout 1,2 "
      "title 'fingerprints by networks of healthy units that have not seen the unit' font ',16'\n"
      "set title 'healthy'\nplot $dots0 with points pt 7 ps 0.25 lc rgb '{}'\n"
      "set title 'faulty'\nplot $dots1 with points pt 7 ps 0.25 lc rgb '{}'\nunset multiplot\n",
      static_cast<double>(numbers) - 0.3, kFirstColour.plain, kLastColour.plain);
  return RenderPicture(script, stem, {1300, 200 + 28 * static_cast<int>(numbers)});
}

constexpr const char* kDrawnKind = "network";

std::filesystem::path DrawRoc(const FingerprintOutcome& outcome, const std::filesystem::path& stem) {
  constexpr std::string_view kColours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7"};
  std::string blocks;
  std::string plots;
  std::size_t k = 0;
  for (const dynamics::FileSplit& split : outcome.splits) {
    const auto found = outcome.nominal.find(split.name);
    if (found == outcome.nominal.end()) continue;
    const dynamics::SplitScore& score = found->second.at(kDrawnKind);
    std::vector<std::size_t> order(score.score.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return score.score[i]; });
    const double faulty = std::max(1, std::accumulate(score.actual.begin(), score.actual.end(), 0));
    const double healthy = std::max(1.0, static_cast<double>(score.actual.size()) - faulty);
    double found_share = 0.0;
    double alarm_share = 0.0;
    blocks += fmt::format("$roc{} << EOD\n0 0\n", k);
    for (const std::size_t i : order) {
      (score.actual[i] == 1 ? found_share : alarm_share) += 1.0 / (score.actual[i] == 1 ? faulty : healthy);
      blocks += fmt::format("{:.5g} {:.5g}\n", alarm_share, found_share);
    }
    blocks += "EOD\n";
    plots += fmt::format(", $roc{} with lines lw 2 lc rgb '{}' title {}", k, kColours[k % 4],
                         Quoted(fmt::format("{}: area {:.3f}", split.name, score.area_under_curve)));
    ++k;
  }
  const std::string script = blocks + CommonStyle() +
                             "set title 'network on nominal fingerprints'\nset xlabel 'share of false "
                             "alarms'\nset ylabel 'share of faults "
                             "found'\nset xrange [0:1]\nset yrange [0:1.02]\nset size square\nset key bottom "
                             "right\nplot x with lines lc rgb "
                             "'#888888' notitle" +
                             plots + "\n";
  return RenderPicture(script, stem, {800, 800});
}

std::filesystem::path DrawConfusions(const FingerprintOutcome& outcome, const std::filesystem::path& stem) {
  std::string blocks;
  std::string plots;
  int panels = 0;
  for (const dynamics::FileSplit& split : outcome.splits) {
    const auto found = outcome.nominal.find(split.name);
    if (found == outcome.nominal.end()) continue;
    const Eigen::MatrixXi& counts = found->second.at(kDrawnKind).confusion;
    blocks += fmt::format("$counts{} << EOD\n", panels);
    for (Index own = 0; own < 2; ++own) {
      const double all = std::max(1, counts.row(own).sum());
      for (Index given = 0; given < 2; ++given)
        blocks += fmt::format("{} {} {} {}\n", given, own, counts(own, given) / all, counts(own, given));
    }
    blocks += "EOD\n";
    plots += fmt::format(
        "set title {}\nplot $counts{} using 1:2:3 with image, '' using 1:2:(sprintf('%d', $4)) with labels "
        "tc rgb '{}'\n",
        Quoted(fmt::format("{} ({})", split.name, split.by_samples ? "samples" : "files")), panels,
        kFirstColour.dark);
    ++panels;
  }
  const std::string script =
      blocks +
      fmt::format(
          "set xrange [-0.5:1.5]\nset yrange [1.5:-0.5]\nset cbrange [0:1]\nset size ratio -1\nset palette "
          "defined (0 'white', 1 '{}')\nunset key\nunset colorbox\nset xlabel 'predicted'\nset ylabel 'own "
          "class'\nset xtics ('healthy' 0, 'faulty' 1)\nset ytics ('healthy' 0, 'faulty' 1)\nset multiplot "
          "layout 1,{}\n",
          kFirstColour.pale, std::max(1, panels)) +
      plots + "unset multiplot\n";
  return RenderPicture(script, stem, {420 * std::max(1, panels), 460});
}

}  // namespace

std::vector<std::filesystem::path> DrawFingerprints(const FingerprintData& data,
                                                    const FingerprintOutcome& outcome,
                                                    const std::filesystem::path& folder) {
  return {DrawTorques(data, outcome, folder / "torques"),
          DrawShares(data, outcome, folder / "share_of_joints"),
          DrawSamples(data, outcome, folder / "samples"), DrawRoc(outcome, folder / "roc"),
          DrawConfusions(outcome, folder / "confusion")};
}

}  // namespace strainwave::bench
