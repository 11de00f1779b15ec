// SPDX-License-Identifier: Apache-2.0
// Effects drawn at random, and records with another response, of each kind of study.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "tests/analysis/campaign_generator.h"
#include "tests/analysis/diagnosed_loop.h"
#include "tests/analysis/led_axis.h"
#include "tests/analysis/vibration_record.h"

namespace strainwave::analysis::diagnosis::diagnosis_drawn_effects_test {
namespace {

// Two turns each way, with a torque and a temperature.
std::unique_ptr<Study> Sweep() {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 1e-5);
  TransmissionErrorData record;
  for (int i = 0; i < 720; ++i) {
    const double turn_rad = kTwoPi / 180.0 * (i < 360 ? i : 719 - i);
    record.input_angle_rad.push_back(80.0 * turn_rad);
    record.output_angle_rad.push_back(turn_rad + 1e-4 * std::cos(160.0 * turn_rad) + noise(random));
    record.direction.push_back(i < 360 ? 1 : -1);
    record.time_s.push_back(2.0 * i);
    record.torque_Nm.push_back(10.0 + std::sin(0.1 * i));
    record.temperature_degC.push_back(30.0 + 0.01 * i);
  }
  return MakeTransmissionErrorStudy({&record, 1});
}

std::unique_ptr<Study> Axis() {
  const LedAxis axis{.path = {{2.0, 1.5}, {0.5, 4.0, 1.0}},
                     .duration_s = 20.0,
                     .step_s = 0.002,
                     .each = 5,
                     .inertia_kgm2 = 0.02,
                     .viscous_Nms_per_rad = 0.05,
                     .coulomb_Nm = 0.4,
                     .torque_noise_Nm = 0.01};
  const MotionData record = RecordOf(axis, 3);
  return MakeMotionStudy({&record, 1});
}

std::unique_ptr<Study> Loop() {
  const HysteresisData record =
      GenerateLoop({}, {.has_temperature = true}, Loops(1, {{30.0, 1.0, 2.0}, {0.0, 1.0, 0.0}}), 600, 5);
  return MakeHysteresisStudy({&record, 1});
}

std::unique_ptr<Study> Accelerations() {
  const VibrationData record = Record(Turning(1500.0, 0.6, 0.3), 5, Silence, {1.0, -0.6});
  return MakeVibrationStudy({&record, 1});
}

std::unique_ptr<Study> Campaign() { return MakeCampaignStudy(CampaignDrawing(3, 60).data); }

struct Kind {
  const char* name;
  std::unique_ptr<Study> (*make)();
};

class DrawnEffects : public ::testing::TestWithParam<Kind> {};

TEST_P(DrawnEffects, GrowWithTheirAmountAndAreTheSameForTheSameDraw) {
  const auto study = GetParam().make();
  const auto samples = static_cast<Eigen::Index>(study->measured().size());
  std::vector<double> weights(study->Weights().begin(), study->Weights().end());
  if (weights.empty()) weights.assign(study->measured().size(), 1.0);
  const ModelFit fit = study->Fit({}, weights, nullptr, FitPurpose::kReport);
  int drawn = 0;
  int others = 0;  // those that have more than a size
  for (std::size_t cause = 0; cause < study->causes().size(); ++cause) {
    const CauseRule& rule = study->causes()[cause];
    if (!rule.named) continue;
    EXPECT_FALSE(rule.what_to_do.empty()) << rule.name;
    const auto effect = study->DrawEffect(cause, fit, 11);
    if (!effect) continue;
    ++drawn;
    EXPECT_FALSE(effect->amount.empty()) << rule.name;
    EXPECT_GT(effect->largest_amount, 0.0) << rule.name;
    const double amount = 1e-4 * std::min(1.0, effect->largest_amount);
    const Eigen::VectorXd once = effect->added(amount);
    ASSERT_EQ(once.size(), samples) << rule.name;
    ASSERT_TRUE(once.allFinite()) << rule.name;
    EXPECT_GT(once.norm(), 0.0) << rule.name;
    EXPECT_NEAR(effect->added(2.0 * amount).norm(), 2.0 * once.norm(), 0.02 * once.norm()) << rule.name;
    EXPECT_EQ(study->DrawEffect(cause, fit, 11)->added(amount), once) << rule.name;
    others += study->DrawEffect(cause, fit, 12)->added(amount) == once ? 0 : 1;
  }
  EXPECT_GE(drawn, 4);
  EXPECT_GE(others, 3);
}

TEST_P(DrawnEffects, GoIntoTheSameRecordsWithAnotherResponse) {
  const auto study = GetParam().make();
  std::vector<double> other(study->measured().begin(), study->measured().end());
  for (std::size_t i = 0; i < other.size(); i += 7) other[i] += 1e-7;
  const auto with = study->WithResponse(other);
  ASSERT_NE(with, nullptr);
  EXPECT_TRUE(std::ranges::equal(with->measured(), other));
  ASSERT_EQ(with->causes().size(), study->causes().size());
  for (std::size_t cause = 0; cause < with->causes().size(); ++cause)
    EXPECT_EQ(with->causes()[cause].name, study->causes()[cause].name);
  EXPECT_THROW(study->WithResponse(std::vector<double>(3)), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Kinds, DrawnEffects,
                         ::testing::Values(Kind{"transmission_error", Sweep}, Kind{"motion", Axis},
                                           Kind{"hysteresis", Loop}, Kind{"vibration", Accelerations},
                                           Kind{"campaign", Campaign}),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace strainwave::analysis::diagnosis::diagnosis_drawn_effects_test
