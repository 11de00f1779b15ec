// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/speed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "analysis/diagnosis/vibration/channel_fits.h"
#include "analysis/diagnosis/vibration/shaft.h"
#include "analysis/diagnosis/vibration/spectrum.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLagWorthSaying = 1.0;     // sampling periods
constexpr double kMostLag_s = 0.1;          // of a drive's filters and its bus
constexpr double kLeastSpreadOfLag = 0.02;  // of the mean speed
constexpr double kClearly = 3.0;            // standard errors
constexpr std::size_t kMostPairs = 6;
constexpr double kClearLine = 9.0;  // −ln p of one line at a known order, beyond what a channel gives

Eigen::Map<const VectorXd> Response(const VibrationSamples& samples, const VibrationRun& run,
                                    const VibrationSegment& channel) {
  return {samples.measured.data() + channel.first, static_cast<Index>(run.size())};
}

std::vector<double> LessMeans(const VibrationSamples& samples) {
  std::vector<double> centred(samples.measured);
  for (const VibrationRun& run : samples.runs) {
    for (const VibrationSegment& channel : run.channels) {
      const double mean = Response(samples, run, channel).mean();
      for (std::size_t i = 0; i < run.size(); ++i) centred[channel.first + i] -= mean;
    }
  }
  return centred;
}

double PairExcess(const VibrationSpectrum& spectrum, double order) {
  const auto channels = static_cast<double>(spectrum.channels());
  return ExcessOf(spectrum.At(order), channels) + ExcessOf(spectrum.At(2.0 * order), channels);
}

bool BothLines(const VibrationSpectrum& spectrum, double order) {
  const auto channels = static_cast<double>(spectrum.channels());
  return ExcessOf(spectrum.At(order), channels) > kClearLine &&
         ExcessOf(spectrum.At(2.0 * order), channels) > kClearLine;
}

double BestPair(const VibrationSpectrum& spectrum, double centre, double share) {
  double best = centre;
  const double step = 0.25 * spectrum.step();
  for (double order = centre * (1.0 - share); order <= centre * (1.0 + share); order += step) {
    if (PairExcess(spectrum, order) > PairExcess(spectrum, best) + 1e-9) best = order;
  }
  return best;
}

// Turns the angle and everything that depends on it into another one.
void TakeAngle(VibrationRun& run, const VectorXd& angle) {
  for (std::size_t i = 0; i < run.size(); ++i) run.angle_rad[i] = angle(static_cast<Index>(i)) - angle(0);
  FindSpeeds(run);
  FillNominal(run);
}

struct PhaseFit {
  double square_sum{};
  double line_energy[2]{};  // of the lines at 1 and 2 per turn
  VectorXd phase;           // coefficients of the basis
  MatrixXd normal;
};

// Change of the shaft's line at 1 or 2 per turn by the angle.
VectorXd SlopeOf(const MatrixXd& columns, const ChannelFit& fit, Index line) {
  const Index c = 2 * line - 1;
  return static_cast<double>(line) *
         (fit.coefficients(c + 1) * columns.col(c) - fit.coefficients(c) * columns.col(c + 1));
}

// The shaft's columns of a record with another angle.
MatrixXd NominalAt(const VibrationRun& run, const VectorXd& angle) {
  VibrationRun changed;
  changed.time_s = run.time_s;
  changed.angle_rad.assign(angle.data(), angle.data() + angle.size());
  FillNominal(changed);
  return std::move(changed.nominal);
}

// All channels of a record on the same columns. They stand one after the other.
std::vector<ChannelFit> FitAll(const VibrationSamples& samples, const VibrationRun& run, const MatrixXd& on) {
  const double* const first = samples.measured.data() + run.channels.front().first;
  const auto channels = static_cast<Index>(run.channels.size());
  return FitChannels(on, Eigen::Map<const MatrixXd>(first, on.rows(), channels));
}

// One record with its angle changed by basis · phase: Gauss–Newton from zero.
PhaseFit FitPhase(const VibrationSamples& samples, const VibrationRun& run, const MatrixXd& basis) {
  const auto n = static_cast<Index>(run.size());
  const auto angle = Eigen::Map<const VectorXd>(run.angle_rad.data(), n);
  PhaseFit best;
  best.phase = VectorXd::Zero(basis.cols());
  VectorXd phase = best.phase;
  for (int round = 0; round < 8; ++round) {
    const MatrixXd columns = NominalAt(run, angle + basis * phase);
    PhaseFit now;
    now.phase = phase;
    SharedStep step(basis.cols());
    for (const ChannelFit& fit : FitAll(samples, run, columns)) {
      now.square_sum += fit.square_sum;
      for (Index k = 0; k < 2; ++k) {
        now.line_energy[k] +=
            fit.coefficients.segment(1 + 2 * k, 2).squaredNorm() * 0.5 * static_cast<double>(n);
      }
      const VectorXd slope = SlopeOf(columns, fit, 1) + SlopeOf(columns, fit, 2);
      if (basis.cols() > 0) step.Add(columns, slope.asDiagonal() * basis, fit);
    }
    now.normal = step.normal;
    if (round > 0 && !(now.square_sum < best.square_sum)) break;
    const bool settled = round > 0 && best.square_sum - now.square_sum < 1e-6 * best.square_sum;
    best = now;
    if (settled || basis.cols() == 0) break;
    phase = best.phase + PseudoInverse(step.normal) * step.gradient;
  }
  return best;
}

// What the angle may be changed by beside its scale.
struct Change {
  Index waves{};    // slow wander, in cosines of time
  bool lag{false};  // the shaft was measured so much earlier or later than the accelerations
};

MatrixXd BasisOf(const VibrationRun& run, const Change& change) {
  const auto n = static_cast<Index>(run.size());
  MatrixXd basis(n, 1 + change.waves + (change.lag ? 1 : 0));
  for (Index i = 0; i < n; ++i) {
    const auto sample = static_cast<std::size_t>(i);
    basis(i, 0) = run.angle_rad[sample] - 0.5 * run.angle_rad.back();
    const double x = run.time_s[sample] / run.span_s();
    for (Index j = 1; j <= change.waves; ++j) basis(i, j) = std::cos(kPi * static_cast<double>(j) * x);
    if (change.lag) basis(i, basis.cols() - 1) = run.speed_rad_per_s[sample] - run.mean_speed_rad_per_s;
  }
  return basis;
}

// Numbers by which the angle may be changed, each of the two lines for itself.
struct Step {
  VectorXd found;
  MatrixXd covariance;
};

// One step from the columns that a record has now.
// @param derivatives  of both lines, by their slopes over the angle: samples × numbers
template <typename Derivatives>
Step StepOf(const VibrationSamples& samples, const VibrationRun& run, const MatrixXd& columns, Index numbers,
            const Derivatives& derivatives) {
  SharedStep step(numbers);
  double square_sum = 0.0;
  for (const ChannelFit& fit : FitAll(samples, run, columns)) {
    const VectorXd slopes[] = {SlopeOf(columns, fit, 1), SlopeOf(columns, fit, 2)};
    step.Add(columns, derivatives(slopes), fit);
    square_sum += fit.square_sum;
  }
  const MatrixXd inverse = PseudoInverse(step.normal);
  const double variance = square_sum / static_cast<double>(run.size() * run.channels.size());
  return {inverse * step.gradient, variance * inverse};
}

// A lag turns both lines by as much time: each says so for itself. An imbalance or a resonance turns one of
// them.
bool LinesAgreeOnLag(const VibrationSamples& samples, const VibrationRun& run) {
  const MatrixXd basis = BasisOf(run, {0, true});
  // The scale, and a lag a line.
  const auto [found, covariance] = StepOf(samples, run, run.nominal, 3, [&](const VectorXd(&slopes)[2]) {
    MatrixXd derivatives(basis.rows(), 3);
    derivatives.col(0) = (slopes[0] + slopes[1]).cwiseProduct(basis.col(0));
    for (const Index line : {0, 1}) derivatives.col(1 + line) = slopes[line].cwiseProduct(basis.col(1));
    return derivatives;
  });
  const auto clear = [&found = found, &covariance = covariance](Index k) {
    return std::abs(found(k)) > kClearly * std::sqrt(covariance(k, k));
  };
  const double apart = std::abs(found(1) - found(2));
  const double uncertain = std::sqrt(covariance(1, 1) + covariance(2, 2) - 2.0 * covariance(1, 2));
  return clear(1) && clear(2) &&
         apart < std::max(kClearly * uncertain, 0.1 * std::max(std::abs(found(1)), std::abs(found(2))));
}

// Whether each line, taken for itself, follows as much of a change of the angle as the other.
bool LinesAgree(const VibrationSamples& samples, const VibrationRun& run, const VectorXd& change,
                const VectorXd& part) {
  const auto angle = Eigen::Map<const VectorXd>(run.angle_rad.data(), change.size());
  const auto [more, covariance] =
      StepOf(samples, run, NominalAt(run, angle + change), 2, [&](const VectorXd(&slopes)[2]) {
        MatrixXd derivatives(part.size(), 2);
        for (const Index line : {0, 1}) derivatives.col(line) = slopes[line].cwiseProduct(part);
        return derivatives;
      });
  const auto follows = [&more = more, &covariance = covariance](Index k) {
    const double error = std::sqrt(covariance(k, k));
    return 1.0 + more(k) > kClearly * error && std::abs(more(k)) < kClearly * error + 0.1;
  };
  return follows(0) && follows(1);
}

bool LinesAgreeOnWander(const VibrationSamples& samples, const VibrationRun& run, Index waves,
                        const VectorXd& phase) {
  const MatrixXd basis = BasisOf(run, {waves});
  const VectorXd change = basis * phase;
  // Waves and scale may stand for each other: what is no scale is wander.
  return LinesAgree(samples, run, change,
                    change - basis.col(0) * (basis.col(0).dot(change) / basis.col(0).squaredNorm()));
}

void RefineRun(VibrationSamples& samples, VibrationRun& run, SpeedSource source) {
  const bool measured = source == SpeedSource::kMeasured;
  const auto n = static_cast<Index>(run.size());
  const double count = static_cast<double>(run.size() * run.channels.size());
  const PhaseFit given = FitPhase(samples, run, MatrixXd(n, 0));
  const auto gain_of = [&](const PhaseFit& fit) {
    return count * std::log(given.square_sum / std::max(fit.square_sum, 1e-300));
  };
  const MatrixXd scale_only = BasisOf(run, {});
  PhaseFit best = FitPhase(samples, run, scale_only);
  const double variance = best.square_sum / count;
  const double uncertainty = best.normal(0, 0) > 0.0 ? std::sqrt(variance / best.normal(0, 0)) : 1.0;
  samples.order_uncertainty =
      std::max({samples.order_uncertainty, std::min(0.01, uncertainty), kUnseenWander});
  Change change;
  double score = gain_of(best) - std::log(count);
  const auto take = [&](PhaseFit changed, const Change& by, double numbers) {
    const double better = gain_of(changed) - numbers * std::log(count);
    if (!(better > score + 30.0)) return;
    score = better;
    best = std::move(changed);
    change = by;
  };
  for (const Index waves : {2, 5, 10}) {
    if (measured) break;
    PhaseFit wandering = FitPhase(samples, run, BasisOf(run, {waves}));
    // A wander of the shaft sharpens both lines; a foreign line beside one of them does not.
    if (wandering.line_energy[0] > best.line_energy[0] + 10.0 * variance &&
        wandering.line_energy[1] > best.line_energy[1] + 10.0 * variance &&
        LinesAgreeOnWander(samples, run, waves, wandering.phase))
      take(std::move(wandering), {waves}, static_cast<double>(1 + waves));
  }
  if (measured && run.speed_spread > kLeastSpreadOfLag && LinesAgreeOnLag(samples, run)) {
    PhaseFit late = FitPhase(samples, run, BasisOf(run, {0, true}));
    // A strong line beside one of the shaft's is met somewhere if the angle may go far enough.
    if (std::abs(late.phase(1)) < kMostLag_s) take(std::move(late), {0, true}, 2.0);
  }
  // A foreign line nearby pulls at the scale a little, and an imbalance turns the phase of the first line
  // while the speed changes: what is stated counts until it is clearly wrong, and neither line likes it
  // better. Over few turns the lines are not quite apart: a little of what is won may be lost at one of them.
  const double may_lose = 4.0 * variance + 0.1 * (given.square_sum - best.square_sum);
  const bool either_loses = best.line_energy[0] < given.line_energy[0] - may_lose ||
                            best.line_energy[1] < given.line_energy[1] - may_lose;
  const bool is_stated = source != SpeedSource::kItsLines;
  if (is_stated && (!(score > 20.0) || (either_loses && !change.lag))) return;
  const VectorXd moved = BasisOf(run, change) * best.phase;
  const bool scaled = change.waves == 0 && !change.lag;
  if (is_stated && scaled && !LinesAgree(samples, run, moved, moved)) return;
  const double before = run.mean_speed_rad_per_s;
  const auto angle = Eigen::Map<const VectorXd>(run.angle_rad.data(), n);
  TakeAngle(run, angle + moved);
  if (change.waves > 0) {
    samples.warnings.push_back(
        "the speed wanders more than the file says: the shaft's own lines were followed");
  } else if (is_stated && std::abs(run.mean_speed_rad_per_s / before - 1.0) > 0.002) {
    samples.warnings.push_back(fmt::format("the shaft's lines stand at {:.5g} rpm, the file says {:.5g}",
                                           RpmFromRadPerS(run.mean_speed_rad_per_s), RpmFromRadPerS(before)));
  }
  if (change.lag && std::abs(best.phase(1)) > kLagWorthSaying * run.period_s) {
    samples.warnings.push_back(
        fmt::format("the angle of the shaft stands {:.3g} ms {} what the accelerometers "
                    "say: it was moved by so much",
                    1e3 * std::abs(best.phase(1)), best.phase(1) > 0.0 ? "behind" : "ahead of"));
  }
}

// Whether one of the shaft's lines stands out where the other was taken out: over few turns a strong line is
// seen in the spectrum where a weak one would be.
bool StandsOutAlone(const VibrationSamples& one, Index line) {
  const VibrationRun& run = one.runs.front();
  const auto n = static_cast<Index>(run.size());
  const std::vector<ChannelFit> fits = FitAll(one, run, run.nominal);
  std::vector<double> left(one.measured.size(), 0.0);
  for (std::size_t c = 0; c < fits.size(); ++c) {
    const VibrationSegment& channel = run.channels[c];
    VectorXd coefficients = fits[c].coefficients;
    coefficients.segment(2 * line - 1, 2).setZero();
    Eigen::Map<VectorXd>(left.data() + channel.first, n) =
        Response(one, run, channel) - run.nominal * coefficients;
  }
  const VibrationSpectrum spectrum(one, left, std::vector<double>(left.size(), 1.0), SpectrumAxis::kTurns);
  return ExcessOf(spectrum.At(static_cast<double>(line)), static_cast<double>(spectrum.channels())) >
         kClearLine;
}

// What a pair of lines at this speed, which may be a little off, leaves; nothing where one of them is not
// there.
std::optional<double> SquareSumOfPair(VibrationSamples samples, double speed_rad_per_s) {
  VibrationRun& run = samples.runs.front();
  TakeSteadySpeed(run, speed_rad_per_s);
  const MatrixXd scale = BasisOf(run, {});
  const PhaseFit fit = FitPhase(samples, run, scale);
  const auto angle = Eigen::Map<const VectorXd>(run.angle_rad.data(), static_cast<Index>(run.size()));
  TakeAngle(run, angle + scale * fit.phase);
  if (!StandsOutAlone(samples, 1) || !StandsOutAlone(samples, 2)) return std::nullopt;
  return fit.square_sum;
}

// A speed in another unit puts the pair of lines far from where it should be. So may a gear with as many
// teeth: a question to the user, not a finding.
void QuestionUnit(const VibrationSpectrum& spectrum, double speed_rad_per_s,
                  std::vector<std::string>& warnings) {
  struct MixUp {
    double factor;
    const char* unit;
  };
  constexpr MixUp kMixUps[] = {{60.0, "Hz"}, {30.0 / kPi, "rad/s"}, {1.0 / 60.0, "turns per hour"}};
  constexpr double kTolerance = 0.02;
  constexpr double kClearPair = 40.0;
  if (PairExcess(spectrum, BestPair(spectrum, 1.0, kTolerance)) > kClearPair) return;
  for (const MixUp& mix_up : kMixUps) {
    if (2.0 * mix_up.factor > 0.9 * spectrum.highest() || mix_up.factor < 3.0 * spectrum.cell()) continue;
    const double order = BestPair(spectrum, mix_up.factor, kTolerance);
    if (!BothLines(spectrum, order) || PairExcess(spectrum, order) < kClearPair) continue;
    warnings.push_back(
        fmt::format("the input speed may be in {}: the file says {:.4g} rpm, where the shaft has no clear "
                    "lines; a pair at 1 and 2 per turn of {:.4g} rpm stands out. It was taken as the file "
                    "says, input_speed_rpm in turns per minute",
                    mix_up.unit, RpmFromRadPerS(speed_rad_per_s), RpmFromRadPerS(speed_rad_per_s * order)));
    return;
  }
}

}  // namespace

void CorrectSpeed(VibrationSamples& samples, SpeedSource source) {
  const std::vector<double> centred = LessMeans(samples);
  const std::vector<double> ones(centred.size(), 1.0);
  for (VibrationRun& run : samples.runs) {
    VibrationSamples one;
    one.runs.push_back(run);
    const VibrationSpectrum spectrum(one, centred, ones, SpectrumAxis::kTurns);
    if (source != SpeedSource::kItsLines) QuestionUnit(spectrum, run.mean_speed_rad_per_s, samples.warnings);
    const double best = BestPair(spectrum, 1.0, source == SpeedSource::kMeasured ? 0.004 : 0.025);
    const double cells = std::abs(best - 1.0) / spectrum.cell();
    const double ahead = PairExcess(spectrum, best) - PairExcess(spectrum, 1.0);
    const bool clear = ahead > 20.0 && PairExcess(spectrum, 1.0) < 0.3 * PairExcess(spectrum, best);
    if (clear && (cells < 1.0 || BothLines(spectrum, best))) {
      const double before = run.mean_speed_rad_per_s;
      TakeAngle(run, best * Eigen::Map<const VectorXd>(run.angle_rad.data(), static_cast<Index>(run.size())));
      if (source != SpeedSource::kItsLines && std::abs(best - 1.0) > 0.002) {
        samples.warnings.push_back(fmt::format("the shaft's lines stand at {:.5g} rpm, the file says {:.5g}",
                                               RpmFromRadPerS(run.mean_speed_rad_per_s),
                                               RpmFromRadPerS(before)));
      }
    }
    RefineRun(samples, run, source);
  }
}

double SpeedFromLines(const VibrationSamples& samples) {
  const std::vector<double> centred = LessMeans(samples);
  const std::vector<double> ones(centred.size(), 1.0);
  const VibrationSpectrum spectrum(samples, centred, ones, SpectrumAxis::kSeconds);
  const double lowest = std::max(0.5, 3.0 * spectrum.cell());
  const double highest = std::min(200.0, 0.45 * spectrum.highest());
  std::vector<double> candidates;
  for (const SpectrumPeak& peak : FindPeaks(spectrum, lowest, 2.0 * highest, 6)) {
    for (const double frequency : {peak.order, 0.5 * peak.order}) {
      if (frequency < lowest || frequency > highest) continue;
      candidates.push_back(BestPair(spectrum, frequency, std::min(0.01, 0.5 * spectrum.cell() / frequency)));
    }
  }
  std::ranges::sort(candidates, std::greater<>(),
                    [&](double frequency) { return PairExcess(spectrum, frequency); });
  candidates.resize(std::min(candidates.size(), kMostPairs));
  double best = 0.0;
  double least_square_sum = 0.0;
  for (const double frequency : candidates) {
    const std::optional<double> square_sum = SquareSumOfPair(samples, kTwoPi * frequency);
    if (!square_sum || (best > 0.0 && *square_sum >= least_square_sum)) continue;
    best = frequency;
    least_square_sum = *square_sum;
  }
  return kTwoPi * best;
}

}  // namespace strainwave::analysis::diagnosis
