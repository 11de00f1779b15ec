// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <utility>

#include "analysis/autocorrelation.h"
#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/residuals.h"
#include "analysis/diagnosis/selection.h"

namespace strainwave::analysis::diagnosis {
namespace {

// A local cause may cover a few samples: its blocks are this much shorter.
constexpr std::size_t kShortBlocks = 20;
// Values that the fits kept may take in memory, all together (64 MB), and how many there may be.
constexpr std::size_t kMostKept = std::size_t{1} << 23;
constexpr std::size_t kMostFits = 256;
constexpr std::size_t kMostHeldOut = 8;

// Of the error allowed, for the causes together; the rest is for nuisance terms without a cause (weighted
// Bonferroni; Genovese, Roeder & Wasserman, Biometrika 93 (2006) 509).
constexpr double kShareOfCauses = 0.75;

// BIC charges a parameter by all samples, also one that only a few of them know (a response, a window, an
// order's phase): of a nuisance term it may say so much less where chance is excluded, and less for each of
// many parameters.
constexpr double kLeastBic = -12.0;
constexpr double kLeastBicEach = -5.0;
constexpr double kLeastBicOfMany = -40.0;

constexpr double kOpen = 0.5;  // of a number's range: a standard error that leaves all of it possible

}  // namespace

double DeltaBic(const Comparison& comparison, const CauseRule& rule) {
  if (!rule.known_by_size || !(comparison.more_parameters > 0.0)) return comparison.delta_bic;
  const double samples = std::max(1.0, comparison.samples);
  const double sharpness = std::clamp(comparison.likelihood_ratio, 1.0, samples);
  return comparison.delta_bic + comparison.more_parameters * std::log(samples / sharpness);
}

double LeastBicBeside(const CauseRule& rule) { return std::min(0.0, rule.least_bic.value_or(0.0)); }

bool IsBeyondChance(const Comparison& comparison, const CauseRule& rule, double corrected_p_value,
                    double error) {
  const double by_number = std::clamp(kLeastBicEach * comparison.more_parameters, kLeastBicOfMany, kLeastBic);
  // A name has to pay for its numbers, whatever its p-value.
  const double asked = rule.named ? 0.0 : rule.least_bic.value_or(by_number);
  return corrected_p_value < error && DeltaBic(comparison, rule) > asked;
}

Judge::Judge(const Study& study, std::vector<double> weights, const DiagnoseOptions& options)
    : study_(study),
      weights_(std::move(weights)),
      folds_(MakeFolds(study.measured().size(), study.segments(), study.BlockLength())),
      short_folds_(MakeFolds(study.measured().size(), study.segments(),
                             std::max<std::size_t>(2, study.BlockLength() / kShortBlocks))),
      parallel_(options.parallel),
      fits_(std::min(kMostFits, kMostKept / std::max<std::size_t>(1, study.measured().size()))),
      held_out_(kMostHeldOut) {
  for (const double weight : weights_) samples_ += weight > 0.0 ? 1.0 : 0.0;
  for (const double value : study.measured()) scale_ = std::max(scale_, std::abs(value));
  scale_ = std::max(scale_, 1e-300);
}

ScoredModel Judge::Fit(std::span<const std::size_t> causes, const ModelFit* start, FitPurpose purpose) const {
  const auto make = [&] {
    ScoredModel model{study_.Fit(causes, weights_, start, purpose), {}};
    if (model.fit.usable) {
      model.noise = FitNoise(study_.Decorrelated(ResidualsOf(study_, model.fit), weights_), weights_,
                             study_.segments(), study_.LargestNoiseOrder(), scale_, study_.NoiseSeries());
    }
    return model;
  };
  // What the start lacks is searched for, which the study itself keeps.
  const bool searches = start == nullptr || std::ranges::any_of(causes, [&](std::size_t cause) {
                          return !Contains(start->causes, cause);
                        });
  if (purpose == FitPurpose::kCompare && searches && study_.CachesSearches()) return make();
  FitRequest request{{causes.begin(), causes.end()}, {}, {}, purpose};
  if (start != nullptr && start->usable) {
    request.start_causes = start->causes;
    request.start_state = start->state;
  }
  return fits_.Get(request, make);
}

std::vector<double> Judge::HeldOut(const ModelFit& fit, bool local) const {
  return held_out_.Get({fit.causes, fit.state, local},
                       [&] { return HeldOutResiduals(study_, weights_, folds(local), fit, parallel_); });
}

Comparison Judge::Compare(const ScoredModel& richer, const ScoredModel& poorer) const {
  Comparison comparison;
  if (!richer.fit.usable || !poorer.fit.usable) return comparison;
  double more = richer.fit.free_parameters - poorer.fit.free_parameters;
  // What is added has an amount at least, also where the poorer model needs the more numbers for it (an
  // oscillation at the start that stands in for a drag).
  if (more > 0.0 || richer.fit.causes.size() > poorer.fit.causes.size())
    more = std::max(1.0, richer.fit.charged_parameters() - poorer.fit.charged_parameters());
  comparison.more_parameters = more;
  comparison.log_search_locations = richer.fit.log_search_locations - poorer.fit.log_search_locations;
  comparison.more_location_parameters =
      std::max(0, richer.fit.location_parameters - poorer.fit.location_parameters);
  comparison.likelihood_ratio = LikelihoodRatio(richer.noise, poorer.noise);
  comparison.samples = samples_;
  comparison.delta_bic = comparison.likelihood_ratio - more * std::log(samples_);
  comparison.likelihood_ratio = std::max(0.0, comparison.likelihood_ratio);
  const double freedom = samples_ - richer.fit.free_parameters;
  if (more > 0.0 && freedom > 2.0) {
    const double f = std::expm1(std::min(700.0, comparison.likelihood_ratio / samples_)) * freedom / more;
    const boost::math::fisher_f distribution(more, freedom);
    comparison.p_value = std::min(1.0, std::exp(comparison.log_search_locations) *
                                           boost::math::cdf(boost::math::complement(distribution, f)));
  }
  return comparison;
}

double Judge::Score(const Comparison& comparison, const CauseRule& rule) const {
  const double more = comparison.more_parameters;
  const double locations = std::min<double>(rule.location_parameters + comparison.more_location_parameters,
                                            std::max<double>(more, rule.degrees_of_freedom));
  // Locations that the search chooses and the fit leaves alone are none of its numbers, but cost as much.
  const double left_alone = std::max(0.0, rule.degrees_of_freedom - more);
  const double amounts = more - std::max(0.0, locations - left_alone);
  return comparison.likelihood_ratio - amounts * std::log(samples_) -
         locations * std::log(std::clamp(comparison.likelihood_ratio, 1.0, samples_)) -
         2.0 * (comparison.log_search_locations + std::log(std::max(1.0, rule.trials_factor)));
}

double Judge::Corrected(double p_value, const CauseRule& rule) const {
  const auto of_its_sort = std::ranges::count(study_.causes(), rule.named, &CauseRule::named);
  const double share = rule.named ? kShareOfCauses : 1.0 - kShareOfCauses;
  const double trials = std::max(1.0, rule.trials_factor) * static_cast<double>(of_its_sort) / share;
  return -std::expm1(trials * std::log1p(-std::min(p_value, 0.999999)));
}

double Judge::HeldOutGain(const ModelFit& richer, const ModelFit& poorer, const NoiseFit& noise,
                          bool local) const {
  const std::vector<double> before = study_.Decorrelated(HeldOut(poorer, local), weights_);
  const std::vector<double> after = study_.Decorrelated(HeldOut(richer, local), weights_);
  double gain = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    gain += weights_[i] * (before[i] * before[i] - after[i] * after[i]);
  }
  double inflation = 1.0;
  if (noise.order > 0)
    inflation = VarianceInflation(study_.Decorrelated(ResidualsOf(study_, richer), weights_));
  const double variance = noise.innovation_sd * noise.innovation_sd;
  return variance > 0.0 ? gain / (2.0 * variance * inflation) : 0.0;
}

std::string Judge::Objection(const ModelFit& fit, std::size_t cause, double away_from_zero) const {
  const auto place = std::find(fit.causes.begin(), fit.causes.end(), cause);
  if (!fit.usable || place == fit.causes.end()) return "no fit";
  const CauseRule& rule = study_.causes()[cause];
  const auto& parameters = fit.cause_parameters[static_cast<std::size_t>(place - fit.causes.begin())];
  for (const ParameterRule& expected : rule.parameters) {
    const auto found = std::find_if(parameters.begin(), parameters.end(),
                                    [&](const ParameterValue& value) { return value.name == expected.name; });
    if (found == parameters.end()) continue;
    // Of a number that may be anywhere in its range the record does not say that it is outside.
    const bool open = found->standard_error > kOpen * (expected.high - expected.low);
    if (!open && !(found->value >= expected.low && found->value <= expected.high)) {
      return fmt::format("{} = {:.4g} {} is outside {:.4g} to {:.4g}", expected.name, found->value,
                         expected.unit, expected.low, expected.high);
    }
    if (found->value < 0.0 && -found->value < expected.least_below_zero) {
      return fmt::format("{} = {:.3g} {} is above -{:.3g} {}, which the sampling leaves open", expected.name,
                         found->value, expected.unit, expected.least_below_zero, expected.unit);
    }
    if (expected.amount && !(std::abs(found->value) > away_from_zero * found->standard_error)) {
      return fmt::format("{} = {:.3g} ± {:.2g} {} is not away from zero", expected.name, found->value,
                         found->standard_error, expected.unit);
    }
  }
  return {};
}

}  // namespace strainwave::analysis::diagnosis
