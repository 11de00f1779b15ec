// SPDX-License-Identifier: Apache-2.0
// What speaks for each candidate, and the set of all pictures.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "bench/diagnosis/diagnosis_pictures.h"
#include "bench/diagnosis/picture_frame.h"
#include "bench/diagnosis/power_report.h"
#include "bench/diagnosis/residual_views.h"
#include "bench/diagnosis/trust_report.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/script.h"

namespace strainwave::bench {
namespace {

namespace diagnosis = analysis::diagnosis;

// Evidence spans many decades and both signs: its logarithm, straight about zero.
double Squeezed(double delta_bic) { return std::asinh(0.5 * delta_bic) / std::log(10.0); }

}  // namespace

std::filesystem::path DrawCandidates(const DiagnosisReport& report, const std::filesystem::path& stem) {
  constexpr std::size_t kMostShown = 24;
  constexpr std::size_t kLongestObjection = 60;
  constexpr int kWidth_px = 1200;
  const auto& candidates = report.result.candidates;
  const std::size_t shown = std::min(candidates.size(), kMostShown);
  const double height = 130.0 + 34.0 * static_cast<double>(std::max<std::size_t>(shown, 1));
  // Bars of those that passed, and of the others: left, right, lower and upper edge.
  std::vector<double> bars[2][4];
  std::string names;
  std::string labels;
  std::size_t longest_name = 0;
  double longest = Squeezed(20.0);
  double shortest = 0.0;
  bool by_p_value = false;  // one has passed by that alone
  for (std::size_t k = 0; k < shown; ++k) {
    const diagnosis::CandidateResult& candidate = candidates[k];
    const double y = -static_cast<double>(k);
    const double x =
        Squeezed(std::isfinite(candidate.evidence.delta_bic) ? candidate.evidence.delta_bic : 0.0);
    auto& edges = bars[candidate.passed ? 0 : 1];
    edges[0].push_back(std::min(0.0, x));
    edges[1].push_back(std::max(0.0, x));
    edges[2].push_back(y - 0.36);
    edges[3].push_back(y + 0.36);
    longest = std::max(longest, x);
    shortest = std::min(shortest, x);
    by_p_value = by_p_value || (candidate.passed && x < 0.0);
    const std::string name = CandidateName(*report.input.study, candidate.index);
    longest_name = std::max(longest_name, name.size());
    names += fmt::format("{}{} {:g}", k == 0 ? "" : ", ", Quoted(name), y);
    const std::string words = candidate.passed ? "passed, p " + ProbabilityText(candidate.evidence.p_value)
                                               : candidate.objection.substr(0, kLongestObjection);
    labels +=
        fmt::format("set label {} at first {:.5g},{:.5g} left offset 0.8,0 font ',13' textcolor rgb '{}'\n",
                    Quoted(words), std::max(0.0, x), y, candidate.passed ? kFirstColour.dark : "#666666");
  }
  std::string tics;
  for (const double level : {-1000.0, -100.0, -10.0, 0.0, 10.0, 100.0, 1000.0, 1e4, 1e5, 1e6}) {
    if (Squeezed(level) < shortest - 0.3 || Squeezed(level) > longest + 0.3) continue;
    tics += fmt::format("{}'{:g}' {:.5g}", tics.empty() ? "" : ", ", level, Squeezed(level));
  }
  std::string script = CommonStyle();
  script += TitleLabel(TitleOf(report, "what speaks for each candidate"), height);
  script += MarginsBesideNames(longest_name, kWidth_px, height);
  // Room on the right for the words.
  script +=
      fmt::format("set xrange [{:.5g}:{:.5g}]\nset yrange [{:.5g}:0.6]\nset xtics ({})\n", shortest - 0.1,
                  longest + 0.75 * (longest - shortest), -static_cast<double>(shown) + 0.4, tics);
  script += fmt::format("set ytics ({}) scale 0\nunset key\nunset grid\n", names);
  script += fmt::format(
      "set xlabel 'evidence: BIC without it - BIC with it (above 10: strong; {}in brackets: not a cause)'\n",
      by_p_value ? "or a low p; " : "");
  script +=
      "set arrow from first 0, graph 0 to first 0, graph 1 nohead linewidth 1 linecolor rgb '#444444' "
      "front\n";
  script += labels;
  std::string plot;
  for (const int group : {0, 1}) {
    const auto& edges = bars[group];
    if (edges[0].empty()) continue;
    script += DataBlock(fmt::format("bars{}", group), {edges[0], edges[1], edges[2], edges[3]});
    plot +=
        fmt::format("{} $bars{} using (0.5*($1+$2)):(0.5*($3+$4)):1:2:3:4 with boxxyerror linecolor rgb '{}'",
                    plot.empty() ? "plot" : ",", group, group == 0 ? kFirstColour.plain : "#BBBBBB");
  }
  script += "set style fill solid 1 noborder\n" + plot + "\n";
  return RenderPicture(script, stem, {.width_px = kWidth_px, .height_px = static_cast<int>(height)});
}

std::vector<std::filesystem::path> DrawDiagnosis(const DiagnosisReport& report,
                                                 const std::filesystem::path& folder,
                                                 const std::function<void(double)>& progress) {
  const std::vector<diagnosis::Regressor>& regressors = report.input.study->regressors();
  std::vector<std::filesystem::path> pictures;
  const double all = (report.power ? 6.0 : 5.0) + static_cast<double>(regressors.size());
  const auto add = [&](const std::string& name, const auto& draw) {
    pictures.push_back(draw(folder / name));
    if (progress) progress(static_cast<double>(pictures.size()) / all);
  };
  const bool campaign = report.input.campaign.has_value();
  add("measured_over_simulated", [&](const auto& stem) {
    return campaign ? DrawCampaignResults(report, stem) : DrawResponse(report, stem);
  });
  if (!campaign) add("residual", [&](const auto& stem) { return DrawResidual(report, stem); });
  std::vector<std::size_t> order;
  for (const RegressorShare& share : SharesByRegressor(report)) order.push_back(share.index);
  for (std::size_t k = 0; k < regressors.size(); ++k) {
    if (std::ranges::find(order, k) == order.end()) order.push_back(k);
  }
  for (const std::size_t k : order) {
    add("residual_over_" + regressors[k].name, [&](const auto& stem) {
      return campaign ? DrawCampaignResiduals(report, k, stem) : DrawResidualOver(report, k, stem);
    });
  }
  if (!campaign) add("order_spectrum", [&](const auto& stem) { return DrawResidualSpectrum(report, stem); });
  if (HasTrustedRegions(report))
    add("trusted_regions", [&](const auto& stem) { return DrawTrustedRegions(report, stem); });
  if (!report.result.candidates.empty()) {
    add("candidates", [&](const auto& stem) { return DrawCandidates(report, stem); });
  }
  if (report.power && report.power->refusal.empty()) {
    add("detection_power", [&](const auto& stem) { return DrawDetectionPower(report, stem); });
  }
  return pictures;
}

}  // namespace strainwave::bench
