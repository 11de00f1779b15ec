// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/between_specimens.h"

#include <algorithm>
#include <cmath>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/statistics/analysis_of_variance.h"
#include "analysis/units.h"

namespace strainwave::analysis::diagnosis {
namespace {

constexpr double kMeanOffZeroP = 0.05;
// A phase whose error is half a turn is not known at all (DescribeAsHarmonic).
constexpr double kOpenPhase_deg = 179.999;
constexpr std::string_view kAmplitude = "amplitude";

// One cause as the studies of different specimens know it.
struct ComparedCause {
  std::string name;
  std::string form;  // its first parameter: one cause may have several forms
  std::size_t found{};
};

std::string FormOf(const CauseRule& rule) {
  return rule.parameters.empty() ? std::string() : rule.parameters.front().name;
}

std::vector<ComparedCause> CausesFound(std::span<const DiagnosedSpecimen> specimens) {
  std::vector<ComparedCause> forms;
  for (const DiagnosedSpecimen& specimen : specimens) {
    for (const Finding& finding : specimen.diagnosis.causes) {
      const CauseRule& rule = specimen.study.causes()[finding.index];
      const auto same = std::ranges::find_if(forms, [&](const ComparedCause& other) {
        return other.name == rule.name && other.form == FormOf(rule);
      });
      if (same == forms.end()) {
        forms.push_back({rule.name, FormOf(rule), 1});
      } else {
        ++same->found;
      }
    }
  }
  std::ranges::stable_sort(forms, std::ranges::greater{}, &ComparedCause::found);
  std::vector<ComparedCause> causes;
  for (const ComparedCause& form : forms)
    if (std::ranges::find(causes, form.name, &ComparedCause::name) == causes.end()) causes.push_back(form);
  return causes;
}

// The numbers of a cause in one specimen; none where its records cannot show it.
struct FittedCause {
  const CauseRule* rule{};
  bool found{};
  std::vector<ParameterValue> parameters;

  const ParameterValue* Known(std::string_view name) const {
    const auto value = std::ranges::find(parameters, name, &ParameterValue::name);
    if (value == parameters.end() || value->of_record || !std::isfinite(value->value)) return nullptr;
    return std::isfinite(value->standard_error) && value->standard_error > 0.0 ? &*value : nullptr;
  }
};

std::vector<ParameterValue> ParametersIn(const ModelFit& fit, std::size_t cause) {
  const auto place = std::ranges::find(fit.causes, cause);
  if (!fit.usable || place == fit.causes.end()) return {};
  return fit.cause_parameters[static_cast<std::size_t>(place - fit.causes.begin())];
}

FittedCause FitIn(const DiagnosedSpecimen& specimen, const ComparedCause& cause) {
  const std::vector<CauseRule>& rules = specimen.study.causes();
  const ModelFit& extended = specimen.diagnosis.extended;
  FittedCause fitted;
  fitted.found = std::ranges::any_of(specimen.diagnosis.causes, [&](const Finding& finding) {
    return rules[finding.index].name == cause.name;
  });
  const auto rule = std::ranges::find_if(
      rules, [&](const CauseRule& one) { return one.name == cause.name && FormOf(one) == cause.form; });
  if (rule == rules.end()) return fitted;
  fitted.rule = &*rule;
  const auto index = static_cast<std::size_t>(rule - rules.begin());
  if (Contains(extended.causes, index)) {
    fitted.parameters = ParametersIn(extended, index);
    return fitted;
  }
  std::vector<std::size_t> causes = extended.causes;
  std::erase_if(causes, [&](std::size_t other) { return rules[other].name == cause.name; });
  const ModelFit fit =
      specimen.study.Fit(With(causes, index), specimen.diagnosis.weights, &extended, FitPurpose::kReport);
  fitted.parameters = ParametersIn(fit, index);
  return fitted;
}

// The first of the amounts that most specimens have.
std::string AmountOf(std::span<const FittedCause> fits) {
  std::string best;
  std::ptrdiff_t most = 0;
  for (const FittedCause& of : fits) {
    if (of.rule == nullptr) continue;
    for (const ParameterRule& rule : of.rule->parameters) {
      if (!rule.amount) continue;
      const auto have = std::ranges::count_if(
          fits, [&](const FittedCause& other) { return other.Known(rule.name) != nullptr; });
      if (have > most) {
        best = rule.name;
        most = have;
      }
    }
  }
  return best;
}

// "friction_phase_deg" of "friction_amplitude_Nm"; empty where the amount has none.
std::string PhaseOf(const std::string& amount) {
  const std::size_t at = amount.find(kAmplitude);
  return at == std::string::npos ? std::string() : amount.substr(0, at) + "phase_deg";
}

SpecimenSize SizeOf(const FittedCause& fitted, const std::string& amount, const std::string& phase) {
  SpecimenSize size{.found = fitted.found, .amount = {}, .phase = {}};
  const ParameterValue* const known = fitted.Known(amount);
  if (known == nullptr) return size;
  size.amount = *known;
  if (!phase.empty()) size.phase = *fitted.Known(phase);
  // What has a phase may be off zero in two directions.
  const bool plane =
      std::ranges::find(fitted.parameters, PhaseOf(amount), &ParameterValue::name) != fitted.parameters.end();
  const double along = std::pow(known->value / known->standard_error, 2);
  size.zero_p =
      std::min(1.0, statistics::ChanceOfChiSquare(along, plane ? 2.0 : 1.0) * fitted.rule->trials_factor);
  return size;
}

statistics::GroupEstimate EstimateOf(const SpecimenSize& size) {
  if (size.phase) return VectorOf(*size.amount, *size.phase);
  statistics::GroupEstimate estimate{Eigen::VectorXd(1), Eigen::MatrixXd(1, 1)};
  estimate.value(0) = size.amount->value;
  estimate.covariance(0, 0) = size.amount->standard_error * size.amount->standard_error;
  return estimate;
}

// Which specimens have it, and how far it goes apart.
void Decide(std::span<const statistics::GroupEstimate> groups, SpecimenComparison& cause) {
  const statistics::RandomEffects& effects = *cause.effects;
  const double bound = kSharedSpread * effects.mean.norm();
  const bool in_all = cause.present() == cause.known();
  const bool apart = !in_all || effects.tau > bound;
  if (in_all && effects.tau_high <= bound && effects.mean_p < kMeanOffZeroP) {
    cause.belonging = Belonging::kShared;
  } else if (apart && effects.tau_low > 0.0) {
    cause.belonging = Belonging::kOwn;
  }
  if (cause.belonging != Belonging::kUndecided) return;
  const auto components = static_cast<double>(effects.mean.size());
  double information = 0.0;
  for (const statistics::GroupEstimate& group : groups) information += components / group.covariance.trace();
  const double error_square = static_cast<double>(groups.size()) / information;
  for (int n = static_cast<int>(groups.size()) + 1; n <= kMostSpecimensAsked; ++n) {
    const statistics::ExpectedInterval tau = statistics::ExpectedTauInterval(
        effects.tau, std::sqrt(error_square), n, static_cast<int>(components));
    const double f = effects.mean.squaredNorm() * n / (effects.tau * effects.tau + error_square) / components;
    const bool away = statistics::ChanceOfF(f, components, components * (n - 1)) < kMeanOffZeroP;
    if (apart ? tau.low > 0.0 : tau.high <= bound && away) {
      cause.specimens_needed = n;
      return;
    }
  }
}

}  // namespace

std::size_t SpecimenComparison::known() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(sizes, [](const SpecimenSize& size) { return size.amount.has_value(); }));
}

std::size_t SpecimenComparison::present() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(sizes, [](const SpecimenSize& size) { return size.amount && size.present(); }));
}

statistics::GroupEstimate VectorOf(const ParameterValue& amount, const ParameterValue& phase) {
  const double angle = RadFromDeg(phase.value);
  Eigen::Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  const double across = phase.standard_error < kOpenPhase_deg
                            ? std::abs(amount.value) * RadFromDeg(phase.standard_error)
                            : amount.standard_error;
  const Eigen::Vector2d errors(amount.standard_error, across);
  return {amount.value * turn.col(0), turn * errors.cwiseAbs2().asDiagonal() * turn.transpose()};
}

std::vector<SpecimenComparison> CompareSpecimens(std::span<const DiagnosedSpecimen> specimens,
                                                 const CompareSpecimensOptions& options) {
  const std::vector<ComparedCause> causes = CausesFound(specimens);
  std::vector<FittedCause> fits(causes.size() * specimens.size());
  options.parallel(fits.size(), [&](std::size_t task) {
    fits[task] = FitIn(specimens[task % specimens.size()], causes[task / specimens.size()]);
  });
  std::vector<SpecimenComparison> compared;
  for (std::size_t c = 0; c < causes.size(); ++c) {
    const auto of_cause = std::span(fits).subspan(c * specimens.size(), specimens.size());
    const std::string amount = AmountOf(of_cause);
    const std::string phase = options.phases ? PhaseOf(amount) : std::string();
    SpecimenComparison cause{
        .name = causes[c].name, .phases = !phase.empty(), .sizes = {}, .effects = {}, .specimens_needed = {}};
    for (const FittedCause& fitted : of_cause) {
      if (fitted.Known(amount) == nullptr) continue;
      cause.phases = cause.phases && fitted.parameters.size() == 2 && fitted.Known(phase) != nullptr;
    }
    std::vector<statistics::GroupEstimate> groups;
    for (const FittedCause& fitted : of_cause) {
      cause.sizes.push_back(SizeOf(fitted, amount, cause.phases ? phase : std::string()));
      if (cause.sizes.back().amount) groups.push_back(EstimateOf(cause.sizes.back()));
    }
    if (groups.size() >= 2) {
      cause.effects = statistics::FitRandomEffects(groups);
      Decide(groups, cause);
    }
    compared.push_back(std::move(cause));
  }
  return compared;
}

}  // namespace strainwave::analysis::diagnosis
