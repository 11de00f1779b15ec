// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/vibration/drawn_term.h"

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <random>

#include "analysis/diagnosis/vibration/parameters.h"
#include "analysis/diagnosis/vibration/terms.h"

namespace strainwave::analysis::diagnosis {
namespace {

// Of what impulses excite: shares of half the sampling rate, and damping that dies away before the next.
constexpr double kLowestRing = 0.1;
constexpr double kHighestRing = 0.7;
constexpr double kLeastRingDamping = 0.02;
constexpr double kMostRingDamping = 0.2;
// Of a torsional resonance, within what its rule takes.
constexpr double kLeastDrawnDamping = 0.01;
constexpr double kMostDrawnDamping = 0.1;

class TermDraw {
 public:
  TermDraw(const VibrationSamples& samples, std::uint64_t draw) : samples_(samples) {
    std::seed_seq seed{static_cast<std::uint32_t>(draw), static_cast<std::uint32_t>(draw >> 32U)};
    random_.seed(seed);
  }

  double Between(double low, double high) { return low + (high - low) * uniform_(random_); }
  double Normal() { return normal_(random_); }

  std::optional<VibrationTerm> Term(VibrationCause cause) {
    const double ratio = std::abs(samples_.ratio);
    VibrationTerm term;
    switch (cause) {
      case VibrationCause::kGearMesh:
        for (const double order : {2.0 * ratio, 2.0 * ratio + 2.0}) {
          if (order < 0.9 * samples_.highest_order()) term.lines.push_back({0.0, order});
        }
        if (term.lines.empty()) return std::nullopt;
        return term;
      case VibrationCause::kToothEngagement:
        term.lines = {{0.0, CrackOrder()}};  // smooth; with its multiples it would be a crack's
        return term;
      case VibrationCause::kBearingDefect:
        return Train(Between(kLowestBearingOrder, kHighestBearingOrder));
      case VibrationCause::kFlexsplineCrack:
        return Train(CrackOrder());
      case VibrationCause::kImbalance:
        term.form = VibrationForm::kGrowth;
        return term;
      case VibrationCause::kTorsionalResonance: {
        term.form = VibrationForm::kTransients;
        const double highest_Hz = std::min(kHighestTorsional_Hz, 0.5 * samples_.highest_Hz());
        term.nonlinear_parameters = {
            std::exp(Between(std::log(4.0 * kLowestTorsional_Hz), std::log(highest_Hz))),
            Between(kLeastDrawnDamping, kMostDrawnDamping),
            Between(0.05, 0.9) * samples_.runs.front().span_s()};
        return term;
      }
      default:
        return std::nullopt;
    }
  }

 private:
  // As often a turn as a point of the flexspline comes by the wave generator, which teeth meet by, too.
  double CrackOrder() const { return 2.0 * (1.0 + 1.0 / std::abs(samples_.ratio)); }

  VibrationTerm Train(double order) {
    VibrationTerm term;
    term.form = VibrationForm::kImpulseTrain;
    term.nonlinear_parameters = {order, Between(kLowestRing, kHighestRing) * samples_.highest_Hz(),
                                 Between(kLeastRingDamping, kMostRingDamping)};
    for (std::size_t r = 0; r < samples_.runs.size(); ++r)
      term.nonlinear_parameters.push_back(Between(0.0, 1.0));
    return term;
  }

  const VibrationSamples& samples_;
  std::mt19937_64 random_;
  boost::random::uniform_01<double> uniform_;
  boost::random::normal_distribution<double> normal_;
};

}  // namespace

std::optional<DrawnEffect> DrawVibrationEffect(const VibrationSamples& samples, VibrationCause cause,
                                               std::uint64_t draw) {
  TermDraw one(samples, draw);
  std::optional<VibrationTerm> term = one.Term(cause);
  if (!term) return std::nullopt;
  term->observable.assign(samples.channels(), 1);
  Eigen::VectorXd added = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples.measured.size()));
  double amplitude = 0.0;
  for (std::size_t r = 0; r < samples.runs.size(); ++r) {
    const VibrationRun& run = samples.runs[r];
    const Eigen::MatrixXd columns = FillTerm(samples, r, *term);
    const Eigen::Index together = HasPairs(term->form) ? 2 : 1;
    for (const VibrationSegment& channel : run.channels) {
      auto own =
          added.segment(static_cast<Eigen::Index>(channel.first), static_cast<Eigen::Index>(run.size()));
      for (Eigen::Index k = 0; k + together <= columns.cols(); k += together) {
        const Eigen::VectorXd coefficients =
            Eigen::VectorXd::NullaryExpr(together, [&](Eigen::Index) { return one.Normal(); });
        own += columns.middleCols(k, together) * coefficients;
        amplitude = std::max(amplitude, coefficients.norm() / channel.scale);
      }
    }
  }
  if (!added.allFinite() || added.squaredNorm() == 0.0 || !(amplitude > 0.0)) return std::nullopt;
  added /= amplitude;
  const bool at_a_speed = term->form == VibrationForm::kGrowth;
  const std::string name = AmplitudeName(samples);
  return DrawnEffect{
      at_a_speed ? "amplitude_at_1000_rpm" + name.substr(std::string_view("amplitude").size()) : name,
      UnitOfChannel(samples.runs.front().channels.front().name), kUnlimited,
      [added](double amount) -> Eigen::VectorXd { return amount * added; }};
}

}  // namespace strainwave::analysis::diagnosis
