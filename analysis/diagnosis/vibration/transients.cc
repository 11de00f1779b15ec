// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/transients.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/impulse_train_match.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr double kLeastTransient = 22.0;  // drop of the sum of squares, in variances of the noise
constexpr std::size_t kMostTransients = 10;
constexpr std::size_t kMostFirstTransients = 5;
// What dies away within two periods is a spike, which any frequency makes as well.
constexpr double kMostDamping = 0.08;
// Of a scan of frequencies: a width of the resonance apart.
constexpr double kScanDamping = 0.012;
constexpr double kNextFrequency = 1.015;
constexpr double kNoticed = 12.0;  // drop of a transient that counts, in variances of the noise
constexpr double kApart = 1.1;     // of two frequencies

std::vector<Impact> ImpactsOf(const VibrationTerm& term) {
  std::vector<Impact> impacts{{term.nonlinear_parameters[2], 1.0}};
  for (std::size_t s = 3; s + 1 < term.nonlinear_parameters.size(); s += 2)
    impacts.push_back({term.nonlinear_parameters[s], term.nonlinear_parameters[s + 1]});
  return impacts;
}

// The term with other impacts; the height of the first is its unit.
VibrationTerm WithImpacts(VibrationTerm term, const std::vector<Impact>& impacts) {
  term.nonlinear_parameters.resize(2);
  term.nonlinear_parameters.push_back(impacts[0].start_s);
  for (std::size_t k = 1; k < impacts.size(); ++k) {
    term.nonlinear_parameters.insert(term.nonlinear_parameters.end(),
                                     {impacts[k].start_s, impacts[k].height / impacts[0].height});
  }
  return term;
}

// Adds impacts, largest first, as long as they pay; refines for so many rounds after each.
TermFit AddTransients(const VibrationResidual& residual, TermFit solution, int rounds) {
  const VibrationRun& run = residual.samples().runs.front();
  while (ImpactCount(solution.term) < kMostTransients) {
    const Eigen::VectorXd left = residual.ResidualOf(solution);
    const double frequency_Hz = solution.term.nonlinear_parameters[0];
    const double damping = solution.term.nonlinear_parameters[1];
    // The mode moves all channels in the proportion that the impacts so far show.
    std::vector<double> gains;
    for (const TermFit::Channel& channel : solution.channels) {
      gains.push_back(channel.coefficients.size() == 0 ? 0.0 : channel.coefficients(0));
    }
    const Transient transient = LargestTransient(
        SideBySide(run, {left.data(), static_cast<std::size_t>(left.size())}, residual.solver().weights()),
        frequency_Hz, damping, gains);
    if (!(transient.drop > kLeastTransient * solution.variance())) break;
    const Impact more{run.time_s[transient.sample], transient.height};
    std::vector<Impact> impacts = ImpactsOf(solution.term);
    const auto nearest = std::ranges::min_element(
        impacts, {}, [&](const Impact& impact) { return std::abs(impact.start_s - more.start_s); });
    std::optional<TermFit> moved;
    // Within half a period of one that is there it says that this one stands elsewhere.
    if (std::abs(nearest->start_s - more.start_s) < 0.5 / frequency_Hz) {
      std::vector<Impact> others = impacts;
      Impact& own = others[static_cast<std::size_t>(nearest - impacts.begin())];
      own = OneOf(own, more, frequency_Hz, damping);
      moved = residual.With(WithImpacts(solution.term, others), rounds);
    }
    impacts.push_back(more);
    TermFit richer = residual.With(WithImpacts(solution.term, impacts), rounds);
    if (moved && moved->bic() < richer.bic()) richer = std::move(*moved);
    if (richer.bic() > solution.bic() - 2.0) break;
    solution = std::move(richer);
  }
  return solution;
}

// Takes out impacts that do not pay any more with the others refined.
TermFit DropTransients(const VibrationResidual& residual, TermFit solution) {
  for (std::size_t k = 0; k < ImpactCount(solution.term) && ImpactCount(solution.term) > 1;) {
    std::vector<Impact> fewer = ImpactsOf(solution.term);
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    TermFit without = residual.With(WithImpacts(solution.term, fewer), 0);
    // What is dominated does not catch up.
    if (without.bic() < solution.bic() + 40.0) without = residual.Refine(std::move(without), 4);
    if (without.bic() > solution.bic() + 2.0) {
      ++k;
      continue;
    }
    solution = std::move(without);
    k = 0;
  }
  return solution;
}

}  // namespace

std::size_t ImpactCount(const VibrationTerm& term) {
  return term.form == VibrationForm::kTransients ? (term.nonlinear_parameters.size() - 1) / 2 : 0;
}

std::vector<double> FindExcitedFrequencies(const VibrationResidual& residual, double lowest_Hz,
                                           double highest_Hz, std::size_t count) {
  const VibrationSamples& samples = residual.samples();
  if (samples.runs.size() != 1) return {};
  const VibrationRun& run = samples.runs.front();
  const double variance = residual.base().variance();
  const double highest = std::min(highest_Hz, 0.97 * samples.highest_Hz());
  std::vector<std::pair<double, double>> excited;  // power, frequency
  // A response has to die away within the record.
  for (double frequency_Hz = std::max(lowest_Hz, 1.0 / (kScanDamping * run.span_s())); frequency_Hz < highest;
       frequency_Hz *= kNextFrequency) {
    const double power =
        TransientPower(residual.side_by_side(0), frequency_Hz, kScanDamping, kNoticed * variance);
    if (power > 0.0) excited.emplace_back(power, frequency_Hz);
  }
  std::ranges::sort(excited, std::greater<>());
  std::vector<double> frequencies_Hz;
  for (const auto& found : excited) {
    if (frequencies_Hz.size() == count) break;
    const double frequency_Hz = found.second;
    const bool near = std::ranges::any_of(frequencies_Hz, [&](double other_Hz) {
      return std::abs(std::log(frequency_Hz / other_Hz)) < std::log(kApart);
    });
    if (!near) frequencies_Hz.push_back(frequency_Hz);
  }
  return frequencies_Hz;
}

std::optional<TermFit> SearchTransients(const VibrationResidual& residual, std::size_t index,
                                        double frequency_Hz) {
  const VibrationSamples& samples = residual.samples();
  if (samples.runs.size() != 1) return std::nullopt;
  const VibrationRun& run = samples.runs.front();
  std::vector<std::pair<double, VibrationTerm>> firsts;  // drop, one impact
  for (const double share : {0.97, 0.985, 1.0, 1.015, 1.03}) {
    for (const double damping : {0.005, 0.015, 0.05}) {
      VibrationTerm term;
      term.cause = index;
      term.form = VibrationForm::kTransients;
      term.observable.assign(samples.channels(), 1);
      const Transient transient = LargestTransient(residual.side_by_side(0), share * frequency_Hz, damping);
      if (transient.drop < kLeastTransient * residual.base().variance()) continue;
      term.nonlinear_parameters = {share * frequency_Hz, damping, run.time_s[transient.sample]};
      firsts.emplace_back(transient.drop, std::move(term));
    }
  }
  std::sort(firsts.begin(), firsts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  firsts.resize(std::min(firsts.size(), kMostFirstTransients));
  // One impact alone, refined, bends frequency and damping until it stands for a second one as well: all
  // are found first.
  Best start;
  for (const auto& [drop, term] : firsts) {
    TermFit own = AddTransients(residual, residual.With(term, 0), 0);
    // So many that there would be more: what drives it never stops.
    if (ImpactCount(own.term) == kMostTransients) break;
    Keep(std::move(own), start);
  }
  if (!start) return std::nullopt;
  TermFit transients = DropTransients(residual, AddTransients(residual, residual.With(start->term, 10), 4));
  if (transients.term.nonlinear_parameters[1] > kMostDamping) return std::nullopt;
  return transients;
}

}  // namespace strainwave::analysis::diagnosis
