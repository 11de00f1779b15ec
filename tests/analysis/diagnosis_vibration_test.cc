// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <utility>

#include "analysis/diagnosis/selection.h"
#include "analysis/diagnosis/vibration/one_term.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/units.h"
#include "tests/analysis/message_of.h"
#include "tests/analysis/vibration_record.h"

namespace strainwave::analysis::diagnosis::diagnosis_vibration_test {
namespace {

TEST(VibrationStudy, FindsNothingInCleanNoise) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Diagnosed answer = Ask({Record(Turning(1500.0, 1.0, 0.0), seed, Silence, {1.0, 1.0})});
    EXPECT_EQ(answer.diagnosis.verdict, Verdict::kNoEffect) << seed;
    EXPECT_EQ(answer.names(), Names()) << seed;
  }
}

TEST(VibrationStudy, NamesAGearMeshWithSidebands) {
  const Effect mesh = [](const Turning& run) {
    return Line(run, 162.0, 0.05) + Line(run, 160.0, 0.03) + Line(run, 164.0, 0.015) + Line(run, 158.0, 0.01);
  };
  const Diagnosed answer = Ask({Record(Turning(700.0, 1.5, 0.0), 4, mesh)});
  EXPECT_EQ(answer.names(), Names{"gear_mesh"});
  EXPECT_NEAR(answer.value("mesh_order").value, 162.0, 1e-6);
  EXPECT_NEAR(answer.value("amplitude_m_per_s2").value, 0.05, 0.007);
}

// On their way to the sensor the lines pass a resonance of the structure as the speed rises.
TEST(VibrationStudy, NamesAGearMeshThatPassesAResonance) {
  const Effect mesh = [](const Turning& run) {
    Signal signal;
    for (std::size_t i = 0; i < run.time_s.size(); ++i) {
      double sum = 0.0;
      for (const double order : {160.0, 162.0}) {
        const double ratio = order * run.speed_rad_per_s[i] / (kTwoPi * 1500.0);
        const std::complex<double> gain = 1.0 / std::complex<double>(1.0 - ratio * ratio, 0.3 * ratio);
        sum += (gain * std::polar(0.04, order * run.angle_rad[i])).real();
      }
      signal.push_back(sum);
    }
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(560.0, 1.2, 0.5), 5, mesh)});
  EXPECT_EQ(answer.names(), Names{"gear_mesh"});
  EXPECT_TRUE(answer.diagnosis.nuisance_terms.empty());
}

TEST(VibrationStudy, NamesAnImbalanceThatGrowsWithTheSquareOfTheSpeed) {
  const Effect imbalance = [](const Turning& run) {
    Signal signal;
    for (std::size_t i = 0; i < run.time_s.size(); ++i) {
      const double thousands_rpm = RpmFromRadPerS(run.speed_rad_per_s[i]) / 1000.0;
      signal.push_back(0.03 * thousands_rpm * thousands_rpm * std::sin(run.angle_rad[i]));
    }
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(2000.0, 1.5, 0.8), 6, imbalance)});
  EXPECT_EQ(answer.names(), Names{"imbalance"});
  const ParameterValue amplitude = answer.value("amplitude_at_1000_rpm_m_per_s2");
  EXPECT_NEAR(amplitude.value, 0.03, 4.0 * amplitude.standard_error);
  EXPECT_LT(amplitude.standard_error, 0.005);
}

// What 8 numbers in four channels of 38400 samples bring: BIC would charge each by all samples of all of
// them.
TEST(VibrationStudy, JudgesAnImbalanceInManyChannelsByItsChance) {
  const VibrationData record = Record(Turning(2000.0, 1.0, 0.5), 7, Silence);
  const auto study = MakeVibrationStudy({&record, 1});
  const auto rule = std::ranges::find(study->causes(), "imbalance", &CauseRule::name);
  ASSERT_NE(rule, study->causes().end());
  const Comparison weak{.likelihood_ratio = 47.1,
                        .delta_bic = -48.4,
                        .samples = 4.0 * 38400.0,
                        .p_value = 1.5e-7,
                        .more_parameters = 8.0};
  EXPECT_TRUE(IsBeyondChance(weak, *rule, 1e-5, 0.005));
  EXPECT_FALSE(IsBeyondChance(weak, *rule, 0.01, 0.005));
}

TEST(VibrationStudy, CannotJudgeAnImbalanceAtOneSpeed) {
  const VibrationData record = Record(Turning(2000.0, 1.0, 0.0), 7, Silence);
  const auto study = MakeVibrationStudy({&record, 1});
  EXPECT_TRUE(
      std::ranges::none_of(study->causes(), [](const CauseRule& rule) { return rule.name == "imbalance"; }));
  ASSERT_EQ(study->warnings().size(), 1U);
  EXPECT_EQ(
      study->warnings().front(),
      "imbalance cannot be judged: at one speed it is part of the shaft's own line at 1 per turn (a run "
      "at another speed, or through the speeds, would tell)");
}

TEST(VibrationStudy, NamesAResonanceThatImpactsRing) {
  const Effect impacts = Ringing(140.0, 0.015, {{0.2111, 0.35}, {0.7037, -0.3}});
  const Diagnosed answer = Ask({Record(Turning(1100.0, 1.2, 0.0), 8, impacts)});
  EXPECT_EQ(answer.names(), Names{"torsional_resonance"});
  EXPECT_NEAR(answer.value("frequency_Hz").value, 140.0, 0.8);
  EXPECT_NEAR(answer.value("damping_ratio").value, 0.015, 0.005);
  EXPECT_NEAR(answer.value("knock_1_s").value, 0.2111, 0.001);
  EXPECT_NEAR(answer.value("knock_2_s").value, 0.7037, 0.001);
  // Twenty kinds of resonance in each cell; and one of the impacts may be in any half period of 1.2 s.
  EXPECT_NEAR(answer.diagnosis.extended.log_search_locations, std::log(20.0 * 2.0 * 140.0 * 1.2), 0.01);
}

// Bells of 4 % of their distance at 2 · 81/80 an input turn, stronger on one side of the output.
Signal Crack(const Turning& run) {
  Signal signal;
  for (const double angle : run.angle_rad) {
    const double passings = 2.025 * angle / kTwoPi + 0.2;
    const double off = (passings - std::round(passings)) / 0.04;
    const double bell = std::exp(-0.5 * off * off) - 0.1003;
    signal.push_back(0.09 * bell * (1.0 + 0.5 * std::cos(angle / 80.0)));
  }
  return signal;
}

TEST(VibrationStudy, NamesAFlexsplineCrack) {
  const Diagnosed answer = Ask({Record(Turning(3000.0, 2.0, 0.0), 9, Crack, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names{"flexspline_crack"});
  EXPECT_NEAR(answer.value("crack_order").value, 2.025, 1e-4);
  EXPECT_NEAR(answer.value("pulse_width").value, 0.04, 0.01);
}

// Six standard deviations of the noise in all: too little for numbers that it does not tell.
TEST(VibrationStudy, NamesWeakFlexsplineCracks) {
  const Effect weak = [](const Turning& run) {
    Signal signal = Crack(run);
    for (double& value : signal) value *= 0.165;
    return signal;
  };
  int named = 0;
  for (const unsigned seed : {41U, 42U, 43U, 44U, 45U, 46U, 47U, 48U}) {
    const Diagnosed answer = Ask({Record(Turning(2400.0, 3.0, 0.0), seed, weak, {1.0, 0.7})});
    if (answer.names() == Names{"flexspline_crack"}) ++named;
  }
  EXPECT_GE(named, 6);
}

// The same order, but nothing of a pulse: large enough for its third harmonic to be missed.
TEST(VibrationStudy, TellsTeethThatMeetFromACrack) {
  const Effect teeth = [](const Turning& run) {
    Signal signal = Line(run, 2.025, 0.06);
    const Signal doubled = Line(run, 4.05, 0.03);
    for (std::size_t i = 0; i < signal.size(); ++i) signal[i] += doubled[i];
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(3000.0, 2.0, 0.0), 11, teeth, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names{"gear_mesh"});
  EXPECT_NEAR(answer.value("mesh_order").value, 2.025, 1e-4);
}

// Two harmonics in step look like a wide pulse, but for the third one.
TEST(VibrationStudy, TellsTeethWhoseHarmonicsAreInStepFromACrack) {
  const Effect teeth = [](const Turning& run) {
    Signal signal;
    for (const double angle : run.angle_rad)
      signal.push_back(0.06 * std::cos(2.025 * angle + 0.7) + 0.016 * std::cos(4.05 * angle + 1.4));
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(3000.0, 2.0, 0.0), 11, teeth, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names{"gear_mesh"});
}

// A pulse narrow enough for a crack has a stronger third harmonic.
TEST(VibrationStudy, TellsTeethWithAWeakThirdHarmonicFromACrack) {
  const Effect teeth = [](const Turning& run) {
    return Line(run, 2.025, 0.1) + Line(run, 4.05, 0.042) + Line(run, 6.075, 0.017);
  };
  const Diagnosed answer = Ask({Record(Turning(3000.0, 2.0, 0.0), 12, teeth, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names{"gear_mesh"});
}

// Load that comes and goes with the output turn gives teeth sidebands, and no pulses.
TEST(VibrationStudy, TellsTeethThatMeetHarderOncePerOutputTurnFromACrack) {
  const Effect teeth = [](const Turning& run) {
    Signal signal = Line(run, 2.025, 0.06) + Line(run, 4.05, 0.03);
    for (std::size_t i = 0; i < signal.size(); ++i)
      signal[i] *= 1.0 + 0.3 * std::cos(run.angle_rad[i] / 80.0);
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(3000.0, 2.0, 0.0), 11, teeth, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names{"gear_mesh"});
}

// A place of the flexspline comes by once per output turn, and nothing is observable at the order of its
// impulses.
TEST(VibrationStudy, NamesACrackThatChangesTheShaftsLineOncePerOutputTurn) {
  const Effect changing = [](const Turning& run) {
    Signal signal;
    for (const double angle : run.angle_rad)
      signal.push_back(0.08 * std::cos(angle / 80.0 + 0.4) * std::cos(2.0 * angle + 0.9));
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(3000.0, 4.0, 0.0), 11, changing, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names{"flexspline_crack"});
  EXPECT_NEAR(answer.value("line_1").value, 2.0 - 1.0 / 80.0, 1e-6);
  EXPECT_NEAR(answer.value("line_2").value, 2.0 + 1.0 / 80.0, 1e-6);
}

// Where teeth have a sideband as well, but nothing is where these would meet.
TEST(VibrationStudy, TakesOneSidebandOfTheShaftForNoCrackAndForNoTeethThatMeet) {
  const Effect line = [](const Turning& run) { return Line(run, 2.0 + 1.0 / 80.0, 0.06); };
  const Diagnosed answer = Ask({Record(Turning(3000.0, 4.0, 0.0), 11, line, {1.0, -0.7})});
  EXPECT_EQ(answer.names(), Names());
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
}

TEST(VibrationStudy, CallsALineOfNoCauseUnnamed) {
  const Effect line = [](const Turning& run) { return Line(run, 7.3, 0.04); };
  const Diagnosed answer = Ask({Record(Turning(1500.0, 1.2, 0.0), 10, line)});
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
  ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1U);
  EXPECT_NEAR(answer.diagnosis.nuisance_terms.front().parameters.front().value, 7.3, 0.01);
}

TEST(VibrationStudy, TakesTheSpeedFromTheShaftsLinesWhereTheRecordDoesNotSayIt) {
  const Effect line = [](const Turning& run) { return Line(run, 7.3, 0.04); };
  VibrationData record = Record(Turning(1500.0, 1.2, 0.0), 13, line);
  record.input_speed_rad_per_s.clear();
  const Diagnosed answer = Ask({record});
  ASSERT_FALSE(answer.study->warnings().empty());
  EXPECT_EQ(answer.study->warnings().front().substr(0, 50),
            "the record does not say the input speed: 1500 rpm ");
  ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1U);
  EXPECT_NEAR(answer.diagnosis.nuisance_terms.front().parameters.front().value, 7.3, 0.01);
}

// Over nine turns the shaft's two lines are not quite apart, least of all with spikes between them.
TEST(VibrationStudy, TakesAWrongSpeedFromTheLinesOfAFewTurns) {
  for (const unsigned seed : {51U, 52U, 53U, 54U}) {
    VibrationData record = Record(Turning(1100.8, 0.5, 0.0), seed, Silence);
    Signal& values = record.channels.front().values;
    values = values + Line(Turning(1100.8, 0.5, 0.0), 2.0, 0.9);
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::size_t> place(0, values.size() - 1);
    for (int spike = 0; spike < 16; ++spike) values[place(random)] += spike % 2 == 0 ? 1.0 : -1.0;
    record.input_speed_rad_per_s.front() *= 1092.6 / 1100.8;
    const Diagnosed answer = Ask({record});
    ASSERT_FALSE(answer.study->warnings().empty()) << seed;
    EXPECT_EQ(answer.study->warnings().front().substr(0, 30), "the shaft's lines stand at 110") << seed;
    EXPECT_EQ(answer.diagnosis.verdict, Verdict::kNoEffect) << seed;
  }
}

// Twenty spikes of thirty standard deviations a second: with them the channel would seem to be twice as
// large.
TEST(PrepareVibration, ScalesChannelsToEqualNoiseWhateverSpikesThereAre) {
  VibrationData record = Record(Turning(1500.0, 1.0, 0.0), 31, Silence, {1.0, 1.0});
  for (std::size_t i = 100; i < record.time_s.size(); i += 256) record.channels[0].values[i] += 3.0;
  const VibrationSamples samples = PrepareVibration({&record, 1});
  const auto& channels = samples.runs.front().channels;
  constexpr double kErrorOfScale = 0.1;  // of a background of some thousand bins
  EXPECT_NEAR(channels[0].scale / channels[1].scale, 1.0, kErrorOfScale);
  EXPECT_NEAR(samples.noise_floor, kNoise_m_per_s2, kErrorOfScale * kNoise_m_per_s2);
}

// A strong line that a rising speed spreads over more than half of a block of the spectrum.
TEST(PrepareVibration, ScalesChannelsToEqualNoiseWhateverLinesTheSpeedSpreads) {
  const Turning run(3000.0, 1.0, 1.4);
  VibrationData record = Record(run, 32, Silence, {1.0, 1.0});
  Signal& strong = record.channels[0].values;
  strong = strong + Line(run, 2.0, 80.0 * kNoise_m_per_s2);
  const VibrationSamples samples = PrepareVibration({&record, 1});
  const auto& channels = samples.runs.front().channels;
  EXPECT_NEAR(channels[0].scale / channels[1].scale, 1.0, 0.1);
}

// What a search compares has to be what the whole fit comes to.
TEST(OneTermSolver, FitsATermAsTheWholeModelDoes) {
  const Effect hidden = [](const Turning& run) { return Line(run, 7.3, 0.2) + Line(run, 11.9, 0.1); };
  const VibrationData record = Record(Turning(1500.0, 0.5, 0.1), 21, hidden, {1.0, -0.6});
  const VibrationSamples samples = PrepareVibration({&record, 1});
  std::vector<double> weights(samples.measured.size(), 1.0);
  weights[100] = weights[101] = 0.0;  // of one channel
  const VibrationSolver solver(samples, weights);
  const VibrationTerm known{0, VibrationForm::kLines, {{1.0, 0.0}}, {11.9}, {1, 1}};
  const VibrationTerm tone{1, VibrationForm::kNarrowband, {}, {150.0, 0.02, 0.05, 0.03}, {1, 1}};
  // What a tone predicts is taken off after the lines are fitted: beside its band that changes little.
  struct Model {
    std::vector<VibrationTerm> terms;
    double share;          // of the sum of squares that the two may differ by
    double left_m_per_s2;  // that their residuals may
  };
  for (const auto& [model, share, most_left] :
       {Model{{known}, 1e-9, 1e-9}, Model{{known, tone}, 1e-3, 0.1 * kNoise_m_per_s2}}) {
    const VibrationSolution base = solver.Solve(model);
    const OneTermSolver beside(samples, solver, base);
    const VibrationTerm line{2, VibrationForm::kLines, {{1.0, 0.0}, {1.0, 1.0}}, {7.31}, {1, 1}};
    const TermFit fit = beside.Refine(beside.Fit(line), 8);
    EXPECT_NEAR(fit.term.nonlinear_parameters[0], 7.3, 0.005);
    std::vector<VibrationTerm> all = model;
    all.push_back(fit.term);
    const VibrationSolution whole = solver.Solve(all);
    EXPECT_NEAR(fit.square_sum, whole.square_sum, share * whole.square_sum);
    EXPECT_EQ(fit.free_parameters, whole.free_parameters);
    const Eigen::VectorXd left = beside.Residual(fit) - solver.Residual(whole);
    EXPECT_LT(left.cwiseAbs().head(100).maxCoeff(), most_left);
  }
}

TEST(VibrationStudy, SaysWhatIsWrongWithARecord) {
  const auto message = [](const VibrationData& record) { return RefusalOf(&MakeVibrationStudy, record); };
  const Turning run(1500.0, 1.0, 0.0);
  const VibrationData good = Record(run, 14, Silence);
  VibrationData record = good;
  record.time_s.resize(200);
  record.channels[0].values.resize(200);
  EXPECT_EQ(message(record), "the record has 200 samples (expected at least 256)");
  record.time_s.resize(300);
  std::copy_n(good.time_s.begin(), 300, record.time_s.begin());
  record.channels[0].values.assign(good.channels[0].values.begin(), good.channels[0].values.begin() + 300);
  EXPECT_EQ(message(record),
            "the record is too short: 1.46 turns of the input shaft at 1500 rpm (expected at least 2)");
  record = good;
  record.channels[0].values.pop_back();
  EXPECT_EQ(message(record), "accel_x_m_per_s2 has 5119 samples, time has 5120 (expected as many)");
  record = good;
  record.channels[0].values.assign(run.time_s.size(), 0.5);
  EXPECT_EQ(message(record), "no channel moves (expected at least one accelerometer)");
}

// A gear of so many teeth has lines where the shaft's would be if the speed were in Hz.
TEST(VibrationStudy, QuestionsTheUnitOfASpeedAndGoesOn) {
  const Turning run(1500.0, 1.0, 0.0);
  VibrationData record = Record(run, 14, Silence);
  record.input_speed_rad_per_s = {RadPerSFromRpm(RadPerSFromRpm(1500.0))};
  const std::unique_ptr<Study> uncertain = MakeVibrationStudy({&record, 1});
  ASSERT_FALSE(uncertain->warnings().empty());
  EXPECT_EQ(uncertain->warnings().front(),
            "the input speed may be in rad/s: the file says 157.1 rpm, where the shaft has no clear lines; a "
            "pair at 1 and 2 per turn of 1500 rpm stands out. It was taken as the file says, input_speed_rpm "
            "in turns per minute");
  // Nothing is wrong here, and nobody can tell.
  const Turning slow(600.0, 1.0, 0.0);
  const Effect teeth = [](const Turning& at) { return Line(at, 60.0, 0.3) + Line(at, 120.0, 0.2); };
  record = Record(slow, 15, teeth);
  const Signal shaft = Line(slow, 1.0, -0.2) + Line(slow, 2.0, -0.3);
  record.channels.front().values = std::move(record.channels.front().values) + shaft;
  const std::unique_ptr<Study> right = MakeVibrationStudy({&record, 1});
  ASSERT_FALSE(right->warnings().empty());
  EXPECT_EQ(
      right->warnings().front(),
      "the input speed may be in Hz: the file says 600 rpm, where the shaft has no clear lines; a pair "
      "at 1 and 2 per turn of 3.6e+04 rpm stands out. It was taken as the file says, input_speed_rpm in "
      "turns per minute");
}

// Every gear has lines where its teeth meet: the name says so, and stands once.
TEST(VibrationStudy, WordsAGearMeshAsWhatEveryGearHas) {
  const Turning run(600.0, 2.0, 0.0);
  const Effect mesh = [](const Turning& at) {
    return Line(at, 160.0, 0.1) + Line(at, 162.0, 0.06) + Line(at, 2.025, 0.1) + Line(at, 4.05, 0.05);
  };
  const Diagnosed found = Ask({Record(run, 24, mesh)});
  EXPECT_EQ(std::ranges::count(found.names(), "gear_mesh"), 1);
  for (const CauseRule& rule : found.study->causes()) {
    if (rule.name == "gear_mesh") {
      EXPECT_NE(rule.sentence.find("every gear has"), std::string::npos) << rule.sentence;
    }
  }
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_vibration_test
