// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/planted_records.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "analysis/diagnosis/cause_sets.h"
#include "analysis/diagnosis/residuals.h"

namespace strainwave::analysis::diagnosis {
namespace {

std::vector<double> Together(std::span<const double> a, const Eigen::VectorXd& b) {
  std::vector<double> sum(a.begin(), a.end());
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += b(static_cast<Eigen::Index>(i));
  return sum;
}

// What was held against the strongest candidate of a name.
std::string ObjectionTo(const Study& study, const CauseRule& rule, const Diagnosis& said) {
  const CandidateResult* strongest = nullptr;
  for (const CandidateResult& candidate : said.candidates) {
    if (study.causes()[candidate.index].name != rule.name || candidate.objection.empty()) continue;
    if (strongest == nullptr || candidate.evidence.delta_bic > strongest->evidence.delta_bic)
      strongest = &candidate;
  }
  return strongest == nullptr ? std::string{} : strongest->objection;
}

}  // namespace

PlantedRecords::PlantedRecords(const Study& study, const Diagnosis& diagnosis, const DiagnoseOptions& options)
    : study_(study),
      diagnosis_(diagnosis),
      options_(options),
      noise_(study, diagnosis.extended, diagnosis.weights) {
  options_.simulate = nullptr;
  options_.progress = nullptr;
  options_.parallel = InTurn;
  options_.names_only = true;
}

PlantingBase PlantedRecords::BaseWithout(const std::string& name) const {
  PlantingBase base;
  std::vector<std::size_t> causes = diagnosis_.extended.causes;
  for (const std::size_t cause : diagnosis_.extended.causes) {
    const CauseRule& rule = study_.causes()[cause];
    if (!rule.named) continue;
    if (rule.name == name)
      causes = Without(causes, cause);
    else
      base.names.push_back(rule.name);
  }
  Eigen::VectorXd predicted = diagnosis_.extended.predicted;
  if (causes.size() != diagnosis_.extended.causes.size()) {
    const ModelFit fit = study_.Fit(causes, diagnosis_.weights, &diagnosis_.extended, FitPurpose::kCompare);
    if (fit.usable) predicted = fit.predicted;
  }
  base.response.assign(predicted.begin(), predicted.end());
  base.beside_nominal = BesideNominal(base.response);
  return base;
}

double PlantedRecords::SigmaOf(const PlantingBase& base, const Eigen::VectorXd& added) const {
  std::vector<double> beside = BesideNominal(Together(base.response, added));
  for (std::size_t i = 0; i < beside.size(); ++i) beside[i] -= base.beside_nominal[i];
  return noise_.MatchedFilterSigma(std::move(beside));
}

PlantingOutcome PlantedRecords::Search(const PlantingBase& base, const CauseRule* rule,
                                       const DrawnEffect* effect, double amount, std::uint64_t draw) const {
  PlantingOutcome outcome;
  outcome.planted.amount = amount;
  std::vector<double> response = base.response;
  if (effect != nullptr) {
    const Eigen::VectorXd added = effect->added(amount);
    outcome.planted.sigma = SigmaOf(base, added);
    response = Together(response, added);
  }
  const std::vector<double> noise = noise_.Draw(draw);
  for (std::size_t i = 0; i < response.size(); ++i) response[i] += noise[i];
  try {
    const auto planted = study_.WithResponse(response);
    if (!planted) return outcome;
    const Diagnosis said = Diagnose(*planted, options_);
    for (const Finding& finding : said.causes) {
      const std::string& name = planted->causes()[finding.index].name;
      if (rule != nullptr && name == rule->name)
        outcome.planted.found = true;
      else if (std::ranges::find(base.names, name) == base.names.end())
        outcome.planted.others.push_back(name);
    }
    if (rule != nullptr && !outcome.planted.found) outcome.objection = ObjectionTo(*planted, *rule, said);
  } catch (const std::invalid_argument& error) {
    outcome.objection = error.what();
  }
  return outcome;
}

std::vector<double> PlantedRecords::BesideNominal(const std::vector<double>& response) const {
  try {
    const auto records = study_.WithResponse(response);
    const ModelFit fit =
        records->Fit(options_.given_causes, diagnosis_.weights, &diagnosis_.nominal, FitPurpose::kCompare);
    return fit.usable ? ResidualsOf(*records, fit) : response;
  } catch (const std::invalid_argument&) {  // records that nobody would take
    return response;
  }
}

}  // namespace strainwave::analysis::diagnosis
