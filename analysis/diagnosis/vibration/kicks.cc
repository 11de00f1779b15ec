// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/kicks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/ring_match.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr double kLeastKick = 22.0;  // drop of the sum of squares, in variances of the noise
constexpr std::size_t kMostKicks = 10;
constexpr std::size_t kMostFirstKicks = 5;
// What dies away within two periods is a spike, which any frequency makes as well.
constexpr double kMostDamping = 0.08;
// Of a scan of frequencies: a width of the resonance apart.
constexpr double kScanDamping = 0.012;
constexpr double kNextFrequency = 1.015;
constexpr double kNoticed = 12.0;  // drop of a kick that counts, in variances of the noise
constexpr double kApart = 1.1;     // of two frequencies

std::vector<Knock> KnocksOf(const VibrationTerm& term) {
  std::vector<Knock> knocks{{term.shapes[2], 1.0}};
  for (std::size_t s = 3; s + 1 < term.shapes.size(); s += 2)
    knocks.push_back({term.shapes[s], term.shapes[s + 1]});
  return knocks;
}

// The term with other knocks; the height of the first is its unit.
VibrationTerm WithKnocks(VibrationTerm term, const std::vector<Knock>& knocks) {
  term.shapes.resize(2);
  term.shapes.push_back(knocks[0].start_s);
  for (std::size_t k = 1; k < knocks.size(); ++k) {
    term.shapes.insert(term.shapes.end(), {knocks[k].start_s, knocks[k].height / knocks[0].height});
  }
  return term;
}

// Adds knocks, loudest first, as long as they pay; refines for so many rounds after each.
TermFit AddKicks(const VibrationRemainder& remainder, TermFit solution, int rounds) {
  const VibrationRun& run = remainder.samples().runs.front();
  while (KnockCount(solution.term) < kMostKicks) {
    const Eigen::VectorXd left = remainder.ResidualOf(solution);
    const double frequency_Hz = solution.term.shapes[0];
    const double damping = solution.term.shapes[1];
    // The mode moves all channels in the proportion that the knocks so far show.
    std::vector<double> gains;
    for (const TermFit::Channel& channel : solution.channels) {
      gains.push_back(channel.coefficients.size() == 0 ? 0.0 : channel.coefficients(0));
    }
    const Kick kick = LoudestKick(
        SideBySide(run, {left.data(), static_cast<std::size_t>(left.size())}, remainder.solver().weights()),
        frequency_Hz, damping, gains);
    if (!(kick.drop > kLeastKick * solution.variance())) break;
    const Knock more{run.time_s[kick.sample], kick.height};
    std::vector<Knock> knocks = KnocksOf(solution.term);
    const auto nearest = std::ranges::min_element(
        knocks, {}, [&](const Knock& knock) { return std::abs(knock.start_s - more.start_s); });
    std::optional<TermFit> moved;
    // Within half a period of one that is there it says that this one stands elsewhere.
    if (std::abs(nearest->start_s - more.start_s) < 0.5 / frequency_Hz) {
      std::vector<Knock> others = knocks;
      Knock& own = others[static_cast<std::size_t>(nearest - knocks.begin())];
      own = OneOf(own, more, frequency_Hz, damping);
      moved = remainder.With(WithKnocks(solution.term, others), rounds);
    }
    knocks.push_back(more);
    TermFit richer = remainder.With(WithKnocks(solution.term, knocks), rounds);
    if (moved && moved->bic() < richer.bic()) richer = std::move(*moved);
    if (richer.bic() > solution.bic() - 2.0) break;
    solution = std::move(richer);
  }
  return solution;
}

// Takes out knocks that do not pay any more with the others refined.
TermFit DropKicks(const VibrationRemainder& remainder, TermFit solution) {
  for (std::size_t k = 0; k < KnockCount(solution.term) && KnockCount(solution.term) > 1;) {
    std::vector<Knock> fewer = KnocksOf(solution.term);
    fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(k));
    TermFit without = remainder.With(WithKnocks(solution.term, fewer), 0);
    // What is far behind does not catch up.
    if (without.bic() < solution.bic() + 40.0) without = remainder.Refine(std::move(without), 4);
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

std::size_t KnockCount(const VibrationTerm& term) {
  return term.form == VibrationForm::kKicks ? (term.shapes.size() - 1) / 2 : 0;
}

std::vector<double> FindKickedFrequencies(const VibrationRemainder& remainder, double lowest_Hz,
                                          double highest_Hz, std::size_t count) {
  const VibrationSamples& samples = remainder.samples();
  if (samples.runs.size() != 1) return {};
  const VibrationRun& run = samples.runs.front();
  const double variance = remainder.base().variance();
  const double highest = std::min(highest_Hz, 0.97 * samples.highest_Hz());
  std::vector<std::pair<double, double>> kicked;  // power, frequency
  // A ring has to die away within the record.
  for (double frequency_Hz = std::max(lowest_Hz, 1.0 / (kScanDamping * run.span_s())); frequency_Hz < highest;
       frequency_Hz *= kNextFrequency) {
    const double power =
        KickPower(remainder.side_by_side(0), frequency_Hz, kScanDamping, kNoticed * variance);
    if (power > 0.0) kicked.emplace_back(power, frequency_Hz);
  }
  std::ranges::sort(kicked, std::greater<>());
  std::vector<double> frequencies_Hz;
  for (const auto& [power, frequency_Hz] : kicked) {
    if (frequencies_Hz.size() == count) break;
    const bool near = std::ranges::any_of(frequencies_Hz, [&](double other_Hz) {
      return std::abs(std::log(frequency_Hz / other_Hz)) < std::log(kApart);
    });
    if (!near) frequencies_Hz.push_back(frequency_Hz);
  }
  return frequencies_Hz;
}

std::optional<TermFit> SearchKicks(const VibrationRemainder& remainder, std::size_t index,
                                   double frequency_Hz) {
  const VibrationSamples& samples = remainder.samples();
  if (samples.runs.size() != 1) return std::nullopt;
  const VibrationRun& run = samples.runs.front();
  std::vector<std::pair<double, VibrationTerm>> firsts;  // drop, one knock
  for (const double share : {0.97, 0.985, 1.0, 1.015, 1.03}) {
    for (const double damping : {0.005, 0.015, 0.05}) {
      VibrationTerm term;
      term.cause = index;
      term.form = VibrationForm::kKicks;
      term.heard.assign(samples.channels(), 1);
      const Kick kick = LoudestKick(remainder.side_by_side(0), share * frequency_Hz, damping);
      if (kick.drop < kLeastKick * remainder.base().variance()) continue;
      term.shapes = {share * frequency_Hz, damping, run.time_s[kick.sample]};
      firsts.emplace_back(kick.drop, std::move(term));
    }
  }
  std::sort(firsts.begin(), firsts.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  firsts.resize(std::min(firsts.size(), kMostFirstKicks));
  // One knock alone, refined, bends frequency and damping until it stands for a second one as well: all
  // are found first.
  Best start;
  for (const auto& [drop, term] : firsts) {
    TermFit own = AddKicks(remainder, remainder.With(term, 0), 0);
    // So many that there would be more: what drives it never stops.
    if (KnockCount(own.term) == kMostKicks) break;
    Keep(std::move(own), start);
  }
  if (!start) return std::nullopt;
  TermFit kicks = DropKicks(remainder, AddKicks(remainder, remainder.With(start->term, 10), 4));
  if (kicks.term.shapes[1] > kMostDamping) return std::nullopt;
  return kicks;
}

}  // namespace strainwave::analysis::diagnosis
