// SPDX-License-Identifier: Apache-2.0
// What loggers and encoders do to samples, through every command: records that this file writes with formulae
// of its own, as they are and spoiled.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "tests/simulation/program.h"

namespace strainwave::looked_at_records_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::string Cell(double value, int decimals) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

double InOneTurn(double angle_deg) { return angle_deg - 360.0 * std::floor(angle_deg / 360.0); }

using Change = std::function<double(double value, int row)>;
double AsItIs(double value, int /*row*/) { return value; }

// A turn each way in steps of 2 deg; e_avg is 0 about the first sample's zero, e_max 1.4', lost motion
// -0.24'.
std::string Sweep(const std::string& ratio, const Change& output = AsItIs) {
  std::mt19937 random(21);
  std::normal_distribution<double> noise(0.0, 0.003);
  std::string text =
      "# kind: transmission_error\n# ratio: " + ratio + "\ndirection,input_angle_deg,output_angle_deg\n";
  int row = 0;
  for (const int way : {1, -1}) {
    for (int k = 0; k <= 180; ++k, ++row) {
      const double at_deg = way > 0 ? 2.0 * k : 360.0 - 2.0 * k;
      const double error_arcmin = 0.7 * std::sin(at_deg * kPi / 180.0) - 0.12 * way + noise(random);
      text += std::string(way > 0 ? "cw," : "ccw,") + Cell(100.0 * at_deg, 4) + "," +
              Cell(output(at_deg + 10.0 - error_arcmin / 60.0, row), 7) + "\n";
    }
  }
  return text;
}

struct AxisState {
  double way_rad{};
  double torque_Nm{};
};

// An axis of 0.11 kg m², 0.5 Nms/rad, 1.6 Nm, led along sines; nothing hidden.
AxisState AxisAt(double time_s) {
  double way = 0.0;
  double speed = 0.0;
  double acceleration = 0.0;
  for (const auto& [size, pulse, phase] :
       {std::tuple{2.1, 1.3, 0.0}, std::tuple{0.5, 4.9, 1.0}, std::tuple{0.12, 11.3, 2.0}}) {
    way += size * std::sin(pulse * time_s + phase);
    speed += size * pulse * std::cos(pulse * time_s + phase);
    acceleration -= size * pulse * pulse * std::sin(pulse * time_s + phase);
  }
  return {way, 0.11 * acceleration + 0.5 * speed + std::copysign(1.6, speed)};
}

// A channel that comes at a rate of its own and is written in every row.
struct Came {
  double rate_hz;
  double noise;
  unsigned seed;

  double At(double time_s, double AxisState::*channel) const {
    const double number = std::floor(time_s * rate_hz + 1e-6);
    std::mt19937 random(seed + 7919U * static_cast<unsigned>(number));
    return AxisAt(number / rate_hz).*channel + std::normal_distribution(0.0, noise)(random);
  }
};

std::string Axis(double rate_hz, double seconds, double position_hz = 0.0, double torque_hz = 0.0,
                 const Change& position = AsItIs, const Change& torque = AsItIs) {
  const Came way{position_hz > 0.0 ? position_hz : rate_hz, 2e-5, 22};
  const Came drive{torque_hz > 0.0 ? torque_hz : rate_hz, 0.04, 23};
  std::string text = "# kind: motion\ntime_s,position_rad,torque_Nm\n";
  for (int i = 0; i < static_cast<int>(seconds * rate_hz); ++i) {
    const double t = i / rate_hz;
    text += Cell(t, 5) + "," + Cell(position(way.At(t, &AxisState::way_rad), i), 6) + "," +
            Cell(torque(drive.At(t, &AxisState::torque_Nm), i), 4) + "\n";
  }
  return text;
}

// Stands for so many rows at a time, given by their number.
Change HeldFor(const std::function<int(int)>& rows) {
  return [rows, last = 0.0, until = 0](double value, int row) mutable {
    if (row >= until) {
      last = value;
      until = row + rows(row);
    }
    return last;
  };
}

std::string Vibration(const std::function<double(int)>& time_s, const std::string& metadata,
                      double seed = 1.0) {
  std::mt19937 random(static_cast<unsigned>(30 + seed));
  std::normal_distribution<double> noise(0.0, 0.1);
  std::string text =
      "# kind: vibration\n# input_speed_rpm: 1500\n# class: " + std::string(seed >= 10.0 ? "worn" : "good") +
      "\n" + metadata + "time_s,accel_x_m_per_s2\n";
  for (int i = 0; i < 4096; ++i) {
    text += Cell(time_s(i), 6) + "," +
            Cell(std::sin(2.0 * kPi * 50.0 * i / 10240.0 + seed) * (seed >= 10.0 ? 2.0 : 1.0) + noise(random),
                 5) +
            "\n";
  }
  return text;
}

class LookedAt : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  static nlohmann::json Json(const std::vector<std::string>& arguments) {
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  static std::string Refusal(const std::vector<std::string>& arguments) {
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.out;
    return result.error;
  }

  // No effect, the numbers of the axis, and one warning that begins so.
  void ExpectTheAxis(const std::string& record, const std::string& warning) const {
    const auto json = Json({"diagnose", record, "--json"});
    EXPECT_EQ(json["verdict"], "no_effect") << json["causes"].dump(1);
    const auto& nominal = json["nominal"]["parameters"];
    EXPECT_NEAR(nominal["inertia_kgm2"]["value"].get<double>(), 0.11, 0.03 * 0.11) << record;
    EXPECT_NEAR(nominal["coulomb_Nm"]["value"].get<double>(), 1.6, 0.03 * 1.6) << record;
    ASSERT_GE(json["warnings"].size(), 1U);
    EXPECT_TRUE(json["warnings"][0].get<std::string>().starts_with(warning)) << json["warnings"].dump(1);
  }

  ScratchFolder folder_;
};

TEST_F(LookedAt, AnAngleOfOneTurnGoesOnInRecomputeAndDiagnose) {
  const auto truth = Json({"recompute", Write("plain.csv", Sweep("100")), "--json"});
  EXPECT_EQ(truth["warnings"], nlohmann::json::array());
  const std::string record =
      Write("wrapped.csv", Sweep("100", [](double deg, int) { return InOneTurn(deg); }));
  const ProgramResult result = RunProgram({"recompute", record, "--json"});
  EXPECT_EQ(result.exit_code, 0);
  const std::string warning =
      "output_angle_deg starts anew every 360 deg, 2 times in the record, first at row 176: taken as going "
      "on";
  EXPECT_EQ(result.error, record + ":179: warning: " + warning + "\n");
  const auto json = nlohmann::json::parse(result.out);
  EXPECT_EQ(json["warnings"], nlohmann::json::array({warning}));
  for (const char* key : {"e_avg_arcmin", "e_max_arcmin", "lost_motion_arcmin"})
    EXPECT_NEAR(json[key].get<double>(), truth[key].get<double>(), 1e-6) << key;
  EXPECT_NEAR(json["e_max_arcmin"].get<double>(), 1.4, 0.02);
  EXPECT_EQ(Json({"diagnose", record, "--json"})["warnings"][0], warning);
}

TEST_F(LookedAt, AWrongRatioIsRefusedByRecomputeAsByDiagnose) {
  for (const auto& [said, seen] :
       {std::pair{"100.6", "100"}, std::pair{"-100", "100"}, std::pair{"160", "100"}}) {
    const std::string record = Write("sweep.csv", Sweep(said));
    const std::string expected = record + ": error: ratio looks like " + seen + ", file says " + said +
                                 " (expected ratio = input angle / output angle, signed)\n";
    EXPECT_EQ(Refusal({"recompute", record, "--json"}), expected);
    EXPECT_EQ(Refusal({"diagnose", record, "--json"}), expected);
  }
}

TEST_F(LookedAt, AHeldChannelGivesNoCause) {
  ExpectTheAxis(Write("position_3.csv", Axis(300.0, 12.0, 100.0)),
                "position_rad repeats its value until the next one comes, in 2400 of 3600 rows");
  ExpectTheAxis(Write("torque_2.csv", Axis(250.0, 12.0, 0.0, 125.0)),
                "torque_Nm repeats its value until the next one comes, in 1500 of 3000 rows");
  std::mt19937 random(4);
  ExpectTheAxis(Write("now_and_then.csv", Axis(250.0, 12.0, 0.0, 0.0, AsItIs,
                                               HeldFor([&](int) { return random() % 12 == 0 ? 2 : 1; }))),
                "torque_Nm repeats its value until the next one comes");
}

TEST_F(LookedAt, ASensorThatStoodStillGivesNoCause) {
  ExpectTheAxis(
      Write("frozen.csv", Axis(250.0, 12.0, 0.0, 0.0, AsItIs, HeldFor([](int row) {
                                 return row == 1000 ? 90 : row == 2200 ? 30 : 1;
                               }))),
      "90 samples of torque_Nm repeat one value, rows 1001 to 1090, 4.00 to 4.36 s: a sensor or logger that "
      "stood still; they are left out");
}

TEST_F(LookedAt, AnAxisThatTurnsOverItsZeroGivesNoCause) {
  ExpectTheAxis(Write("wrapped.csv", Axis(250.0, 12.0, 0.0, 0.0,
                                          [](double rad, int) {
                                            return rad -
                                                   2.0 * kPi * std::floor((rad + kPi + 2.0) / (2.0 * kPi));
                                          })),
                "position_rad starts anew every 6.28319 rad, ");
}

TEST_F(LookedAt, RoundedStampsAreTheSameToAllCommands) {
  const auto even = [](int i) { return i / 10240.0; };
  const auto rounded = [](int i) { return 1e-4 * std::round(i / 10240.0 / 1e-4); };
  const auto plain = Json({"features", "--set", "orders", "--json", Write("plain.csv", Vibration(even, ""))});
  EXPECT_FALSE(plain.contains("warnings"));
  const std::string warning =
      "2.3 % of the time stamps repeat the one before: all within a tick of even steps, which "
      "take their place";
  for (const char* rate : {"", "# sample_rate_hz: 10240\n"}) {
    const std::string record = Write("rounded.csv", Vibration(rounded, rate));
    const auto features = Json({"features", "--set", "orders", "--json", record});
    EXPECT_EQ(features["warnings"], nlohmann::json::array({warning}));
    for (std::size_t i = 0; i < plain["values"].size(); ++i) {
      ASSERT_EQ(features["values"][i].is_null(), plain["values"][i].is_null()) << plain["names"][i];
      if (plain["values"][i].is_null()) continue;
      EXPECT_NEAR(features["values"][i].get<double>(), plain["values"][i].get<double>(),
                  1e-3 * std::abs(plain["values"][i].get<double>()));
    }
    EXPECT_EQ(Json({"diagnose", record, "--json"})["warnings"][0], warning);
  }
}

TEST_F(LookedAt, ARateThatContradictsTheTimeIsRefusedByAllCommands) {
  const auto even = [](int i) { return i / 10240.0; };
  std::filesystem::create_directory(folder_ / "records");
  for (int i = 0; i < 20; ++i)
    Write("records/" + std::to_string(i) + ".csv", Vibration(even, "", i < 10 ? i : 10.0 + i));
  const std::string predictor = (folder_ / "predictor").string();
  Json({"train", (folder_ / "records").string(), "--out", predictor, "--json", "--epochs", "2", "--members",
        "2", "--levels", "3"});
  const std::string record = Write("records/contradicted.csv", Vibration(even, "# sample_rate_hz: 25600\n"));
  const std::string expected =
      record +
      ": error: sample_rate_hz is 25600, but time_s goes on by 10240 samples a second "
      "(expected one rate)\n";
  EXPECT_EQ(Refusal({"features", record, "--json"}), expected);
  EXPECT_EQ(Refusal({"diagnose", record, "--json"}), expected);
  EXPECT_EQ(Refusal({"predict", predictor, record, "--json"}), expected);
  EXPECT_EQ(Refusal({"train", (folder_ / "records").string(), "--out", predictor + "2", "--json"}), expected);
}

// A loop of 1.3e4, 2.1e4, 2.9e4 Nm/rad with friction that yields, stepped; nothing hidden.
std::string Loop(double step_deg, double noise_deg) {
  std::mt19937 random(23);
  std::normal_distribution<double> normal;
  std::string text =
      "# kind: hysteresis\n# t1_Nm: 7\n# t2_Nm: 25\n# t3_Nm: 34\ntime_s,torque_Nm,output_angle_deg\n";
  double twist_rad = 0.0;
  double friction_Nm = 0.0;
  double torque_Nm = 0.0;
  constexpr int kParts = 400;
  constexpr int kRows = 2000;
  const double knee1_rad = 7.0 / 1.3e4;
  const double knee2_rad = knee1_rad + 18.0 / 2.1e4;
  for (int i = 0; i < kRows; ++i) {
    double angle_deg = 0.4 + twist_rad * 180.0 / kPi + noise_deg * normal(random);
    if (step_deg > 0.0) angle_deg = step_deg * std::round(angle_deg / step_deg);
    text += Cell(0.02 * i, 2) + "," + Cell(torque_Nm + 0.01 * normal(random), 4) + "," + Cell(angle_deg, 8) +
            "\n";
    for (int k = 0; k < kParts; ++k) {
      const double phase = 5.0 * (i + static_cast<double>(k + 1) / kParts) / kRows;  // quarters
      const double wanted_Nm = 34.0 * (phase < 1.0 ? phase : phase < 3.0 ? 2.0 - phase : phase - 4.0);
      const double size = std::abs(twist_rad);
      const double spring = size < knee1_rad ? 1.3e4 : size < knee2_rad ? 2.1e4 : 2.9e4;
      const double change_Nm = wanted_Nm - torque_Nm;
      const bool sticks = std::abs(friction_Nm) < 1.0 || friction_Nm * change_Nm < 0.0;
      const double change_rad = change_Nm / (spring + (sticks ? 1.2e4 : 0.0));
      friction_Nm = std::clamp(friction_Nm + (sticks ? 1.2e4 * change_rad : 0.0), -1.0, 1.0);
      twist_rad += change_rad;
      torque_Nm = wanted_Nm;
    }
  }
  return text;
}

TEST_F(LookedAt, TheStepsOfAQuietEncoderAreNoStructure) {
  EXPECT_EQ(Json({"diagnose", Write("noise.csv", Loop(0.0, 5e-4)), "--json"})["verdict"], "no_effect");
  for (const int bits : {17, 18, 19, 20}) {
    const double step_deg = 360.0 / std::pow(2.0, bits);
    const auto json = Json({"diagnose", Write("steps.csv", Loop(step_deg, 0.05 * step_deg)), "--json"});
    EXPECT_EQ(json["verdict"], "no_effect") << bits << json["unexplained"].dump(1);
    EXPECT_NEAR(json["extended"]["parameters"]["k2_Nm_per_rad"]["value"].get<double>(), 2.1e4, 0.01 * 2.1e4)
        << bits;
  }
}

}  // namespace
}  // namespace strainwave::looked_at_records_test
