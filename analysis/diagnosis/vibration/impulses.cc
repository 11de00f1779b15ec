// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/impulses.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "analysis/diagnosis/vibration/chance.h"
#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/impulse_train_match.h"
#include "analysis/diagnosis/vibration/pulses.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Best = std::optional<TermFit>;

constexpr std::size_t kMostStarts = 24;
constexpr std::size_t kMostFitted = 8;
constexpr std::size_t kMostRefined = 3;
constexpr double kFirstDamping = 0.03;
constexpr int kClimbs = 4;
// −ln p of what a train has to explain beyond its strongest line: one in a hundred lines may pass for one of
// some two hundred trains that have it among their harmonics. And more than a line that is no pure sine
// leaves: where the speed modulated with the shaft, it has lines of its own at one order to either side.
constexpr double kBeyondLine = 7.0;
constexpr double kBeyondLineShare = 0.01;
constexpr double kBesideLineShare = 0.05;
constexpr double kPartOfFirst = 0.3;  // of that, for a first fit
// Depth of a change: an impulse does not pull. With what noise adds to it.
constexpr double kDeepest = 1.3;

double TurnHz(const VibrationResidual& residual) {
  return residual.samples().runs.front().mean_speed_rad_per_s / kTwoPi;
}

// A train while it is searched for, in the first record.
struct TrainCandidate {
  ImpulseTrain train;
  double sideband{};
  double relative_noise{1.0};
  TrainMatch match;
  double excess{};
};

TrainCandidate CandidateOf(const VibrationResidual& residual, ImpulseTrain train, double sideband,
                           double relative_noise) {
  const VibrationRun& run = residual.samples().runs.front();
  const TrainMatch match =
      MatchTrain(residual.side_by_side(0), train, sideband, relative_noise * residual.base().variance());
  // An amplitude a channel and their phase; two more of a change.
  const double cells = 0.5 * (static_cast<double>(run.channels.size()) + 1.0) + (sideband > 0.0 ? 1.0 : 0.0);
  return {std::move(train), sideband, relative_noise, match, ExcessOf(match.power, cells)};
}

// The best train about a start: order, resonance and damping in turn, by steps that become smaller.
class Climb {
 public:
  Climb(const VibrationResidual& residual, const TrainStart& start, const std::vector<double>& modulations)
      : residual_(&residual),
        best_(CandidateOf(residual, {start.order, start.resonance_Hz, kFirstDamping, 0.0, {}, {}}, 0.0,
                          start.relative_noise)) {
    for (const double sideband : modulations) {
      if (sideband < kLargestSideband * start.order) Take(best_.train, sideband);
    }
  }

  const TrainCandidate& best() const { return best_; }
  double excess() const { return best_.excess; }

  void Step() {
    bool moved = false;
    const auto both_ways = [&](const auto& change) {
      for (const double sense : {-1.0, 1.0}) {
        ImpulseTrain train = best_.train;
        change(train, sense * size_);
        moved = Take(std::move(train), best_.sideband) || moved;
      }
    };
    both_ways([](ImpulseTrain& train, double by) { train.resonance_Hz *= 1.0 + by * train.damping_ratio; });
    both_ways([](ImpulseTrain& train, double by) { train.damping_ratio *= std::exp2(by); });
    both_ways([&](ImpulseTrain& train, double by) {
      const double cell =
          train.order * TurnHz(*residual_) / (residual_->samples().runs.front().turns * train.resonance_Hz);
      train.order += 0.4 * by * cell;
    });
    if (!moved) size_ *= 0.5;
  }

 private:
  bool Take(ImpulseTrain train, double sideband) {
    if (train.resonance_Hz > 0.97 * residual_->samples().highest_Hz() ||
        train.damping_ratio < kLeastTrainDamping || train.damping_ratio > kMostTrainDamping)
      return false;
    TrainCandidate next = CandidateOf(*residual_, std::move(train), sideband, best_.relative_noise);
    if (next.excess <= best_.excess) return false;
    best_ = std::move(next);
    return true;
  }

  const VibrationResidual* residual_;
  TrainCandidate best_;
  double size_{1.0};
};

// The strongest come first; with each step the weakest third of those that are more than `most` give up.
std::vector<TrainCandidate> ClimbFrom(const VibrationResidual& residual,
                                      const std::vector<TrainStart>& starts,
                                      const std::vector<double>& modulations, std::size_t most) {
  std::vector<std::optional<Climb>> made(starts.size());
  residual.parallel()(starts.size(),
                      [&](std::size_t i) { made[i].emplace(residual, starts[i], modulations); });
  std::vector<Climb> climbs;
  for (std::optional<Climb>& climb : made) climbs.push_back(*std::move(climb));
  for (int step = 0; step < kClimbs; ++step) {
    residual.parallel()(climbs.size(), [&](std::size_t i) { climbs[i].Step(); });
    std::ranges::stable_sort(climbs, std::greater<>(), &Climb::excess);
    climbs.erase(climbs.begin() + static_cast<std::ptrdiff_t>(std::min(
                                      climbs.size(), std::max(most, climbs.size() - climbs.size() / 3))),
                 climbs.end());
  }
  std::vector<TrainCandidate> candidates;
  for (const Climb& climb : climbs) candidates.push_back(climb.best());
  candidates.resize(std::min(candidates.size(), most));
  return candidates;
}

// Of the noise that a train has to stand out of.
double VarianceAbout(const VibrationResidual& residual, const TermFit& train) {
  return train.variance() * residual.RelativeNoiseAt(train.term.nonlinear_parameters[1]);
}

bool IsTooDeep(const VibrationTerm& train) {
  for (std::size_t m = 0; m < train.lines.size(); ++m) {
    if (std::hypot(train.nonlinear_parameters[3 + 2 * m], train.nonlinear_parameters[4 + 2 * m]) > kDeepest)
      return true;
  }
  return false;
}

void Take(LeastLikelyChance& best, TermFit fit) {
  if (!IsTooDeep(fit.term)) best.Take(std::move(fit), 0.0);
}

// The same train with impulses that come so many periods of its resonance later.
VibrationTerm Later(const VibrationResidual& residual, VibrationTerm train, double periods) {
  for (std::size_t r = 3 + 2 * train.lines.size(); r < train.nonlinear_parameters.size(); ++r)
    train.nonlinear_parameters[r] +=
        periods * train.nonlinear_parameters[0] * TurnHz(residual) / train.nonlinear_parameters[1];
  return train;
}

// The steps of a candidate's resonance and damping leave open in which half period of the resonance the
// impulses begin.
TermFit FitCandidate(const VibrationResidual& residual, std::size_t index, const TrainCandidate& candidate) {
  const VibrationSamples& samples = residual.samples();
  VibrationTerm term;
  term.cause = index;
  term.form = VibrationForm::kImpulseTrain;
  term.observable.assign(samples.channels(), 1);
  term.nonlinear_parameters = {candidate.train.order, candidate.train.resonance_Hz,
                               candidate.train.damping_ratio};
  if (candidate.sideband > 0.0) {
    term.lines = {{0.0, candidate.sideband}};
    term.nonlinear_parameters.insert(term.nonlinear_parameters.end(),
                                     {candidate.match.cosine, candidate.match.sine});
  }
  term.nonlinear_parameters.push_back(candidate.match.phase);
  for (std::size_t r = 1; r < samples.runs.size(); ++r) {
    term.nonlinear_parameters.push_back(
        MatchTrain(residual.side_by_side(r), candidate.train, 0.0, residual.base().variance()).phase);
  }
  LeastLikelyChance best(residual);
  for (const double periods : {0.0, -1.0, -0.5, 0.5, 1.0})
    Take(best, residual.With(Later(residual, term, periods), 0));
  return best.fit() ? *std::move(best).fit() : residual.With(std::move(term), 0);
}

// A train whose resonance passes one of its harmonics alone is a line with too many numbers.
// @param part  of what it has to explain beyond the line that counts yet
bool IsOneLine(const VibrationResidual& residual, const TermFit& solution, double part) {
  const VibrationTerm& train = solution.term;
  VibrationTerm line;
  line.cause = train.cause;
  line.form = VibrationForm::kLines;
  line.observable = train.observable;
  line.lines = {{1.0, 0.0}};
  line.nonlinear_parameters = {train.nonlinear_parameters[0] *
                               StrongestHarmonic(residual, train.nonlinear_parameters[0])};
  const TermFit alone = residual.With(std::move(line), 3);
  const double variance = VarianceAbout(residual, solution);
  const double by_line = (residual.base().square_sum - alone.square_sum) / variance;
  const bool modulated = !train.lines.empty() && train.lines[0].offset == 1.0;
  const double share = modulated ? kBesideLineShare : kBeyondLineShare;
  const double beyond = (alone.square_sum - solution.square_sum) / variance - part * share * by_line;
  // A line has a phase in each channel: it may have more numbers, each of which takes its part of the noise.
  const double more = solution.free_parameters - alone.free_parameters;
  const double numbers = std::max(1.0, more);
  return ExcessOf(0.5 * (beyond + numbers - more), 0.5 * numbers) < part * kBeyondLine;
}

// Refines a first fit, half a period of the resonance and a whole one to both sides; without a modulation and
// with each: the fit's may be the wrong one.
void Improve(const VibrationResidual& residual, TermFit candidate, const std::vector<double>& modulations,
             LeastLikelyChance& best) {
  Best own = residual.Refine(std::move(candidate), 12);
  Best beside;
  for (const double periods : {-1.0, -0.5, 0.5, 1.0})
    Keep(residual.With(Later(residual, own->term, periods), 2), beside);
  Keep(residual.Refine(std::move(*beside), 4), own);
  VibrationTerm even = own->term;
  const double change = even.lines.empty() ? 0.0 : even.lines[0].offset;
  Take(best, std::move(*own));
  if (change > 0.0) {
    even.lines.clear();
    even.nonlinear_parameters.erase(even.nonlinear_parameters.begin() + 3,
                                    even.nonlinear_parameters.begin() + 5);
    Take(best, residual.With(even, 6));
  }
  for (const double modulation : modulations) {
    if (modulation == change || modulation > kLargestSideband * even.nonlinear_parameters[0]) continue;
    VibrationTerm term = even;
    term.lines = {{0.0, modulation}};
    // A channel that the even impulses did not pay for may pay now.
    term.observable.assign(term.observable.size(), 1);
    term.nonlinear_parameters.insert(term.nonlinear_parameters.begin() + 3, {0.0, 0.0});
    Take(best, residual.With(std::move(term), 8));
  }
}

}  // namespace

int StrongestHarmonic(const VibrationResidual& residual, double order) {
  const VibrationSpectrum& spectrum = residual.over_turns();
  int strongest = 1;
  for (int k = 2; k * order < spectrum.highest(); ++k) {
    if (spectrum.At(k * order) > spectrum.At(strongest * order)) strongest = k;
  }
  return strongest;
}

Best SearchImpulses(const VibrationResidual& residual, std::size_t index,
                    const std::vector<TrainStart>& starts, const std::vector<double>& modulations,
                    const std::function<bool(double order)>& allowed) {
  std::vector<TrainStart> below_half_the_rate;
  for (const TrainStart& start : starts) {
    if (below_half_the_rate.size() == kMostStarts) break;
    if (start.resonance_Hz < 0.97 * residual.samples().highest_Hz()) below_half_the_rate.push_back(start);
  }
  const std::vector<TrainCandidate> candidates =
      ClimbFrom(residual, below_half_the_rate, modulations, kMostFitted);
  std::vector<std::pair<double, TermFit>> fits(candidates.size());  // by improbability
  residual.parallel()(candidates.size(), [&](std::size_t i) {
    auto& [improbability, fit] = fits[i];
    fit = residual.Refine(FitCandidate(residual, index, candidates[i]), 3);
    improbability = ImprobabilityOf(residual, fit);
  });
  std::ranges::sort(fits, std::greater<>(), &std::pair<double, TermFit>::first);
  LeastLikelyChance best(residual);
  std::size_t refined = 0;
  for (auto& [improbability, fit] : fits) {
    if (refined == kMostRefined) break;
    // A line is every train that has it among its harmonics: these are not to hide another train.
    if (IsOneLine(residual, fit, kPartOfFirst)) continue;
    LeastLikelyChance improved(residual);
    Improve(residual, std::move(fit), modulations, improved);
    ++refined;
    if (improved.fit() && !IsOneLine(residual, *improved.fit(), 1.0)) Take(best, *std::move(improved).fit());
  }
  if (!best.fit()) return std::nullopt;
  // Every second impulse, or each twice: the same harmonics, or half of them.
  const VibrationTerm found = best.fit()->term;
  for (const double multiple : {0.5, 2.0, 3.0}) {
    const double order = multiple * found.nonlinear_parameters[0];
    if (!allowed(order)) continue;
    const TrainStart start{order, found.nonlinear_parameters[1], 0.0, 0.0, 1.0};
    TermFit fit = FitCandidate(residual, index, ClimbFrom(residual, {start}, modulations, 1).front());
    // A candidate that is dominated does not catch up.
    if (fit.bic() < best.fit()->bic() + 60.0) Improve(residual, std::move(fit), modulations, best);
  }
  if (IsOneLine(residual, *best.fit(), 1.0)) return std::nullopt;
  return std::move(best).fit();
}

TermFit SearchPulses(const VibrationResidual& residual, std::size_t index, double order, double slow_order) {
  const VibrationSamples& samples = residual.samples();
  const std::vector<char> all(samples.channels(), 1);
  std::vector<PulseLines> lines;
  for (const VibrationRun& run : samples.runs)
    lines.emplace_back(run, order, residual.residual(), residual.solver().weights());
  Best start;
  for (const double width : {0.02, 0.03, 0.045, 0.065, 0.1, 0.15}) {
    VibrationTerm term{index, VibrationForm::kPulses, {{width, order}}, {}, all};
    const int harmonics = PulseHarmonics(width, order, samples.highest_order());
    for (const PulseLines& of_run : lines)
      term.nonlinear_parameters.push_back(of_run.BestPhase(width, harmonics));
    Keep(residual.WithAllChannels(std::move(term), 0), start);
  }
  LeastLikelyChance best(residual);
  const auto take = [&](VibrationTerm term, int rounds) {
    term.observable = all;
    best.TakeWithAndWithoutUnobservable(residual.WithAllChannels(std::move(term), rounds), 0.0);
  };
  take(start->term, 6);
  if (slow_order != 0.0) {
    VibrationTerm changing = best.fit()->term;
    changing.lines.push_back({0.0, slow_order});
    changing.nonlinear_parameters.insert(changing.nonlinear_parameters.begin(), {0.0, 0.0});
    take(std::move(changing), 8);
  }
  VibrationTerm free = best.fit()->term;
  free.nonlinear_parameters.insert(free.nonlinear_parameters.begin(),
                                   std::exchange(free.lines[0].harmonic, 0.0));
  take(std::move(free), 8);
  return std::move(*std::move(best).fit());
}

}  // namespace strainwave::analysis::diagnosis
