// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <vector>

#include "analysis/diagnosis/vibration/bearing_orders.h"
#include "analysis/diagnosis/vibration/families.h"
#include "analysis/diagnosis/vibration/samples.h"
#include "analysis/diagnosis/vibration/solver.h"
#include "analysis/diagnosis/vibration/starts.h"
#include "analysis/units.h"
#include "tests/analysis/vibration_record.h"

namespace strainwave::analysis::diagnosis::diagnosis_bearing_test {
namespace {

// Outer race of 21 balls, d/D = 0.1: 9.45 an input turn, twice modulated a turn by the ellipse.
Effect Bearing(double height, double order = 9.45, double resonance_Hz = 1230.0, double damping = 0.03) {
  return [=](const Turning& run) {
    Signal signal = Silence(run);
    std::size_t i = 0;
    for (int impact = -5; i + 1 < run.angle_rad.size(); ++impact) {
      const double angle = (impact - 0.4) * kTwoPi / order;
      while (i + 1 < run.angle_rad.size() && run.angle_rad[i + 1] < angle) ++i;
      if (i + 1 == run.angle_rad.size()) break;
      const double share = (angle - run.angle_rad[i]) / (run.angle_rad[i + 1] - run.angle_rad[i]);
      const double zones = 1.0 + 0.6 * std::cos(2.0 * angle + 0.3);
      AddRinging(run, (static_cast<double>(i) + share) / kRate_Hz, height * zones, resonance_Hz, damping,
                 signal);
    }
    return signal;
  };
}

TEST(BearingSearch, NamesABearingByItsOrderWhileTheSpeedChanges) {
  const Diagnosed answer = Ask({Record(Turning(1500.0, 1.2, 0.2), 5, Bearing(0.15), {1.0, -0.6})});
  EXPECT_EQ(answer.names(), Names{"bearing_defect"});
  const ParameterValue order = answer.value("defect_order");
  EXPECT_NEAR(order.value, 9.45, 4.0 * order.standard_error);
  EXPECT_LT(order.standard_error, 0.002);
  EXPECT_NEAR(answer.value("ring_Hz").value, 1230.0, 15.0);
  EXPECT_NEAR(answer.value("ring_decay_ratio").value, 0.03, 0.012);
}

// Each harmonic is lost in the noise: only their sum with phases and sidebands shows them.
TEST(BearingSearch, NamesWeakBearings) {
  for (const unsigned seed : {31U, 32U, 33U}) {
    const Diagnosed answer = Ask({Record(Turning(900.0, 1.2, 0.0), seed, Bearing(0.036))});
    EXPECT_EQ(answer.names(), Names{"bearing_defect"}) << seed;
    if (answer.names() == Names{"bearing_defect"}) {
      EXPECT_NEAR(answer.value("defect_order").value, 9.45, 0.01) << seed;
    }
  }
}

// The resonance lies at a harmonic or next to it, so that most is in one line: the change of the impulses,
// two numbers more, is what says that it is no line alone.
TEST(BearingSearch, NamesWeakBearingsByTheChangeOfTheirImpulses) {
  const struct {
    double speed_rpm;
    double height;
    unsigned seed;
  } records[] = {{1540.0, 0.027, 45}, {1561.9, 0.046, 42}, {1580.0, 0.025, 43}};
  for (const auto& [speed_rpm, height, seed] : records) {
    const Diagnosed answer = Ask({Record(Turning(speed_rpm, 1.2, 0.0), seed, Bearing(height))});
    EXPECT_EQ(answer.names(), Names{"bearing_defect"}) << seed;
  }
}

// Nineteen parts in twenty are one line; what is beside it is no line's.
TEST(BearingSearch, NamesBearingsOfWhichNearlyAllIsOneLine) {
  for (const unsigned seed : {1U, 2U, 5U, 6U}) {
    const Diagnosed answer =
        Ask({Record(Turning(1952.4, 1.5, 0.0), seed, Bearing(0.028, 9.45, 1230.0, 0.015), {1.0, 0.7, 0.5})});
    EXPECT_EQ(answer.names(), Names{"bearing_defect"}) << seed;
  }
}

// Nine turns do not tell by how far the three harmonics that are observable are apart from each other that
// their order is none of a whole or half; by where they stand they do.
TEST(BearingSearch, NamesBearingsNextToWholeAndHalfOrders) {
  for (const double order : {9.02, 8.98, 12.48}) {
    const Diagnosed answer = Ask({Record(Turning(1368.0, 0.4, 0.0), 51, Bearing(0.15, order))});
    EXPECT_EQ(answer.names(), Names{"bearing_defect"}) << order;
    if (answer.names() == Names{"bearing_defect"}) {
      EXPECT_NEAR(answer.value("defect_order").value, order, 0.004);
    }
  }
}

// Half a period of the resonance to either side the impulses explain nearly as much with a resonance that is
// too long.
TEST(BearingSearch, KnowsHowABearingRings) {
  for (const double speed_rpm : {1300.0, 1420.0, 1480.0, 1540.0, 1600.0}) {
    const Diagnosed answer = Ask({Record(Turning(speed_rpm, 0.5, 0.0), 52, Bearing(0.3), {1.0, 0.7})});
    EXPECT_EQ(answer.names(), Names{"bearing_defect"}) << speed_rpm;
    const ParameterValue decay = answer.value("ring_decay_ratio");
    EXPECT_NEAR(decay.value, 0.03, 4.0 * decay.standard_error) << speed_rpm;
  }
}

// Most of the noise is far below the resonance; beside what is about it the weaker harmonics are clear.
TEST(BearingSearch, NamesABearingAboveTheNoise) {
  for (const unsigned seed : {61U, 63U, 64U}) {
    const Effect defect = [=](const Turning& run) {
      return Bearing(0.1)(run) + ColouredNoise(run, seed + 10, 0.5, 0.8);
    };
    EXPECT_EQ(Ask({Record(Turning(1540.0, 1.2, 0.0), seed, defect)}).names(), Names{"bearing_defect"})
        << seed;
  }
}

// The first fit has the impulses half a period of the resonance too early or late, where a fit leads nowhere.
TEST(BearingSearch, NamesBearingsThatTheFirstFitMisplaces) {
  const struct {
    double height;
    unsigned seed;
  } records[] = {{0.045, 3}, {0.05625, 2}};
  for (const auto& [height, seed] : records) {
    const VibrationData record =
        Record(Turning(1520.0, 0.5, 0.0), seed, Bearing(height, 10.74, 2350.0, 0.018));
    EXPECT_EQ(Ask({record}).names(), Names{"bearing_defect"}) << seed;
  }
}

// A train that rings as broadly as the noise is coloured takes away more squares than the bearing.
TEST(BearingSearch, TakesTheColourOfTheNoiseForNoTrain) {
  constexpr unsigned kSeed = 11;
  const Effect defect = [](const Turning& run) {
    return Bearing(0.05625, 11.2, 1300.0, 0.04)(run) + ColouredNoise(run, kSeed + 10, 0.3, 0.8);
  };
  EXPECT_EQ(Ask({Record(Turning(1210.0, 1.2, 0.0), kSeed, defect)}).names(), Names{"bearing_defect"});
}

// A healthy motor: lines at whole orders, one of the current's that is none, with the shaft's sidebands about
// it. Four turns do not tell how far apart these are from the harmonics of an order near four, and together
// they beat like impacts.
TEST(BearingSearch, TakesSidebandsOfTheShaftForNoDefect) {
  unsigned seed = 40;
  for (const double centre : {58.46, 73.46, 76.46, 78.3}) {
    ++seed;
    const Effect healthy = [=](const Turning& run) {
      return Line(run, 3.0, 0.2) + Line(run, 36.0, 0.3) + Line(run, centre, 0.6) +
             Line(run, centre - 4.01, 0.4) + Line(run, centre + 4.0, 0.3) +
             ColouredNoise(run, seed, 0.1, 0.7);
    };
    const Diagnosed answer = Ask({Record(Turning(1796.0, 0.14, 0.0), seed, healthy, {1.0, 0.4})});
    EXPECT_EQ(answer.names(), Names()) << centre;
    EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure) << centre;
  }
}

TEST(BearingSearch, JoinsRecordsThatDoNotShowABearingAlone) {
  const std::vector<VibrationData> records{Record(Turning(1500.0, 1.0, 0.0), 11, Bearing(0.03)),
                                           Record(Turning(1500.0, 1.0, 0.0), 12, Bearing(0.03))};
  EXPECT_EQ(Ask({records[0]}).names(), Names());
  const Diagnosed joint = Ask(records);
  EXPECT_EQ(joint.names(), Names{"bearing_defect"});
  EXPECT_NEAR(joint.value("defect_order").value, 9.45, 0.01);
}

// Half of a response is left where the next begins: one that never dies away fits the strongest harmonic a
// little better, but such a thing is a line.
TEST(BearingSearch, NamesABearingWhoseImpulsesRingIntoEachOther) {
  constexpr double kSpeed_rpm = 2700.0;
  constexpr double kOrder = 10.4;
  constexpr double kResonance_Hz = 3.05 * kOrder * kSpeed_rpm / 60.0;
  const struct {
    double height;
    unsigned seed;
  } records[] = {{0.05, 1}, {0.04, 3}};
  for (const auto& [height, seed] : records) {
    const VibrationData record = Record(Turning(kSpeed_rpm, 0.95, 0.0), seed,
                                        Bearing(height, kOrder, kResonance_Hz, 0.016), {0.9, 1.0, 0.9});
    EXPECT_EQ(Ask({record}).names(), Names{"bearing_defect"}) << seed;
  }
}

constexpr double kTurn_Hz = 25.0;

// Whether a term may be a bearing's in a record of 25 turns a second.
bool IsBearingIn(const Effect& effect, const VibrationTerm& term) {
  const VibrationData record = Record(Turning(60.0 * kTurn_Hz, 3.0, 0.0), 12, effect);
  const VibrationSamples samples = PrepareVibration({&record, 1});
  const std::vector<double> weights(samples.measured.size(), 1.0);
  const VibrationSolver solver(samples, weights);
  const VibrationSolution base = solver.Solve({});
  const VibrationResidual residual(samples, solver, base);
  return IsBearing(residual, term);
}

bool IsBearingIn(const Effect& effect, double order, double resonance_order, double decay) {
  return IsBearingIn(effect, {.form = VibrationForm::kImpulseTrain,
                              .lines = {},
                              .nonlinear_parameters = {order, resonance_order * kTurn_Hz, decay},
                              .observable = {}});
}

// Sixteen orders are sampled: of a defect at 13.43 the first line is there and what the two load zones make
// of it, nothing more.
TEST(BearingSearch, NamesABearingByItsFirstLineAndTheLoadZonesSidebands) {
  const Effect tones = [](const Turning& run) {
    Signal signal;
    for (const double angle : run.angle_rad)
      signal.push_back(0.06 * (1.0 + 0.8 * std::cos(2.0 * angle + 0.3)) * std::cos(13.43 * angle));
    return signal;
  };
  const Diagnosed answer = Ask({Record(Turning(9300.0, 1.6, 0.0), 91, tones, {1.0, 0.4})});
  EXPECT_EQ(answer.names(), Names{"bearing_defect"});
  EXPECT_NEAR(answer.value("defect_order").value, 13.43, 0.002);
}

// Of a record at 10 kHz. Chance finds trains with the density f² / (order² ζ); over orders, octaves of
// resonances and octaves of dampings its mean is what the rule counts.
TEST(LogSearchLocationsOfTrain, SharesWhatChanceMayFindEvenlyAmongOrdersAndOctaves) {
  VibrationSamples samples;
  samples.runs.emplace_back().period_s = 1e-4;
  const auto log_search_locations = [&](double order, double resonance_Hz, double damping) {
    VibrationTerm train;
    train.form = VibrationForm::kImpulseTrain;
    train.nonlinear_parameters = {order, resonance_Hz, damping, 0.0};
    return LogSearchLocationsOfTrain(samples, train);
  };
  constexpr int kSteps = 60;
  double mean = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      for (int k = 0; k < kSteps; ++k) {
        const auto at = [](int step) { return (step + 0.5) / kSteps; };
        const double order = kLowestBearingOrder + at(i) * (kHighestBearingOrder - kLowestBearingOrder);
        const double resonance_Hz = 300.0 * std::pow(4800.0 / 300.0, at(j));
        const double damping = 0.008 * std::pow(0.6 / 0.008, at(k));
        mean += std::exp(log_search_locations(order, resonance_Hz, damping)) / (kSteps * kSteps * kSteps);
      }
    }
  }
  EXPECT_NEAR(mean, 1.0, 0.01);
  EXPECT_NEAR(log_search_locations(6.0, 2000.0, 0.03) - log_search_locations(6.0, 1000.0, 0.03),
              std::log(4.0), 1e-9);
  EXPECT_NEAR(log_search_locations(6.0, 2000.0, 0.03) - log_search_locations(12.0, 2000.0, 0.03),
              std::log(4.0), 1e-9);
  EXPECT_NEAR(log_search_locations(6.0, 2000.0, 0.03) - log_search_locations(6.0, 2000.0, 0.06),
              std::log(2.0), 1e-9);
}

// Of a train that rings on so long one harmonic is observable, and 9 of 17.778 are order 160: of teeth.
TEST(IsBearing, TakesNoLineAtAWholeOrderForATrain) {
  EXPECT_FALSE(IsBearingIn(Silence, 160.0 / 9.0, 160.2, 0.006));
  EXPECT_TRUE(IsBearingIn(Silence, 17.86, 160.7, 0.006));       // nine of it are 160.74
  EXPECT_TRUE(IsBearingIn(Silence, 160.0 / 9.0, 160.2, 0.06));  // its neighbours are observable, too
}

// Nine of 8.889 are order 80, and little is let through of the others: as much as is seen says that they are
// there. A line of teeth has its sidebands elsewhere.
TEST(IsBearing, TakesTheHarmonicsBesideALineAtAWholeOrderForATrain) {
  constexpr double kOrder = 80.0 / 9.0;
  constexpr double kDamping = 0.012;
  EXPECT_TRUE(IsBearingIn(Bearing(0.1, kOrder, 80.1 * kTurn_Hz, kDamping), kOrder, 80.1, kDamping));
  const Effect teeth = [](const Turning& run) {
    return Line(run, 80.0, 1.0) + Line(run, 78.0, 0.3) + Line(run, 81.0, 0.2);
  };
  EXPECT_FALSE(IsBearingIn(teeth, kOrder, 80.1, kDamping));
}

// A shaft with two impacts a turn has all even orders: 6, 9 and 12 of 14/3 with what stands 2 beside them.
TEST(IsBearing, TakesNoLinesAtWholeOrdersForABearing) {
  VibrationTerm lines{.form = VibrationForm::kLines,
                      .lines = {{6.0, 0.0}, {9.0, 0.0}, {12.0, 0.0}, {12.0, 2.0}, {12.0, -2.0}},
                      .nonlinear_parameters = {14.0 / 3.0},
                      .observable = {1}};
  EXPECT_FALSE(IsBearingIn(Silence, lines));
  lines.lines.push_back({7.0, 0.0});
  EXPECT_TRUE(IsBearingIn(Silence, lines));
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_bearing_test
