// SPDX-License-Identifier: Apache-2.0
#include "analysis/diagnosis/lazy_candidates.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/diagnosis/separable_study.h"
#include "tests/analysis/toy_passes.h"

namespace strainwave::analysis::diagnosis::diagnosis_lazy_candidates_test {
namespace {

using Causes = std::vector<std::size_t>;

// A study whose searches are long, of one whose are not.
class LongSearches final : public Study {
 public:
  explicit LongSearches(SeparableModel model) : study_(std::move(model)) {}

  bool CachesSearches() const override { return true; }
  std::span<const double> measured() const override { return study_.measured(); }
  std::span<const std::size_t> segments() const override { return study_.segments(); }
  const std::vector<CauseRule>& causes() const override { return study_.causes(); }
  const std::vector<Regressor>& regressors() const override { return study_.regressors(); }
  std::string unit() const override { return study_.unit(); }
  double unit_per_si() const override { return study_.unit_per_si(); }
  double NoiseFloor() const override { return study_.NoiseFloor(); }
  std::size_t BlockLength() const override { return study_.BlockLength(); }
  int LargestNoiseOrder() const override { return study_.LargestNoiseOrder(); }
  bool SpikesAreOutliers() const override { return study_.SpikesAreOutliers(); }
  const std::vector<std::string>& warnings() const override { return study_.warnings(); }
  std::vector<UserQuantity> Quantities(const Eigen::VectorXd& predicted) const override {
    return study_.Quantities(predicted);
  }
  ModelFit Fit(std::span<const std::size_t> cause_indices, std::span<const double> weights,
               const ModelFit* start, FitPurpose purpose) const override {
    return study_.Fit(cause_indices, weights, start, purpose);
  }
  Eigen::VectorXd Predict(std::span<const ParameterValue> nominal,
                          std::span<const NamedCause> causes) const override {
    return study_.Predict(nominal, causes);
  }

 private:
  SeparableStudy study_;
};

BasisFunction Wave(double rate) {
  return [rate](std::size_t i) { return std::cos(rate * static_cast<double>(i)); };
}

constexpr std::size_t kSamples = kPasses * kOfPass;

// Waves of these amplitudes, a cause each.
SeparableModel Waves(const std::vector<double>& amplitudes) {
  std::vector<BasisFunction> waves;
  for (std::size_t w = 0; w < amplitudes.size(); ++w)
    waves.push_back(Wave(0.1 + 0.13 * static_cast<double>(w)));
  SeparableModel model = NoiseAnd([&](std::size_t i) {
    double sum = 0.0;
    for (std::size_t w = 0; w < waves.size(); ++w) sum += amplitudes[w] * waves[w](i);
    return sum;
  });
  for (std::size_t w = 0; w < waves.size(); ++w)
    Add(model, {.name = std::string(1, static_cast<char>('a' + w))}, {waves[w]});
  return model;
}

Causes CausesOf(const std::vector<Candidate>& candidates) {
  Causes causes;
  for (const Candidate& candidate : candidates) causes.push_back(candidate.cause);
  std::ranges::sort(causes);
  return causes;
}

TEST(LazyCandidates, FitsAllBesideTheFirstModel) {
  const LongSearches study(Waves({2.0, 1.0, 0.05}));
  const Judge judge(study, std::vector<double>(kSamples, 1.0), {});
  LazyCandidates lazy(judge, [](std::size_t) {});
  const ScoredModel nominal = judge.Fit({}, nullptr);
  EXPECT_EQ(CausesOf(lazy.Strongest(nominal)), (Causes{0, 1, 2}));
}

TEST(LazyCandidates, LeavesOutWhatCameNowhereNear) {
  const LongSearches study(Waves({2.0, 1.0, 0.05}));
  const Judge judge(study, std::vector<double>(kSamples, 1.0), {});
  LazyCandidates lazy(judge, [](std::size_t) {});
  lazy.Strongest(judge.Fit({}, nullptr));
  const Causes first{0};
  const ScoredModel model = judge.Fit(first, nullptr);
  std::vector<Candidate> candidates = lazy.Strongest(model);
  EXPECT_EQ(CausesOf(candidates), (Causes{1}));
  // With that one chosen it decides nothing; where none is, all are looked at.
  const Candidate chosen = candidates.front();
  EXPECT_FALSE(lazy.AddOthers(model, &chosen, candidates));
  EXPECT_EQ(CausesOf(candidates), (Causes{1}));
  EXPECT_TRUE(lazy.AddOthers(model, nullptr, candidates));
  EXPECT_EQ(CausesOf(candidates), (Causes{1, 2}));
  EXPECT_FALSE(lazy.AddOthers(model, nullptr, candidates));
}

// An effect is worth more beside a model that leaves less: beside the nominal one it has a thousandth of the
// largest likelihood ratio.
TEST(LazyCandidates, ExpectsMoreOfAnEffectBesideAModelThatLeavesLess) {
  const LongSearches study(Waves({10.0, 0.4, 0.25}));
  const Judge judge(study, std::vector<double>(kSamples, 1.0), {});
  LazyCandidates lazy(judge, [](std::size_t) {});
  lazy.Strongest(judge.Fit({}, nullptr));
  const Causes first{0};
  EXPECT_EQ(CausesOf(lazy.Strongest(judge.Fit(first, nullptr))), (Causes{1, 2}));
}

// A record of zeros, which no model fits: there is no likelihood to compare with.
TEST(LazyCandidates, FitsAllBesideAModelThatIsNotUsable) {
  const LongSearches study(Waves({2.0, 1.0, 0.05}));
  const Judge judge(study, std::vector<double>(kSamples, 1.0), {});
  LazyCandidates lazy(judge, [](std::size_t) {});
  std::vector<Candidate> candidates = lazy.Strongest(ScoredModel{});
  EXPECT_EQ(CausesOf(candidates), (Causes{0, 1, 2}));
  EXPECT_FALSE(lazy.AddOthers(ScoredModel{}, &candidates.front(), candidates));
}

TEST(LazyCandidates, FitsAllAtOnceWhereSearchesAreShort) {
  const SeparableStudy study(Waves({2.0, 1.0, 0.05}));
  const Judge judge(study, std::vector<double>(kSamples, 1.0), {});
  Causes begun;
  LazyCandidates lazy(judge, [&](std::size_t cause) { begun.push_back(cause); });
  lazy.Strongest(judge.Fit({}, nullptr));
  const Causes first{0};
  begun.clear();
  std::vector<Candidate> candidates = lazy.Strongest(judge.Fit(first, nullptr));
  EXPECT_EQ(CausesOf(candidates), (Causes{1, 2}));
  EXPECT_EQ(begun, (Causes{1, 2}));
  candidates.clear();
  EXPECT_FALSE(lazy.AddOthers(judge.Fit(first, nullptr), nullptr, candidates));
  EXPECT_TRUE(candidates.empty());
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_lazy_candidates_test
