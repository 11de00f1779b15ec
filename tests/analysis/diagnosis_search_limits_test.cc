// SPDX-License-Identifier: Apache-2.0
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/candidates.h"
#include "analysis/diagnosis/combinations.h"
#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/toy_passes.h"

// What a search does not go into: each fit is slower beside more, and what would be dropped again is looked
// at in vain.
namespace strainwave::analysis::diagnosis::diagnosis_search_limits_test {
namespace {

constexpr double kError = 0.006;

BasisFunction BellAt(double centre, double width) {
  return [=](std::size_t i) { return Bell(PlaceOf(i), centre, width); };
}

std::vector<double> EqualWeights(const SeparableStudy& study) {
  return std::vector<double>(study.measured().size(), 1.0);
}

TEST(SearchLimits, AreFourNuisanceTermsAndAnyCauseBesideThem) {
  const auto bell = [](int k) { return BellAt(0.1 + 0.13 * k, 0.03); };
  SeparableModel model = NoiseAnd([&](std::size_t i) {
    double sum = 0.0;
    for (int k = 0; k < 7; ++k) sum += (1.0 - 0.05 * k) * bell(k)(i);
    return sum;
  });
  for (int k = 0; k < 6; ++k) Add(model, {.name = "shape", .named = false}, {bell(k)});
  Add(model, {.name = "cause"}, {bell(6)});
  const SeparableStudy study(std::move(model));
  const Diagnosis diagnosis = Diagnose(study);
  std::vector<std::size_t> basis_functions;
  for (const Finding& nuisance_term : diagnosis.nuisance_terms)
    basis_functions.push_back(nuisance_term.index);
  EXPECT_EQ(basis_functions, (std::vector<std::size_t>{0, 1, 2, 3}));
  ASSERT_EQ(diagnosis.causes.size(), 1U);
  EXPECT_EQ(study.causes()[diagnosis.causes[0].index].name, "cause");
}

// A nuisance term for two small causes, beside a strong effect of which its formula may leave as much.
SeparableModel TwoBesideAStrongOne(double misfit_share) {
  const BasisFunction strong = BellAt(0.4, 0.1);
  const BasisFunction one = BellAt(0.7, 0.02);
  const BasisFunction other = BellAt(0.85, 0.02);
  SeparableModel model =
      NoiseAnd([=](std::size_t i) { return 3.0 * strong(i) + 0.7 * one(i) + 0.3 * other(i); });
  Add(model, {.name = "loud", .misfit_share = misfit_share}, {strong});
  Add(model, {.name = "both", .named = false}, {[=](std::size_t i) { return one(i) + other(i); }});
  Add(model, {.name = "one"}, {one});
  Add(model, {.name = "other"}, {other});
  return model;
}

bool FindsAPair(double misfit_share) {
  const SeparableStudy study(TwoBesideAStrongOne(misfit_share));
  const Judge judge(study, EqualWeights(study), {});
  const std::vector<std::size_t> strong_and_both{0, 1};
  PairRivals rivals;
  return FindPair(judge, {}, judge.Fit(strong_and_both, nullptr), {}, kError, {}, rivals).has_value();
}

TEST(SearchLimits, ExcludePairsThatWouldBeDroppedAsAMisfit) {
  EXPECT_TRUE(FindsAPair(0.0));
  EXPECT_FALSE(FindsAPair(0.05));
}

TEST(SearchLimits, ExcludeInACausesPlaceWhatFitsNowhere) {
  SeparableModel model = NoiseAnd([](std::size_t i) { return BellAt(0.4, 0.1)(i) + BellAt(0.7, 0.1)(i); });
  Add(model, {.name = "known"}, {BellAt(0.7, 0.1)});
  Add(model, {.name = "chosen"}, {BellAt(0.4, 0.1)});
  Add(model, {.name = "fits nowhere"}, {BellAt(0.2, 0.1)});
  model.causes.back().nonlinear_parameters = {{0.0, 1.0, 0.1}};  // and nowhere to begin
  model.causes.back().starts = [](const WeightedResidual&) { return std::vector<std::vector<double>>{}; };
  Add(model, {.name = "rival"}, {BellAt(0.41, 0.1)});
  const SeparableStudy study(std::move(model));
  const Judge judge(study, EqualWeights(study), {});
  const ScoredModel known = judge.Fit(std::vector<std::size_t>{0}, nullptr);
  const std::vector<Candidate> candidates = FitCandidates(judge, known);
  ASSERT_EQ(candidates.front().cause, 1U);
  EXPECT_EQ(Dominated(study, candidates, candidates.front(), known), std::set<std::size_t>{2});
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_search_limits_test
