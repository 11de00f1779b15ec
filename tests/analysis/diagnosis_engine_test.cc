// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <random>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/fit_covariance.h"
#include "analysis/diagnosis/heldout.h"
#include "analysis/diagnosis/known_before.h"
#include "analysis/diagnosis/noise_likelihood.h"
#include "analysis/diagnosis/scans.h"
#include "analysis/diagnosis/selection.h"
#include "analysis/diagnosis/separable_study.h"
#include "analysis/units.h"
#include "tests/analysis/message_of.h"
#include "tests/analysis/white_noise.h"

namespace strainwave::analysis::diagnosis::diagnosis_engine_test {
namespace {

SeparableTerm Column(std::vector<double> values, std::string name) {
  SeparableTerm term;
  term.fill = [values](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < values.size(); ++i) design(static_cast<Eigen::Index>(i), 0) = values[i];
  };
  DescribeEach(term, {{std::move(name), "1", 1.0}});
  return term;
}

// A constant and a ramp as the nominal model; a square wave, a bump of unknown position and a second square
// wave that is hidden behind the first one as candidates.
struct ToyRecord {
  std::vector<double> x;
  std::vector<double> square;
  explicit ToyRecord(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      x.push_back(static_cast<double>(i) / static_cast<double>(n));
      square.push_back(i / 7 % 2 == 0 ? 1.0 : -1.0);
    }
  }
};

SeparableModel ToyModel(const ToyRecord& record, std::vector<double> measured) {
  SeparableModel model;
  model.nominal.push_back(Column(std::vector<double>(record.x.size(), 1.0), "offset"));
  model.nominal.push_back(Column(record.x, "slope"));
  model.causes.push_back(Column(record.square, "square_size"));
  model.rules.push_back({.name = "square", .parameters = {{"square_size", "1", -10.0, 10.0, true}}});
  SeparableTerm bump;
  bump.nonlinear_parameters = {{0.0, 1.0, 0.02}};
  bump.fill = [x = record.x](std::span<const double> nonlinear_parameters,
                             Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double away = (x[i] - nonlinear_parameters[0]) / 0.02;
      design(static_cast<Eigen::Index>(i), 0) = std::exp(-0.5 * away * away);
    }
  };
  bump.starts = [x = record.x](const WeightedResidual& residual) {
    std::vector<std::vector<double>> starts;
    for (const WindowPeak& peak : FindWindows(x, residual.values, residual.weights, 0.02, 0.08, 3)) {
      starts.push_back({peak.centre});
    }
    return starts;
  };
  DescribeEach(bump, {{"height", "1", 1.0}, {"centre", "1", 1.0}});
  model.causes.push_back(std::move(bump));
  model.rules.push_back({.name = "bump",
                         .parameters = {{"height", "1", 0.0, 10.0, true}},
                         .degrees_of_freedom = 2,
                         .trials_factor = 25.0,
                         .local = true});
  model.measured = std::move(measured);
  model.block_length = record.x.size() / 20;
  model.noise_floor = 0.1;
  model.unit = "V";
  return model;
}

TEST(FitNoise, FindsTheCoefficientOfAutoregressiveNoiseAndNoneInWhiteNoise) {
  std::vector<double> x = WhiteNoise(4000, 1.0, 7);
  const std::vector<double> weights(4000, 1.0);
  const std::vector<std::size_t> one{0};
  EXPECT_EQ(FitNoise(x, weights, one, 4, 1.0).order, 0);
  for (std::size_t i = 1; i < x.size(); ++i) x[i] += 0.6 * x[i - 1];
  const NoiseFit fit = FitNoise(x, weights, one, 4, 1.0);
  EXPECT_EQ(fit.order, 1);
  EXPECT_NEAR(fit.series.front().coefficients[0], 0.6, 0.04);
  EXPECT_NEAR(fit.innovation_sd, 1.0, 0.04);
}

TEST(MakeFolds, DealsWholeBlocksThatNeverCrossASegment) {
  const std::vector<std::size_t> segments{0, 95};
  const Folds folds = MakeFolds(200, segments, 20);
  EXPECT_EQ(folds.folds, 5u);
  EXPECT_NE(folds.block_of[94], folds.block_of[95]);
  std::vector<std::size_t> count(folds.folds, 0);
  for (std::size_t i = 0; i < 200; ++i) ++count[folds.fold_of[i]];
  for (const std::size_t samples : count) EXPECT_GE(samples, 20u);
  for (std::size_t i = 1; i < 200; ++i) {
    if (folds.block_of[i] == folds.block_of[i - 1]) {
      EXPECT_EQ(folds.fold_of[i], folds.fold_of[i - 1]);
    }
  }
}

TEST(MakeFolds, RefusesARecordOfOneBlock) {
  EXPECT_EQ(
      MessageOf([] { MakeFolds(30, std::vector<std::size_t>{0}, 100); }),
      "the record is too short to hold anything out: 30 samples, one block of 100 (expected at least two "
      "blocks)");
}

TEST(SeparableStudy, IntervalsHoldTheTruthAsOftenAsTheySay) {
  const ToyRecord record(400);
  int held = 0;
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::vector<double> measured = WhiteNoise(400, 0.1, 100 + seed);
    for (std::size_t i = 0; i < 400; ++i) {
      const double away = (record.x[i] - 0.431) / 0.02;
      measured[i] += 2.0 - record.x[i] + 0.3 * std::exp(-0.5 * away * away);
    }
    const SeparableStudy study(ToyModel(record, measured));
    const std::vector<std::size_t> bump{1};
    const ModelFit fit = study.Fit(bump, std::vector<double>(400, 1.0), nullptr, FitPurpose::kReport);
    const ParameterValue& centre = fit.cause_parameters[0][1];
    held += std::abs(centre.value - 0.431) < 1.96 * centre.standard_error ? 1 : 0;
  }
  // 95 % of 300, within three standard deviations of that count.
  EXPECT_GE(held, 285 - 12);
  EXPECT_LE(held, 285 + 12);
}

TEST(SeparableStudy, PredictsWhatItsOwnParametersDescribe) {
  const ToyRecord record(400);
  const SeparableStudy study(ToyModel(record, WhiteNoise(400, 0.1, 9)));
  const std::vector<std::size_t> both{0, 1};
  const ModelFit fit = study.Fit(both, std::vector<double>(400, 1.0), nullptr, FitPurpose::kCompare);
  const std::vector<Study::NamedCause> causes{{"square", fit.cause_parameters[0]},
                                              {"bump", fit.cause_parameters[1]}};
  EXPECT_LT((study.Predict(fit.nominal, causes) - fit.predicted).norm(), 1e-12);
  const std::vector<Study::NamedCause> unknown{{"ghost", {}}};
  EXPECT_EQ(MessageOf([&] { study.Predict(fit.nominal, unknown); }),
            "there is no cause 'ghost' for records of this kind");
}

// Two causes share three quarters of the error allowed, one nuisance term has the last quarter: 2 / 0.75 and
// 1 / 0.25 trials.
TEST(Judge, ChargesNuisanceTermsMoreForTheirTrialsThanCauses) {
  const ToyRecord record(400);
  SeparableModel model = ToyModel(record, WhiteNoise(400, 0.1, 17));
  model.causes.push_back(Column(record.x, "curve"));
  model.rules.push_back({.name = "curve", .trials_factor = 3.0, .named = false});
  const SeparableStudy study(std::move(model));
  const Judge judge(study, std::vector<double>(400, 1.0), {});
  EXPECT_NEAR(judge.Corrected(1e-6, study.causes()[0]), 1e-6 * 2.0 / 0.75, 1e-10);
  EXPECT_NEAR(judge.Corrected(1e-6, study.causes()[1]), 25.0 * 1e-6 * 2.0 / 0.75, 1e-8);
  EXPECT_NEAR(judge.Corrected(1e-6, study.causes()[2]), 3.0 * 1e-6 * 1.0 / 0.25, 1e-9);
}

TEST(Judge, MultipliesChanceByTheSearchLocationsThatAFitChoseFrom) {
  const ToyRecord record(600);
  const SeparableStudy study(ToyModel(record, WhiteNoise(600, 0.1, 3)));
  const Judge judge(study, std::vector<double>(600, 1.0), {});
  const ScoredModel poorer = judge.Fit({}, nullptr);
  ScoredModel richer = poorer;
  richer.fit.free_parameters += 2;
  for (double& likelihood : richer.noise.log_likelihood) likelihood += 8.0;
  const double one = judge.Compare(richer, poorer).p_value;
  richer.fit.log_search_locations = std::log(50.0);
  EXPECT_NEAR(judge.Compare(richer, poorer).p_value, 50.0 * one, 1e-9);
  richer.fit.log_search_locations = 60.0;
  EXPECT_EQ(judge.Compare(richer, poorer).p_value, 1.0);
}

// What stands in for a cause may need more numbers than the cause itself: that is no reason to call it
// chance.
TEST(Judge, ChargesACauseAtLeastOneNumberWhereTheModelWithoutItNeedsMore) {
  const ToyRecord record(400);
  const SeparableStudy study(ToyModel(record, WhiteNoise(400, 0.1, 3)));
  const Judge judge(study, std::vector<double>(400, 1.0), {});
  ScoredModel poorer = judge.Fit({}, nullptr);
  ScoredModel richer = poorer;
  richer.fit.causes = {0};
  poorer.fit.free_parameters += 2;
  for (double& likelihood : richer.noise.log_likelihood) likelihood += 20.0;
  const Comparison comparison = judge.Compare(richer, poorer);
  EXPECT_EQ(comparison.more_parameters, 1.0);
  EXPECT_LT(comparison.p_value, 1e-8);
}

// Two ends that the search chooses cost the same whether the fit moves them or leaves them alone.
TEST(Judge, ChargesLocationsThatNoFitMoves) {
  const ToyRecord record(400);
  const SeparableStudy study(ToyModel(record, WhiteNoise(400, 0.1, 3)));
  const Judge judge(study, std::vector<double>(400, 1.0), {});
  const CauseRule window{.name = "window", .degrees_of_freedom = 3, .location_parameters = 2};
  const double expected = 40.0 - std::log(400.0) - 2.0 * std::log(40.0);
  EXPECT_NEAR(judge.Score({.likelihood_ratio = 40.0, .more_parameters = 3.0}, window), expected, 1e-9);
  EXPECT_NEAR(judge.Score({.likelihood_ratio = 40.0, .more_parameters = 1.0}, window), expected, 1e-9);
}

// When a further impact came is one of so many search locations: charged as such, and not by the samples as
// well.
TEST(Judge, ChargesALocationOfItsOwnOnce) {
  const ToyRecord record(400);
  const SeparableStudy study(ToyModel(record, WhiteNoise(400, 0.1, 3)));
  const Judge judge(study, std::vector<double>(400, 1.0), {});
  ScoredModel poorer = judge.Fit({}, nullptr);
  ScoredModel richer = poorer;
  richer.fit.free_parameters += 8;
  richer.fit.log_search_locations = 13.0;
  richer.fit.location_parameters = 3;
  for (double& likelihood : richer.noise.log_likelihood) likelihood += 50.0;
  const CauseRule impacts{.name = "knocks", .degrees_of_freedom = 3, .location_parameters = 1};
  EXPECT_NEAR(judge.Score(judge.Compare(richer, poorer), impacts),
              100.0 - 4.0 * std::log(400.0) - 4.0 * std::log(100.0) - 2.0 * 13.0, 1e-9);
}

TEST(Diagnose, FindsNothingInCleanRecords) {
  const ToyRecord record(400);
  int alarms = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::vector<double> measured = WhiteNoise(400, 0.1, 500 + seed);
    for (std::size_t i = 0; i < 400; ++i) measured[i] += 5.0 * record.x[i];
    alarms += Diagnose(SeparableStudy(ToyModel(record, measured))).verdict == Verdict::kNoEffect ? 0 : 1;
  }
  // 0.5 % allowed: five or more of 200 would come up once in 270 such tests.
  EXPECT_LE(alarms, 4);
}

TEST(Diagnose, FindsTwoEffectsAndWhatTheyBringOnUnseenData) {
  const ToyRecord record(400);
  std::vector<double> measured = WhiteNoise(400, 0.1, 11);
  for (std::size_t i = 0; i < 400; ++i) {
    const double away = (record.x[i] - 0.7) / 0.02;
    measured[i] += 1.0 + 0.06 * record.square[i] + 0.4 * std::exp(-0.5 * away * away);
  }
  const SeparableStudy study(ToyModel(record, measured));
  const Diagnosis diagnosis = Diagnose(study);
  ASSERT_EQ(diagnosis.verdict, Verdict::kEffectFound);
  ASSERT_EQ(diagnosis.causes.size(), 2u);
  EXPECT_EQ(study.causes()[diagnosis.causes[0].index].name, "bump");
  EXPECT_EQ(study.causes()[diagnosis.causes[1].index].name, "square");
  EXPECT_NEAR(diagnosis.causes[1].parameters[0].value, 0.06, 0.02);
  EXPECT_NEAR(diagnosis.extended_heldout_rmse, 0.1, 0.012);
  EXPECT_GT(diagnosis.gain.low, 0.0);
  EXPECT_GT(diagnosis.gain.high, diagnosis.gain.reduction);
}

TEST(Diagnose, NamesTheRivalWhereTwoCausesFitEquallyWell) {
  const ToyRecord record(400);
  std::vector<double> measured = WhiteNoise(400, 0.1, 12);
  for (std::size_t i = 0; i < 400; ++i) measured[i] += 0.1 * record.square[i];
  SeparableModel model = ToyModel(record, measured);
  model.causes.push_back(Column(record.square, "twin_size"));
  model.rules.push_back({.name = "twin", .parameters = {{"twin_size", "1", -10.0, 10.0, true}}});
  const SeparableStudy study(std::move(model));
  const Diagnosis diagnosis = Diagnose(study);
  ASSERT_EQ(diagnosis.causes.size(), 1u);
  ASSERT_EQ(diagnosis.causes[0].indistinguishable_from.size(), 1u);
  EXPECT_NE(study.causes()[diagnosis.causes[0].index].name, diagnosis.causes[0].indistinguishable_from[0]);
}

// A cause that looks like two others together, which are in the record: found first, as it explains more than
// either.
Diagnosis OfPair(double size, unsigned seed, std::vector<std::string>& names) {
  constexpr std::size_t kSamples = 400;
  const ToyRecord record(kSamples);
  const auto wave = [](double periods, std::size_t i) {
    return std::sqrt(2.0) * std::cos(kTwoPi * periods * static_cast<double>(i) / kSamples);
  };
  std::vector<double> left(kSamples), right(kSamples), both(kSamples);
  std::vector<double> measured = WhiteNoise(kSamples, 0.1, seed);
  for (std::size_t i = 0; i < kSamples; ++i) {
    left[i] = wave(7.0, i);
    right[i] = wave(11.0, i);
    both[i] = left[i] + 0.7 * right[i] + 0.5 * wave(17.0, i);
    measured[i] += size * (left[i] + 0.7 * right[i]);
  }
  SeparableModel model = ToyModel(record, measured);
  const auto add = [&](const std::string& name, const std::vector<double>& column) {
    model.causes.push_back(Column(column, name + "_size"));
    model.rules.push_back({.name = name, .parameters = {{name + "_size", "1", -10.0, 10.0, true}}});
  };
  add("left", left);
  add("right", right);
  add("both", both);
  const SeparableStudy study(std::move(model));
  Diagnosis diagnosis = Diagnose(study);
  for (const Finding& cause : diagnosis.causes) names.push_back(study.causes()[cause.index].name);
  return diagnosis;
}

TEST(Diagnose, PutsAPairInThePlaceOfTheCauseThatMimicsIt) {
  int pairs = 0;
  int rivals = 0;
  for (unsigned seed = 31; seed <= 40; ++seed) {
    std::vector<std::string> names;
    OfPair(0.075, seed, names);
    pairs += names == std::vector<std::string>{"left", "right"} ? 1 : 0;
    names.clear();
    const Diagnosis faint = OfPair(0.035, seed, names);
    if (names != std::vector<std::string>{"both"}) continue;
    const auto& others = faint.causes[0].indistinguishable_from;
    rivals += std::find(others.begin(), others.end(), "left + right") != others.end() ? 1 : 0;
  }
  EXPECT_GE(pairs, 8);
  EXPECT_GE(rivals, 3);
}

// One number that the samples tell to a hundredth of its range, one of which they tell nothing, and one that
// goes with the others and is known no better for that.
TEST(KnownBefore, ChargesANumberByHowMuchOfItsRangeTheRecordExcludes) {
  constexpr double kSamples = 400.0;
  const std::vector<double> ranges{10.0};
  const Eigen::MatrixXd told = Eigen::MatrixXd::Constant(400, 1, 1.0);
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(400, 1);
  // Standard error 2 / √400: ln √(1 + 10² / 0.1² / 2π) twice, of ln 400.
  const double charge = std::log1p(1e4 / kTwoPi) / std::log(kSamples);
  EXPECT_NEAR(KnownBefore(told, none, ranges, 4.0, kSamples), std::max(0.0, 1.0 - charge), 1e-9);
  EXPECT_NEAR(KnownBefore(0.1 * told, none, ranges, 4.0, kSamples),
              1.0 - std::log1p(1e2 / kTwoPi) / std::log(kSamples), 1e-9);
  EXPECT_NEAR(KnownBefore(0.0 * told, none, ranges, 4.0, kSamples), 1.0, 1e-9);
  EXPECT_NEAR(KnownBefore(told, 3.0 * told, ranges, 4.0, kSamples), 1.0, 1e-6);
}

TEST(StandardErrorOver, HoldsWhatModelsThatCannotBeToldBelieve) {
  EXPECT_NEAR(StandardErrorOver(std::vector<Believed>{{1.0, 3.0, 0.2}}), 0.2, 1e-6);
  // As likely, two away: the interval has to reach the tenth of its own that is beyond.
  const double two = StandardErrorOver(std::vector<Believed>{{1.0, 3.0, 0.2}, {1.0, 5.0, 0.2}});
  EXPECT_NEAR(1.959964 * two, 2.0 + 0.2 * 1.281552, 1e-3);
  EXPECT_NEAR(StandardErrorOver(std::vector<Believed>{{1.0, 3.0, 0.2}, {1e-4, 5.0, 0.2}}), 0.2, 1e-3);
  EXPECT_EQ(StandardErrorOver(std::vector<Believed>{{1.0, 3.0, 0.0}}), 0.0);
}

TEST(Diagnose, RefusesACauseWhoseParameterIsOutsideItsRange) {
  const ToyRecord record(400);
  std::vector<double> measured = WhiteNoise(400, 0.1, 13);
  for (std::size_t i = 0; i < 400; ++i) measured[i] += 0.2 * record.square[i];
  SeparableModel model = ToyModel(record, measured);
  model.rules[0].parameters[0].high = 0.1;
  const Diagnosis diagnosis = Diagnose(SeparableStudy(std::move(model)));
  EXPECT_EQ(diagnosis.verdict, Verdict::kNoEffect);
  ASSERT_FALSE(diagnosis.candidates.empty());
  EXPECT_EQ(diagnosis.candidates[0].objection.substr(0, 14), "square_size = ");
}

TEST(Diagnose, CreditsAStructureWithoutANameToNoCause) {
  const ToyRecord record(400);
  std::vector<double> measured = WhiteNoise(400, 0.1, 14);
  for (std::size_t i = 0; i < 400; ++i) measured[i] += 0.2 * std::sin(40.0 * record.x[i]);
  SeparableModel model = ToyModel(record, measured);
  SeparableTerm line;
  line.columns = 2;
  line.fill = [x = record.x](std::span<const double>, Eigen::Ref<Eigen::MatrixXd> design) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      design(static_cast<Eigen::Index>(i), 0) = std::cos(40.0 * x[i]);
      design(static_cast<Eigen::Index>(i), 1) = std::sin(40.0 * x[i]);
    }
  };
  DescribeAsHarmonic(line, "amplitude", "1", 1.0);
  model.causes.push_back(std::move(line));
  model.rules.push_back({.name = "line", .degrees_of_freedom = 2, .named = false});
  const Diagnosis diagnosis = Diagnose(SeparableStudy(std::move(model)));
  EXPECT_EQ(diagnosis.verdict, Verdict::kUnnamedStructure);
  EXPECT_TRUE(diagnosis.causes.empty());
  ASSERT_EQ(diagnosis.nuisance_terms.size(), 1u);
  EXPECT_NEAR(diagnosis.nuisance_terms[0].parameters[0].value, 0.2, 0.03);
}

TEST(Diagnose, LeavesOutSamplesThatStandOff) {
  const ToyRecord record(400);
  std::vector<double> measured = WhiteNoise(400, 0.1, 15);
  measured[77] += 1.5;
  measured[301] -= 4.0;
  const Diagnosis diagnosis = Diagnose(SeparableStudy(ToyModel(record, measured)));
  EXPECT_EQ(diagnosis.verdict, Verdict::kNoEffect);
  EXPECT_EQ(diagnosis.weights[77], 0.0);
  EXPECT_EQ(diagnosis.weights[301], 0.0);
  EXPECT_NEAR(diagnosis.nominal_heldout_rmse, 0.1, 0.015);
}

TEST(Diagnose, TakesGivenCausesAsPartOfTheNominalModel) {
  const ToyRecord record(400);
  std::vector<double> measured = WhiteNoise(400, 0.1, 16);
  for (std::size_t i = 0; i < 400; ++i) measured[i] += 0.2 * record.square[i];
  DiagnoseOptions options;
  options.given_causes = {0};
  const Diagnosis diagnosis = Diagnose(SeparableStudy(ToyModel(record, measured)), options);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNoEffect);
  EXPECT_NEAR(diagnosis.nominal_heldout_rmse, 0.1, 0.015);
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_engine_test
