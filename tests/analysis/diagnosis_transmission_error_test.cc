// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "analysis/diagnosis/diagnose.h"
#include "analysis/diagnosis/records.h"
#include "analysis/units.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis::diagnosis_transmission_error_test {
namespace {

// What one sample of the sweep knows, for an effect to be hidden in it.
struct Place {
  double input_rad;
  double output_rad;
  double direction;
  double time_s;
  double torque_Nm;
  double temperature_degC;
};
using Effect = std::function<double(const Place&)>;  // arcmin

constexpr double kNoise_arcmin = 0.02;

// Places along the turn in steps of `step_deg`, there and back.
std::vector<double> EvenPlaces_deg(double step_deg) {
  const int steps = static_cast<int>(std::lround(360.0 / step_deg));
  std::vector<double> places_deg;
  for (int i = 0; i < 2 * steps; ++i) places_deg.push_back(step_deg * (i < steps ? i : 2 * steps - 1 - i));
  return places_deg;
}

// One turn each way over such places at ratio 80, 0.5 arcmin of second harmonic, and the effect.
TransmissionErrorData SweepOver(const std::vector<double>& places_deg, unsigned seed, const Effect& effect) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, RadFromArcmin(kNoise_arcmin));
  std::normal_distribution<double> torque_noise(0.0, 0.5);
  TransmissionErrorData record;
  for (std::size_t i = 0; i < places_deg.size(); ++i) {
    const bool clockwise = 2 * i < places_deg.size();
    const double along_deg = places_deg[i];
    Place place{80.0 * RadFromDeg(along_deg),
                RadFromDeg(along_deg),
                clockwise ? 1.0 : -1.0,
                2.0 * static_cast<double>(i),
                0.0,
                0.0};
    place.torque_Nm = 5.0 * std::sin(0.013 * place.time_s) + torque_noise(random);
    place.temperature_degC = 25.0 + 0.002 * place.time_s + 0.3 * std::sin(0.004 * place.time_s);
    const double error =
        RadFromArcmin(0.3 + 0.5 * std::cos(2.0 * place.input_rad - 0.8) + effect(place)) + noise(random);
    record.input_angle_rad.push_back(place.input_rad);
    record.output_angle_rad.push_back(place.input_rad / 80.0 - error);
    record.direction.push_back(clockwise ? 1 : -1);
    record.time_s.push_back(place.time_s);
    record.torque_Nm.push_back(place.torque_Nm);
    record.temperature_degC.push_back(place.temperature_degC);
  }
  return record;
}

TransmissionErrorData Sweep(unsigned seed, const Effect& effect, double step_deg = 1.0) {
  return SweepOver(EvenPlaces_deg(step_deg), seed, effect);
}

void KeepFirst(TransmissionErrorData& record, std::size_t samples) {
  for (auto* column : {&record.input_angle_rad, &record.output_angle_rad, &record.time_s, &record.torque_Nm,
                       &record.temperature_degC}) {
    column->resize(samples);
  }
  record.direction.resize(samples);
}

// As many places as with even steps, drawn at random.
TransmissionErrorData UnevenSweep(unsigned seed, const Effect& effect, double step_deg = 1.0) {
  std::vector<double> places_deg = EvenPlaces_deg(step_deg);
  std::mt19937 random(seed + 1000);
  std::uniform_real_distribution<double> anywhere_deg(0.0, 360.0);
  for (double& place_deg : places_deg) place_deg = anywhere_deg(random);
  const auto turning = places_deg.begin() + static_cast<std::ptrdiff_t>(places_deg.size() / 2);
  std::sort(places_deg.begin(), turning);
  std::sort(turning, places_deg.end(), std::greater<>());
  return SweepOver(places_deg, seed, effect);
}

struct Answer {
  std::unique_ptr<Study> study;
  Diagnosis diagnosis;

  std::string name() const {
    return diagnosis.causes.empty() ? "none" : study->causes()[diagnosis.causes.front().index].name;
  }
  double value(const std::string& parameter) const {
    for (const ParameterValue& value : diagnosis.causes.front().parameters) {
      if (value.name == parameter) return value.value;
    }
    return NAN;
  }
};

Answer Ask(const TransmissionErrorData& record) {
  Answer answer;
  answer.study = MakeTransmissionErrorStudy({&record, 1});
  answer.diagnosis = Diagnose(*answer.study);
  return answer;
}

// A resolution of 1.3 arcmin beside a second harmonic of 0.5: what rounding makes of the one follows the
// other.
TEST(TransmissionErrorStudy, ClaimsNothingThatItsEncodersStepsDo) {
  constexpr double kStep_rad = kTwoPi / 16384.0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    TransmissionErrorData record = Sweep(
        seed, [](const Place&) { return 0.0; }, 1.03);
    for (double& angle_rad : record.output_angle_rad)
      angle_rad = kStep_rad * std::round(angle_rad / kStep_rad);
    const Answer answer = Ask(record);
    EXPECT_TRUE(answer.diagnosis.causes.empty()) << seed;
    EXPECT_TRUE(answer.diagnosis.nuisance_terms.empty()) << seed;
  }
}

TEST(TransmissionErrorStudy, NamesEachCauseOfTheListAndItsSize) {
  struct Case {
    std::string name;
    std::string parameter;
    double value;
    double tolerance;
    Effect effect;
  };
  const std::vector<Case> cases{
      {"wave_generator_first_harmonic", "amplitude_arcmin", 0.02, 0.005,
       [](const Place& at) { return 0.02 * std::cos(at.input_rad + 1.0); }},
      {"wave_generator_fourth_harmonic", "amplitude_arcmin", 0.02, 0.005,
       [](const Place& at) { return 0.02 * std::cos(4.0 * at.input_rad + 1.0); }},
      {"output_eccentricity", "amplitude_arcmin", 0.02, 0.005,
       [](const Place& at) { return 0.02 * std::cos(at.output_rad + 2.0); }},
      {"circular_spline_ovality", "amplitude_arcmin", 0.02, 0.005,
       [](const Place& at) { return 0.02 * std::cos(2.0 * at.output_rad + 3.0); }},
      {"tooth_engagement", "amplitude_arcmin", 0.02, 0.005,
       [](const Place& at) { return 0.02 * std::cos(162.0 * at.output_rad); }},
      {"backlash", "backlash_arcmin", 0.03, 0.006, [](const Place& at) { return 0.015 * at.direction; }},
      {"thermal_drift", "drift_arcmin_per_K", 0.03, 0.006,
       [](const Place& at) { return 0.03 * (at.temperature_degC - 25.0); }},
      {"local_tooth_damage", "centre_deg", 212.0, 0.6,
       [](const Place& at) {
         return 0.12 * std::exp(-0.5 * std::pow((DegFromRad(at.output_rad) - 212.0) / 1.5, 2.0));
       }},
      {"load_windup", "windup_arcmin_per_Nm", 0.006, 0.001,
       [](const Place& at) { return 0.006 * at.torque_Nm; }}};
  for (const Case& hidden : cases) {
    const Answer answer = Ask(Sweep(31, hidden.effect));
    EXPECT_EQ(answer.name(), hidden.name);
    if (answer.diagnosis.causes.empty()) continue;
    EXPECT_EQ(answer.diagnosis.causes.size(), 1u) << hidden.name;
    EXPECT_NEAR(answer.value(hidden.parameter), hidden.value, hidden.tolerance) << hidden.name;
  }
}

// Felt by the flank that is in contact when it turns this way.
TEST(TransmissionErrorStudy, NamesADamageOfOneFlank) {
  const Answer answer = Ask(Sweep(36, [](const Place& at) {
    if (at.direction < 0.0) return 0.0;
    return 0.12 * std::exp(-0.5 * std::pow((DegFromRad(at.output_rad) - 143.0) / 1.5, 2.0));
  }));
  EXPECT_EQ(answer.name(), "local_tooth_damage");
  EXPECT_EQ(answer.diagnosis.causes.size(), 1u);
  EXPECT_NEAR(answer.value("centre_deg"), 143.0, 0.8);
  EXPECT_NEAR(answer.value("height_cw_arcmin"), 0.12, 0.03);
}

// The room warms and cools once in the record, which has no temperature.
TEST(TransmissionErrorStudy, NamesADriftThatSwingsBack) {
  TransmissionErrorData record =
      Sweep(32, [](const Place& at) { return 0.08 * std::sin(kTwoPi * at.time_s / 1300.0); });
  record.temperature_degC.clear();
  const Answer answer = Ask(record);
  EXPECT_EQ(answer.name(), "thermal_drift");
  EXPECT_EQ(answer.diagnosis.causes.size(), 1u);
  EXPECT_TRUE(answer.diagnosis.nuisance_terms.empty());
  EXPECT_NEAR(answer.value("drift_swing_arcmin"), 0.08, 0.01);
  EXPECT_NEAR(answer.value("period_s"), 1300.0, 150.0);
}

// Of two lags behind one another, of which ours knows one, and nobody kept the temperature.
TEST(TransmissionErrorStudy, NamesADriftOfAnotherLaw) {
  TransmissionErrorData record = Sweep(37, [](const Place& at) {
    const double lags = at.time_s / 170.0;
    return 0.3 * (1.0 - (1.0 + lags) * std::exp(-lags));
  });
  record.temperature_degC.clear();
  const Answer answer = Ask(record);
  EXPECT_EQ(answer.name(), "thermal_drift");
  EXPECT_EQ(answer.diagnosis.causes.size(), 1u);
}

// One or two samples a pass stand off, but in each pass: no outliers.
TEST(TransmissionErrorStudy, NamesADamageThatIsAsNarrowAsTheSteps) {
  const Answer answer = Ask(Sweep(33, [](const Place& at) {
    return 0.4 * std::exp(-0.5 * std::pow((DegFromRad(at.output_rad) - 100.3) / 0.42, 2.0));
  }));
  EXPECT_EQ(answer.name(), "local_tooth_damage");
  EXPECT_EQ(answer.diagnosis.causes.size(), 1u);
  EXPECT_NEAR(answer.value("centre_deg"), 100.3, 1.0);  // within a step
}

// Without the two samples in its middle nobody could predict how high a bump is that no other pass has.
TEST(TransmissionErrorStudy, NamesADamageOfAFewSamplesThatOnePassHas) {
  int named = 0;
  for (unsigned seed = 90; seed < 98; ++seed) {
    TransmissionErrorData record = Sweep(seed, [](const Place& at) {
      return 0.1 * std::exp(-0.5 * std::pow((DegFromRad(at.output_rad) - 119.3) / 1.4, 2.0));
    });
    KeepFirst(record, 360);
    named += Ask(record).name() == "local_tooth_damage" ? 1 : 0;
  }
  EXPECT_GE(named, 7);
}

// Over little more than a turn a free curve over time does what both do, and comes first.
TEST(TransmissionErrorStudy, NamesADriftAndAnEccentricityThatATurnOneWayHas) {
  std::vector<double> places_deg(900);
  std::iota(places_deg.begin(), places_deg.end(), 0.0);
  const auto warmer_K = [](double time_s) { return 9.0 * std::sqrt(time_s / 720.0); };
  int named = 0;
  for (unsigned seed = 95; seed < 100; ++seed) {
    TransmissionErrorData record = SweepOver(places_deg, seed, [&](const Place& at) {
      return 0.0117 * warmer_K(at.time_s) + 0.0965 * std::cos(at.output_rad + 2.1);
    });
    KeepFirst(record, 450);
    for (std::size_t i = 0; i < record.time_s.size(); ++i)
      record.temperature_degC[i] = 25.0 + warmer_K(record.time_s[i]);
    std::vector<std::string> names;
    const Answer answer = Ask(record);
    for (const auto& cause : answer.diagnosis.causes)
      names.push_back(answer.study->causes()[cause.index].name);
    named += names == std::vector<std::string>{"output_eccentricity", "thermal_drift"} ? 1 : 0;
  }
  EXPECT_GE(named, 4);
}

TEST(TransmissionErrorStudy, SaysWhatTheStepsFoldTheFourthHarmonicOnto) {
  const Effect fourth = [](const Place& at) { return 0.05 * std::cos(4.0 * at.input_rad); };
  const Answer folded = Ask(Sweep(32, fourth));
  ASSERT_EQ(folded.name(), "wave_generator_fourth_harmonic");
  const auto& rivals = folded.diagnosis.causes.front().indistinguishable_from;
  ASSERT_EQ(rivals.size(), 1u);
  EXPECT_EQ(rivals.front(), "line at 40.00 per output turn");
  const Answer fine = Ask(Sweep(33, fourth, 0.5));
  ASSERT_EQ(fine.name(), "wave_generator_fourth_harmonic");
  EXPECT_TRUE(fine.diagnosis.causes.front().indistinguishable_from.empty());
}

TEST(TransmissionErrorStudy, LeavesAnOrderOutsideTheListWithoutAName) {
  const Answer answer = Ask(Sweep(34, [](const Place& at) { return 0.03 * std::cos(7.0 * at.output_rad); }));
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
  ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1u);
  const auto& parameters = answer.diagnosis.nuisance_terms.front().parameters;
  EXPECT_EQ(parameters.back().name, "order_per_output_turn");
  EXPECT_EQ(parameters.back().value, 7.0);  // the whole order, and not one beside it
}

// Steps that are drawn at random fold nothing: a harmonic of the input is seen however many samples a turn
// has.
TEST(TransmissionErrorStudy, SeesAHarmonicOfTheInputThatUnevenStepsDoNotFold) {
  for (const double order : {3.0, 8.0}) {
    const Answer answer =
        Ask(UnevenSweep(39, [&](const Place& at) { return 0.02 * std::cos(order * at.input_rad); }));
    EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
    ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1u);
    EXPECT_EQ(answer.diagnosis.nuisance_terms.front().parameters.back().value, 80.0 * order);
  }
}

// So it is with a line between the harmonics.
TEST(TransmissionErrorStudy, SeesALineAboveThoseOfTheInputsFirstHarmonics) {
  const Answer answer = Ask(UnevenSweep(
      40, [](const Place& at) { return 0.03 * std::cos(613.4 * at.output_rad); }, 0.3));
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
  ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1u);
  EXPECT_NEAR(answer.diagnosis.nuisance_terms.front().parameters.back().value, 613.4, 0.1);
}

TEST(TransmissionErrorStudy, LeavesARippleInOneSegmentOfTheTurnWithoutAName) {
  const Answer answer = Ask(Sweep(38, [](const Place& at) {
    const double from_centre_deg = DegFromRad(std::remainder(at.output_rad - RadFromDeg(306.0), kTwoPi));
    return 0.05 * std::exp(-0.5 * std::pow(from_centre_deg / 8.0, 2.0)) * std::cos(15.0 * at.output_rad);
  }));
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kUnnamedStructure);
  ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1u);
  const auto& parameters = answer.diagnosis.nuisance_terms.front().parameters;
  ASSERT_EQ(parameters.size(), 5u);
  EXPECT_NEAR(parameters[2].value, 306.0, 6.0) << parameters[2].name;
  EXPECT_NEAR(parameters[4].value, 15.0, 2.0) << parameters[4].name;
}

// A harmonic of the output follows a wide step better than a window whose ends are off.
TEST(TransmissionErrorStudy, LeavesAStepOverMostOfTheTurnWithoutAName) {
  for (const double from_deg : {75.0, 117.0, 230.0}) {
    const Answer answer = Ask(Sweep(39, [&](const Place& at) {
      const double at_deg = DegFromRad(at.output_rad);
      return at_deg > from_deg && at_deg < 338.0 ? 0.3 : 0.0;
    }));
    EXPECT_EQ(answer.name(), "none") << from_deg;
    ASSERT_EQ(answer.diagnosis.nuisance_terms.size(), 1u) << from_deg;
    const auto& parameters = answer.diagnosis.nuisance_terms.front().parameters;
    ASSERT_EQ(parameters.size(), 3u);
    EXPECT_NEAR(parameters[1].value, from_deg, 1.0);
    EXPECT_NEAR(parameters[2].value, 338.0, 1.0);
  }
}

TEST(TransmissionErrorStudy, SaysWhereASkewedBumpIsHighest) {
  int inside = 0;
  for (unsigned seed = 40; seed < 48; ++seed) {
    const Answer answer = Ask(Sweep(seed, [](const Place& at) {
      const double from_peak_deg = DegFromRad(at.output_rad) - 212.0;
      return 0.2 * std::exp(-0.5 * std::pow(from_peak_deg / (from_peak_deg < 0.0 ? 1.2 : 2.8), 2.0));
    }));
    ASSERT_EQ(answer.name(), "local_tooth_damage");
    EXPECT_GT(answer.value("skew_share"), 0.1);
    for (const ParameterValue& value : answer.diagnosis.causes.front().parameters) {
      if (value.name != "centre_deg") continue;
      EXPECT_LT(value.standard_error, 0.6);
      inside += std::abs(value.value - 212.0) < 1.96 * value.standard_error ? 1 : 0;
    }
  }
  EXPECT_GE(inside, 7);
}

// A ripple with a third of a period in its window is as skewed.
TEST(TransmissionErrorStudy, NamesADamageHoweverPlainItsSkewIs) {
  const Answer answer = Ask(Sweep(46, [](const Place& at) {
    const double from_peak_deg = DegFromRad(at.output_rad) - 192.8;
    return 2.4 * std::exp(-0.5 * std::pow(from_peak_deg / (from_peak_deg < 0.0 ? 2.2 : 2.9), 2.0));
  }));
  EXPECT_EQ(answer.name(), "local_tooth_damage");
  EXPECT_NEAR(answer.value("height_arcmin"), 2.4, 0.05);
}

TEST(TransmissionErrorStudy, TakesAWrongNumberForNoMissingEffect) {
  // Twice the second harmonic and another offset than any catalogue has: parameters of the nominal model.
  const Answer answer =
      Ask(Sweep(35, [](const Place& at) { return 4.0 + 0.8 * std::cos(2.0 * at.input_rad - 0.8); }));
  EXPECT_EQ(answer.diagnosis.verdict, Verdict::kNoEffect);
  EXPECT_NEAR(answer.diagnosis.nominal_heldout_rmse, RadFromArcmin(kNoise_arcmin), RadFromArcmin(0.002));
  EXPECT_NEAR(answer.diagnosis.noise_floor, RadFromArcmin(kNoise_arcmin), RadFromArcmin(0.003));
}

// As many periods a turn as steps over the measured angle are the error itself, where the steps pass for
// uneven.
TEST(TransmissionErrorStudy, TakesALargeErrorForNoFunctionOfItself) {
  int found = 0;
  for (unsigned seed = 50; seed < 62; ++seed) {
    TransmissionErrorData record =
        Sweep(seed, [](const Place& at) { return 1.5 * std::cos(2.0 * at.input_rad - 0.8); });
    std::mt19937 random(seed + 100);
    std::normal_distribution<double> noise(0.0, RadFromArcmin(0.15));
    for (double& angle_rad : record.output_angle_rad) angle_rad += noise(random);
    found += Ask(record).diagnosis.verdict == Verdict::kNoEffect ? 0 : 1;
  }
  EXPECT_EQ(found, 0);
}

TEST(TransmissionErrorStudy, JoinsRecordsWithAnOffsetEach) {
  const Effect eccentric = [](const Place& at) { return 0.01 * std::cos(at.output_rad + 2.0); };
  std::vector<TransmissionErrorData> records{Sweep(36, eccentric), Sweep(37, eccentric)};
  const auto study = MakeTransmissionErrorStudy(records);
  EXPECT_EQ(study->measured().size(), 1440u);
  const Diagnosis diagnosis = Diagnose(*study);
  ASSERT_EQ(diagnosis.causes.size(), 1u);
  EXPECT_EQ(study->causes()[diagnosis.causes.front().index].name, "output_eccentricity");
  EXPECT_EQ(diagnosis.nominal.nominal[1].name, "offset_2_arcmin");
}

TEST(TransmissionErrorStudy, SaysWhyARecordCannotBeJudged) {
  TransmissionErrorData record = Sweep(38, [](const Place&) { return 0.0; });
  const auto make = [&] { MakeTransmissionErrorStudy({&record, 1}); };
  const auto cut = [&](std::size_t samples) {
    for (auto* column : {&record.input_angle_rad, &record.output_angle_rad, &record.time_s, &record.torque_Nm,
                         &record.temperature_degC}) {
      column->resize(samples);
    }
    record.direction.resize(samples);
  };
  cut(80);
  EXPECT_EQ(MessageOf(make), "the output turns by 79.0 deg only (expected at least 90 deg)");
  cut(40);
  EXPECT_EQ(MessageOf(make),
            "the record is too short to hold anything out: 40 samples (expected at least 60)");
  record = Sweep(38, [](const Place&) { return 0.0; });
  for (double& angle : record.output_angle_rad) angle = 1.0;
  EXPECT_EQ(MessageOf(make), "output_angle_deg is constant (expected a sweep over the output)");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_transmission_error_test
