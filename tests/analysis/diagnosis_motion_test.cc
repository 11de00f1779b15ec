// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "analysis/diagnosis/temperature.h"
#include "analysis/units.h"
#include "tests/analysis/diagnosed.h"
#include "tests/analysis/led_axis.h"
#include "tests/analysis/message_of.h"

namespace strainwave::analysis::diagnosis::diagnosis_motion_test {
namespace {

constexpr double kInertia_kgm2 = 0.02;
constexpr double kViscous_Nms_per_rad = 0.05;
constexpr double kCoulomb_Nm = 0.6;
constexpr double kOffset_Nm = 0.1;
constexpr double kNoise_Nm = 0.08;

// A motion of four sines that share no period, and what it needs at a time.
struct State : PathState {
  double time_s{};
  double way() const { return std::tanh(speed_rad_per_s / 0.01); }
  double inertial_Nm() const { return kInertia_kgm2 * acceleration_rad_per_s2; }
};

State At(double time_s) {
  static const SinePath path{{3.0, kTwoPi * 0.131, 0.4},
                             {1.3, kTwoPi * 0.353, 2.1},
                             {0.5, kTwoPi * 0.917, 4.4},
                             {0.2, kTwoPi * 1.871, 1.2}};
  return {StateOn(path, time_s), time_s};
}

using Effect = std::function<double(const State&)>;

double Nothing(const State&) { return 0.0; }

struct Logger {
  double rate_Hz{250.0};
  double duration_s{40.0};
  double late_s{};  // by which the torque acts after it was recorded
  double jitter{};  // of the sampling, in steps
  double offset_Nm{kOffset_Nm};
  double noise_Nm{kNoise_Nm};
};

MotionData Record(unsigned seed, const Effect& effect, const Logger& logger = {}) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  MotionData record;
  const auto count = static_cast<std::size_t>(logger.duration_s * logger.rate_Hz);
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = (static_cast<double>(i) + logger.jitter * uniform(random)) / logger.rate_Hz;
    const State later = At(time_s + logger.late_s);
    record.time_s.push_back(time_s);
    record.position.push_back(At(time_s).position_rad + 3e-7 * normal(random));
    record.torque.push_back(later.inertial_Nm() + kViscous_Nms_per_rad * later.speed_rad_per_s +
                            kCoulomb_Nm * later.way() + logger.offset_Nm + effect(later) +
                            logger.noise_Nm * normal(random));
  }
  return record;
}

Diagnosed Ask(const std::vector<MotionData>& records) { return DiagnoseRecords(&MakeMotionStudy, records); }

void ExpectNear(const ParameterValue& parameter, double truth, double most_relative_error) {
  EXPECT_NEAR(parameter.value, truth, 4.0 * parameter.standard_error) << parameter.name;
  EXPECT_LT(parameter.standard_error, most_relative_error * std::abs(truth)) << parameter.name;
}

TEST(MotionStudy, FindsNothingInACleanRecordAndFitsItsNumbers) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Diagnosed clean = Ask({Record(seed, Nothing)});
    EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect) << seed;
    EXPECT_EQ(clean.names(), Names()) << seed;
    ExpectNear(clean.nominal("inertia_kgm2"), kInertia_kgm2, 0.01);
    ExpectNear(clean.nominal("viscous_Nms_per_rad"), kViscous_Nms_per_rad, 0.02);
    ExpectNear(clean.nominal("coulomb_Nm"), kCoulomb_Nm, 0.02);
    ExpectNear(clean.nominal("offset_Nm"), kOffset_Nm, 0.02);
  }
}

TEST(MotionStudy, ReportsTheErrorOfTheRecordNotOfItsLowPass) {
  const Diagnosed clean = Ask({Record(4, Nothing)});
  EXPECT_NEAR(clean.diagnosis.noise_floor, kNoise_Nm, 0.03 * kNoise_Nm);
  EXPECT_NEAR(clean.diagnosis.extended_heldout_rmse, kNoise_Nm, 0.03 * kNoise_Nm);
}

struct Hidden {
  const char* cause;
  const char* parameter;
  double truth;
  double most_relative_error;
  Effect effect;
};

void PrintTo(const Hidden& hidden, std::ostream* out) { *out << hidden.cause; }

class MotionCause : public testing::TestWithParam<Hidden> {};

TEST_P(MotionCause, IsNamedWithItsSize) {
  const Hidden& hidden = GetParam();
  const Diagnosed found = Ask({Record(5, hidden.effect)});
  EXPECT_EQ(found.names(), Names{hidden.cause});
  ExpectNear(found.value(hidden.parameter), hidden.truth, hidden.most_relative_error);
  EXPECT_NEAR(found.diagnosis.extended_heldout_rmse, kNoise_Nm, 0.05 * kNoise_Nm);
  EXPECT_GT(found.diagnosis.gain.low, 0.0);
}

INSTANTIATE_TEST_SUITE_P(
    Formulae, MotionCause,
    testing::Values(
        Hidden{"stribeck_friction", "stribeck_Nm", 0.25, 0.3,
               [](const State& s) { return 0.25 * s.way() * std::exp(-std::abs(s.speed_rad_per_s) / 0.7); }},
        Hidden{"asymmetric_friction", "viscous_difference_Nms_per_rad", 0.012, 0.3,
               [](const State& s) { return 0.006 * std::abs(s.speed_rad_per_s); }},
        Hidden{"position_periodic_torque", "order_per_turn", 36.0, 1e-3,
               [](const State& s) { return 0.02 * std::sin(36.0 * s.position_rad + 0.8); }},
        Hidden{"gravity_load", "amplitude_Nm", 0.03, 0.2,
               [](const State& s) { return 0.03 * std::cos(s.position_rad - 1.0); }},
        Hidden{"quadratic_drag", "drag_Nms2_per_rad2", 0.001, 0.3,
               [](const State& s) { return 0.001 * s.speed_rad_per_s * std::abs(s.speed_rad_per_s); }},
        Hidden{"load_dependent_friction", "load_coefficient", 0.06, 0.3,
               [](const State& s) { return 0.06 * std::abs(s.inertial_Nm()) * s.way(); }},
        Hidden{"external_disturbance", "duration_s", 0.6, 0.1,
               [](const State& s) { return std::abs(s.time_s - 17.3) < 0.3 ? 0.08 : 0.0; }}),
    [](const auto& hidden) { return std::string(hidden.param.cause); });

TEST(MotionStudy, NamesATorqueThatActsLate) {
  const Diagnosed found = Ask({Record(6, Nothing, {.late_s = 0.0015})});
  EXPECT_EQ(found.names(), Names{"time_delay"});
  ExpectNear(found.value("delay_s"), 0.0015, 0.1);
  // Noise stands in the measured torque and in what is left alike.
  EXPECT_EQ(Ask({Record(24, Nothing, {.late_s = 0.03, .noise_Nm = 0.8})}).diagnosis.residual.signature, "");
}

TEST(MotionStudy, NamesFrictionThatFallsAsTheAxisWarms) {
  const auto warm_K = [](double time_s) { return 8.0 * (1.0 - std::exp(-time_s / 15.0)); };
  MotionData record = Record(7, [&](const State& s) {
    return -0.01 * warm_K(s.time_s) * (kCoulomb_Nm * s.way() + kViscous_Nms_per_rad * s.speed_rad_per_s);
  });
  std::mt19937 random(70);
  std::normal_distribution<double> noise(0.0, 0.03);
  for (const double time_s : record.time_s)
    record.temperature_degC.push_back(24.0 + warm_K(time_s) + noise(random));
  const Diagnosed found = Ask({record});
  EXPECT_EQ(found.names(), Names{"thermal_friction_drift"});
  ExpectNear(found.value("drift_per_K"), -0.01, 0.3);
}

// A load on a spring (or behind a gap with a spring at either end), stepped finely: what it pushes back with,
// less its inertia. Semi-implicit, friction as a sign.
std::vector<double> LoadPush(const Logger& logger, double load_kgm2, double natural_Hz, double damping_ratio,
                             double gap_rad, double friction_Nm) {
  constexpr int kSubsteps = 200;
  const double step_s = 1.0 / (logger.rate_Hz * kSubsteps);
  const double omega = kTwoPi * natural_Hz;
  // As if it had swung with the motion before.
  double place = At(0.0).position_rad - At(0.0).acceleration_rad_per_s2 / (omega * omega);
  double speed = At(0.0).speed_rad_per_s;
  std::vector<double> pushes;
  const auto count = static_cast<std::size_t>(logger.duration_s * logger.rate_Hz);
  for (std::size_t i = 0; i < count * kSubsteps; ++i) {
    const State near = At(static_cast<double>(i) * step_s);
    const double lead = near.position_rad - place;
    const double bent = lead - std::clamp(lead, -0.5 * gap_rad, 0.5 * gap_rad);
    double push = bent == 0.0
                      ? 0.0
                      : omega * omega * bent + 2.0 * damping_ratio * omega * (near.speed_rad_per_s - speed);
    if (push * bent < 0.0) push = gap_rad > 0.0 ? 0.0 : push;
    if (i % kSubsteps == 0) pushes.push_back(load_kgm2 * (push - near.acceleration_rad_per_s2));
    speed += step_s * (push - friction_Nm / load_kgm2 * std::tanh(speed / 0.01));
    place += step_s * speed;
  }
  return pushes;
}

Effect Sampled(const Logger& logger, std::vector<double> values) {
  return [=](const State& s) {
    const auto i = static_cast<std::size_t>(std::lround(s.time_s * logger.rate_Hz));
    return values[std::min(i, values.size() - 1)];
  };
}

TEST(MotionStudy, NamesFrictionThatSettlesWithoutATemperature) {
  const auto warm = [](double time_s) { return 1.0 - std::exp(-time_s / 8.0); };
  const Diagnosed found = Ask({Record(24, [&](const State& s) {
    return -0.08 * warm(s.time_s) * (kCoulomb_Nm * s.way() + kViscous_Nms_per_rad * s.speed_rad_per_s);
  })});
  ASSERT_EQ(found.names(), Names{"thermal_friction_drift"});
  ExpectNear(found.value("time_constant_s"), 8.0, 0.5);
}

TEST(SlowTemperature, KeepsADriftAndLosesTheNoise) {
  std::vector<double> sensor;
  std::mt19937 random(25);
  std::normal_distribution<double> normal(0.0, 0.03);
  for (int i = 0; i < 2000; ++i) sensor.push_back(20.0 + 1e-4 * i + normal(random));
  const std::vector<double> slow = SlowTemperature(sensor);
  ASSERT_EQ(slow.size(), sensor.size());
  for (std::size_t i = 20; i + 20 < slow.size(); ++i)
    EXPECT_NEAR(slow[i], 20.0 + 1e-4 * static_cast<double>(i), 4.5 * 0.03 / std::sqrt(41.0));
}

TEST(MotionStudy, NamesASecondInertiaThatSwings) {
  const Logger logger;
  const Diagnosed found = Ask({Record(8, Sampled(logger, LoadPush(logger, 0.006, 4.0, 0.04, 0.0, 0.0)))});
  EXPECT_EQ(found.names(), Names{"torsional_resonance"});
  ExpectNear(found.value("frequency_Hz"), 4.0, 0.05);
  ExpectNear(found.value("second_inertia_kgm2"), 0.006, 0.2);
}

TEST(MotionStudy, NamesALoadThatComesLooseInAGap) {
  const Logger logger;
  const Diagnosed found = Ask({Record(9, Sampled(logger, LoadPush(logger, 0.004, 30.0, 0.4, 0.012, 0.02)))});
  EXPECT_EQ(found.names(), Names{"backlash"});
  EXPECT_NEAR(found.value("backlash_rad").value, 0.012, 0.004);
}

TEST(MotionStudy, CallsAToneOfNoCauseUnnamedWithItsFrequency) {
  const Diagnosed found =
      Ask({Record(10, [](const State& s) { return 0.02 * std::sin(kTwoPi * 11.3 * s.time_s); })});
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kUnnamedStructure);
  ASSERT_EQ(found.diagnosis.nuisance_terms.size(), 1U);
  const auto& parameters = found.diagnosis.nuisance_terms.front().parameters;
  const auto frequency = std::find_if(parameters.begin(), parameters.end(), [](const ParameterValue& value) {
    return value.name == "frequency_Hz";
  });
  ASSERT_NE(frequency, parameters.end());
  EXPECT_NEAR(frequency->value, 11.3, 0.01);
}

// The fastest tenth of the speeds comes a few times in the record: blocks that are held out have it alone.
TEST(MotionStudy, CallsAWavyFrictionUnnamedAndSaysThatItFollowsSpeed) {
  const Effect wavy = [](const State& s) { return 0.045 * std::sin(kTwoPi * s.speed_rad_per_s / 3.6); };
  for (const unsigned seed : {41U, 42U}) {
    const Diagnosed found = Ask({Record(seed, wavy, {.duration_s = 20.0})});
    EXPECT_EQ(found.diagnosis.verdict, Verdict::kUnnamedStructure) << seed;
    EXPECT_EQ(found.names(), Names()) << seed;
    EXPECT_NE(found.diagnosis.residual.described.find("depends on velocity"), std::string::npos)
        << found.diagnosis.residual.described;
  }
}

TEST(MotionStudy, DoesNotTakeJitterForAnEffect) {
  const Diagnosed clean = Ask({Record(11, Nothing, {.jitter = 0.3})});
  EXPECT_EQ(clean.diagnosis.verdict, Verdict::kNoEffect);
  ASSERT_EQ(clean.study->warnings().size(), 1U);
  EXPECT_EQ(clean.study->warnings().front(),
            "time stamps jitter by 13 % of their step of 4.003 ms: brought onto even steps");
}

TEST(MotionStudy, LeavesOutSpikesBeforeTheyAreSpread) {
  MotionData record = Record(18, Nothing);
  std::mt19937 random(180);
  std::uniform_int_distribution<std::size_t> where(5, record.torque.size() - 6);
  for (int spike = 0; spike < 40; ++spike) record.torque[where(random)] += spike % 2 == 0 ? 1.2 : -1.2;
  const Diagnosed found = Ask({record});
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect);
  // Nothing of them is left: 40 spikes of 15 standard deviations would make it half as large again.
  EXPECT_NEAR(found.diagnosis.nominal_heldout_rmse, kNoise_Nm, 0.03 * kNoise_Nm);
}

// What the warning says.
std::size_t LeftOut(const Diagnosed& diagnosed) {
  for (const std::string& warning : diagnosed.study->warnings()) {
    if (warning.ends_with("samples of the torque stand off their neighbours and were left out"))
      return std::stoul(warning);
  }
  return 0;
}

// From sample to sample this torque changes by ten times what the spikes are high.
TEST(MotionStudy, LeavesOutSpikesOfATorqueThatChangesFasterThanThey) {
  constexpr double kQuiet_Nm = 0.01;
  constexpr std::size_t kApart = 37;
  MotionData record = Record(24, Nothing, {.rate_Hz = 25.0, .duration_s = 80.0, .noise_Nm = kQuiet_Nm});
  const Diagnosed clean = Ask({record});
  std::size_t spikes = 0;
  for (std::size_t i = 20; i + 5 < record.torque.size(); i += kApart) {
    const auto speed = [&](std::size_t k) { return At(record.time_s[k]).speed_rad_per_s; };
    if (speed(i - 3) * speed(i + 3) < 0.0) continue;  // nobody knows the friction there
    record.torque[i] += ++spikes % 2 == 0 ? 0.15 : -0.15;
  }
  const Diagnosed found = Ask({record});
  EXPECT_EQ(found.diagnosis.verdict, Verdict::kNoEffect);
  // The record without spikes loses a few samples, too.
  EXPECT_GE(LeftOut(found), spikes);
  EXPECT_LE(LeftOut(found), spikes + LeftOut(clean));
  EXPECT_NEAR(found.diagnosis.nominal_heldout_rmse, clean.diagnosis.nominal_heldout_rmse, 0.02 * kQuiet_Nm);
}

// So quiet a torque shows noise of the acceleration that is a thousandth of the acceleration.
TEST(MotionStudy, DoesNotTakeTheAccelerationsNoiseForASwing) {
  for (const unsigned seed : {19U, 22U, 23U}) {
    EXPECT_EQ(
        Ask({Record(seed, Nothing, {.rate_Hz = 1000.0, .duration_s = 20.0, .noise_Nm = 0.0025})}).names(),
        Names())
        << seed;
  }
}

TEST(MotionStudy, FindsTheEndsOfASoftPush) {
  // Rises and falls as a cosine over 0.6 s each.
  const auto push = [](const State& s) {
    const double edge = std::clamp(std::min(s.time_s - 12.0, 14.0 - s.time_s) / 0.6, 0.0, 1.0);
    return 0.1 * 0.5 * (1.0 - std::cos(kTwoPi / 2.0 * edge));
  };
  const Diagnosed found = Ask({Record(20, push)});
  ASSERT_EQ(found.names(), Names{"external_disturbance"});
  ExpectNear(found.value("start_s"), 12.0, 0.02);
  ExpectNear(found.value("end_s"), 14.0, 0.02);
  ExpectNear(found.value("torque_Nm"), 0.1, 0.2);
}

TEST(MotionStudy, TellsWeakFrictionOfLowSpeedFromDrag) {
  const auto weak = [](const State& s) {
    return 0.03 * s.way() * std::exp(-std::pow(s.speed_rad_per_s / 0.8, 2));
  };
  for (const unsigned seed : {26U, 27U, 28U}) {
    EXPECT_EQ(Ask({Record(seed, weak)}).names(), Names{"stribeck_friction"}) << seed;
  }
}

TEST(MotionStudy, FindsSeveralPushesBesideFrictionOfLowSpeed) {
  const auto both = [](const State& s) {
    const auto push = [&](double start_s) {
      return s.time_s > start_s && s.time_s < start_s + 0.7 ? 0.1 : 0.0;
    };
    return 0.3 * s.way() * std::exp(-std::abs(s.speed_rad_per_s) / 0.7) + push(8.0) - push(19.5) + push(31.0);
  };
  const Diagnosed found = Ask({Record(29, both)});
  EXPECT_EQ(found.names(), (Names{"stribeck_friction", "external_disturbance"}));
  ASSERT_EQ(found.diagnosis.causes.size(), 2U);
  const auto& parameters = found.diagnosis.causes.back().parameters;
  const auto third = std::ranges::find(parameters, "duration_3_s", &ParameterValue::name);
  ASSERT_NE(third, parameters.end());
  EXPECT_NEAR(third->value, 0.7, 4.0 * third->standard_error);
}

TEST(MotionStudy, JoinsRecordsEachWithItsOwnOffset) {
  const Effect weak = [](const State& s) { return 0.0075 * std::cos(s.position_rad - 1.0); };
  const Logger one{.duration_s = 20.0};
  const Logger other{.duration_s = 20.0, .offset_Nm = -0.4};
  const std::vector<MotionData> records{Record(16, weak, one), Record(17, weak, other)};
  EXPECT_EQ(Ask({records[0]}).names(), Names());
  const Diagnosed joint = Ask(records);
  EXPECT_EQ(joint.names(), Names{"gravity_load"});
  ExpectNear(joint.nominal("offset_Nm"), kOffset_Nm, 0.05);
  ExpectNear(joint.nominal("offset_2_Nm"), -0.4, 0.05);
}

TEST(MotionStudy, SaysWhatARecordDoesNotShow) {
  MotionData record = Record(14, Nothing);
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    const double turned_rad = 20.0 * record.time_s[i];
    record.torque[i] += kViscous_Nms_per_rad * (20.0 - At(record.time_s[i]).speed_rad_per_s) +
                        kCoulomb_Nm * (1.0 - At(record.time_s[i]).way()) - At(record.time_s[i]).inertial_Nm();
    record.position[i] = turned_rad;
  }
  const Diagnosed steady = Ask({record});
  EXPECT_EQ(steady.names(), Names());
  const std::vector<std::string>& said = steady.study->warnings();
  const auto says = [&](const std::string& text) {
    return std::find(said.begin(), said.end(), text) != said.end();
  };
  EXPECT_TRUE(says("no verdict on asymmetric_friction: the axis moves in one direction only (expected both)"))
      << testing::PrintToString(said);
}

TEST(MotionStudy, SaysWhatIsWrongWithARecord) {
  const auto message = [](const MotionData& record) { return RefusalOf(&MakeMotionStudy, record); };
  const MotionData good = Record(15, Nothing);
  MotionData record = good;
  record.time_s.resize(149), record.position.resize(149), record.torque.resize(149);
  EXPECT_EQ(message(record), "149 samples are too few to hold any out (expected at least 150)");
  record = good;
  std::fill(record.position.begin(), record.position.end(), 0.7);
  EXPECT_EQ(message(record), "the position stays within 0 rad (expected an axis that moves)");
  record = good;
  std::fill(record.torque.begin(), record.torque.end(), 0.25);
  EXPECT_EQ(message(record), "the torque is 0.25 Nm throughout (expected one that changes)");
  record = good;
  for (double& torque : record.torque) torque = std::clamp(torque, -0.2, 0.2);
  EXPECT_EQ(message(record).substr(0, 2), "85");
}

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_motion_test
