// SPDX-License-Identifier: Apache-2.0
// `diagnose` and `simulate` as a user runs them, on records that this file writes with formulae of its own.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <functional>
#include <random>

#include "tests/checkout.h"
#include "tests/simulation/program.h"

namespace strainwave::diagnose_command_test {
namespace {

constexpr double kDeg = 3.14159265358979323846 / 180.0;
constexpr double kNoise_arcmin = 0.03;

struct SweepRow {
  int way{};            // +1 cw, -1 ccw
  double output_deg{};  // without error
};

/// A turn each way in steps of 1 deg: second harmonic, noise, and what `effect_arcmin` adds.
std::string Sweep(unsigned seed, const std::function<double(const SweepRow&)>& effect_arcmin) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise_arcmin);
  std::string text =
      "# kind: transmission_error\n# ratio: 80\ntime_s,direction,input_angle_deg,output_angle_deg\n";
  char line[160];
  int row = 0;
  for (const int way : {1, -1}) {
    for (int k = 0; k <= 360; ++k, ++row) {
      const double output_deg = way > 0 ? k : 360 - k;
      const double error_arcmin = 0.3 + 0.4 * std::cos(2.0 * 80.0 * output_deg * kDeg - 0.5) +
                                  effect_arcmin({way, output_deg}) + noise(random);
      std::snprintf(line, sizeof line, "%.2f,%s,%.6f,%.9f\n", 0.5 * row, way > 0 ? "cw" : "ccw",
                    80.0 * output_deg, output_deg - error_arcmin / 60.0);
      text += line;
    }
  }
  return text;
}

double FirstHarmonic(const SweepRow& row) { return 0.25 * std::cos(80.0 * row.output_deg * kDeg - 1.0); }
double Nothing(const SweepRow&) { return 0.0; }

class Diagnose : public testing::Test {
 protected:
  std::string Write(const std::string& name, const std::string& text) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  static nlohmann::json Json(const std::vector<std::string>& arguments) {
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.error;
    return nlohmann::json::parse(result.out, nullptr, false);
  }

  // Wrong input: words on standard error, nothing on standard output, nothing written.
  void ExpectRefusal(const std::vector<std::string>& arguments, const std::string& message) const {
    const ProgramResult result = RunProgram(arguments);
    EXPECT_EQ(result.exit_code, 2) << result.error;
    EXPECT_EQ(result.error, message);
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(Path("out")));
  }

  ScratchFolder folder_;
};

TEST_F(Diagnose, NamesTheFirstHarmonicThatTheSweepHides) {
  const std::string record = Write("sweep.csv", Sweep(11, FirstHarmonic));
  const auto json = Json({"diagnose", record, "--json", "--out", Path("out")});
  EXPECT_EQ(json["verdict"], "effect_found");
  ASSERT_EQ(json["causes"].size(), 1u) << json["causes"].dump(1);
  const auto& cause = json["causes"][0];
  EXPECT_EQ(cause["name"], "wave_generator_first_harmonic");
  const auto& amplitude = cause["parameters"]["amplitude_arcmin"];
  // Truth within four standard errors: one such test in ten thousand fails by chance.
  EXPECT_NEAR(amplitude["value"].get<double>(), 0.25, 4.0 * amplitude["se"].get<double>());
  EXPECT_LT(amplitude["se"].get<double>(), 0.01);
  EXPECT_NEAR(json["extended"]["heldout_rmse"].get<double>(), kNoise_arcmin, 0.1 * kNoise_arcmin);
  EXPECT_GT(json["gain"]["ci95"][0].get<double>(), 0.5);
  EXPECT_EQ(nlohmann::json::parse(WholeFile(Path("out/diagnosis.json"))), json);
  for (const char* picture :
       {"measured_over_simulated", "residual", "residual_over_output_angle", "residual_over_input_angle",
        "residual_over_direction", "residual_over_time", "order_spectrum", "candidates"}) {
    for (const char* ending : {".svg", ".png"}) {
      EXPECT_TRUE(std::filesystem::exists(Path("out/") + picture + ending)) << picture << ending;
    }
  }
}

TEST_F(Diagnose, SaysItInOneSentenceFirst) {
  const std::string record = Write("sweep.csv", Sweep(11, FirstHarmonic));
  const ProgramResult result = RunProgram({"diagnose", record});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("What the simulation lacks: an error once per turn of the input ("))
      << result.out;
  EXPECT_NE(result.out.find("\nOne effect is missing in the simulation: wave_generator_first_harmonic"),
            std::string::npos)
      << result.out;
  EXPECT_EQ(result.error, "");
}

TEST_F(Diagnose, FindsNothingInACleanSweep) {
  const std::string record = Write("sweep.csv", Sweep(12, Nothing));
  const auto json = Json({"diagnose", record, "--json"});
  EXPECT_EQ(json["verdict"], "no_effect");
  EXPECT_TRUE(json["causes"].empty());
  EXPECT_EQ(json["gain"]["heldout_rmse_reduction"], 0.0);
}

TEST_F(Diagnose, GivesTheSameBytesTwice) {
  const std::string record = Write("sweep.csv", Sweep(11, FirstHarmonic));
  const std::vector<std::string> arguments{"diagnose", record, "--json", "--seed", "5"};
  EXPECT_EQ(RunProgram(arguments).out, RunProgram(arguments).out);
}

TEST_F(Diagnose, GoesOnFromAModelWhoseCausesAreKnown) {
  const std::string record = Write("sweep.csv", Sweep(11, FirstHarmonic));
  ASSERT_EQ(RunProgram({"diagnose", record, "--out", Path("out")}).exit_code, 0);
  const std::string again = Write("again.csv", Sweep(13, FirstHarmonic));
  const auto json = Json({"diagnose", again, "--model", Path("out/extended_model.yaml"), "--json"});
  EXPECT_EQ(json["verdict"], "no_effect");
  EXPECT_EQ(json["nominal"]["causes"][0]["name"], "wave_generator_first_harmonic");
  const std::string loop = Write("loop.csv", "# kind: vibration\n# sample_rate_hz: 10\nmic_Pa\n1\n");
  const ProgramResult other = RunProgram({"diagnose", loop, "--model", Path("out/extended_model.yaml")});
  EXPECT_EQ(other.exit_code, 2);
}

TEST_F(Diagnose, RefusesAModelOfAnotherKind) {
  const std::string record = Write("sweep.csv", Sweep(12, Nothing));
  const std::string model =
      Write("model.yaml", "plant: 1\nterms: []\ndiagnosis:\n  kind: hysteresis\n  nominal: []\n");
  ExpectRefusal({"diagnose", record, "--model", model, "--out", Path("out")},
                model +
                    ": error: the model is of kind hysteresis, the records of kind transmission_error "
                    "(expected one kind)\n");
}

/// A sweep of which one cell a row is changed.
std::string Changed(const std::function<void(std::vector<std::string>&, int row)>& change) {
  std::istringstream lines(Sweep(12, Nothing));
  std::string text;
  int row = -3;
  for (std::string line; std::getline(lines, line); ++row) {
    if (row >= 0) {
      std::istringstream cells(line);
      std::vector<std::string> parts;
      for (std::string cell; std::getline(cells, cell, ',');) parts.push_back(cell);
      change(parts, row);
      line = parts[0] + "," + parts[1] + "," + parts[2] + "," + parts[3];
    }
    text += line + "\n";
  }
  return text;
}

std::string Times(const std::string& cell, double factor) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9f", std::stod(cell) * factor);
  return text;
}

TEST_F(Diagnose, SaysWhichRatioTheAnglesHave) {
  const std::string record =
      Write("sweep.csv", Changed([](auto& cells, int) { cells[2] = Times(cells[2], 1.25); }));
  ExpectRefusal({"diagnose", record, "--json", "--out", Path("out")},
                record +
                    ": error: ratio looks like 100, file says 80 (expected ratio = input angle / output "
                    "angle, signed)\n");
  const std::string turned =
      Write("turned.csv", Changed([](auto& cells, int) { cells[3] = Times(cells[3], -1.0); }));
  ExpectRefusal({"diagnose", turned, "--out", Path("out")},
                turned +
                    ": error: ratio looks like -80, file says 80 (expected ratio = input angle / output "
                    "angle, signed)\n");
}

TEST_F(Diagnose, SaysWhichColumnIsInAnotherUnit) {
  const std::string arcmin =
      Write("arcmin.csv", Changed([](auto& cells, int) { cells[3] = Times(cells[3], 60.0); }));
  ExpectRefusal({"diagnose", arcmin, "--out", Path("out")},
                arcmin +
                    ": error: output_angle_deg looks like arcmin: the input turns 1.3333 for 1 of the "
                    "output, the ratio says 80 (expected angles in degrees)\n");
  const std::string rad =
      Write("rad.csv", Changed([](auto& cells, int) { cells[2] = Times(cells[2], kDeg); }));
  ExpectRefusal({"diagnose", rad, "--out", Path("out")},
                rad +
                    ": error: input_angle_deg looks like rad: the input turns 1.3963 for 1 of the output, "
                    "the ratio says 80 (expected angles in degrees)\n");
  const std::string both = Write("both.csv", Changed([](auto& cells, int) {
                                   cells[2] = Times(cells[2], kDeg);
                                   cells[3] = Times(cells[3], kDeg);
                                 }));
  ExpectRefusal({"diagnose", both, "--out", Path("out")},
                both +
                    ": error: output_angle_deg spans 6.2832, which is a whole turn in rad (expected angles "
                    "in degrees)\n");
}

TEST_F(Diagnose, SaysWhereDirectionsContradictTheAngles) {
  const std::string all_cw = Write("cw.csv", Changed([](auto& cells, int) { cells[1] = "cw"; }));
  ExpectRefusal({"diagnose", all_cw, "--out", Path("out")},
                all_cw +
                    ": error: direction contradicts the angles: 360 of 722 rows marked cw turn the other "
                    "way (expected cw where the output turns one way, ccw where it turns back)\n");
  const std::string swapped =
      Write("swapped.csv", Changed([](auto& cells, int) { cells[1] = cells[1] == "cw" ? "ccw" : "cw"; }));
  const auto json = Json({"diagnose", swapped, "--json"});
  EXPECT_EQ(
      json["warnings"][0],
      "direction contradicts the angles: cw turns the output backwards; differences between the directions "
      "have the other sign then");
  EXPECT_TRUE(json["causes"].empty());
}

TEST_F(Diagnose, RefusesAnglesThatStandStill) {
  const std::string record =
      Write("still.csv", Changed([](auto& cells, int) { cells[3] = std::string(1, '7'); }));
  ExpectRefusal({"diagnose", record, "--out", Path("out")},
                record + ": error: output_angle_deg is constant at 7 (expected a sweep of the output)\n");
}

TEST_F(Diagnose, RefusesMixedKinds) {
  const std::string sweep = Write("sweep.csv", Sweep(12, Nothing));
  const std::string loop =
      Write("loop.csv", "# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n0,0,0\n1,1,0.001\n");
  ExpectRefusal({"diagnose", sweep, loop, "--out", Path("out")},
                sweep +
                    ": error: the records are of 2 kinds: hysteresis, transmission_error (expected one kind; "
                    "--kind chooses it)\n");
}

TEST_F(Diagnose, RefusesTheSameRecordTwice) {
  const std::string sweep = Write("sweep.csv", Sweep(12, Nothing));
  const std::string copy = Write("copy.csv", Sweep(12, Nothing));
  ExpectRefusal(
      {"diagnose", sweep, copy, "--out", Path("out")},
      copy + ": error: holds the same record as " + sweep + " before it (expected each record once)\n");
}

TEST_F(Diagnose, RefusesWhatIsNoRecordToDiagnose) {
  const std::string history = Write("history.csv", "# kind: history\ntime_s,x_V\n0,0\n1,1\n");
  ExpectRefusal({"diagnose", history, "--out", Path("out")},
                history +
                    ": error: a record of kind history cannot be diagnosed (expected transmission_error, "
                    "hysteresis, motion or vibration)\n");
  ExpectRefusal({"diagnose", Path("none.csv"), "--out", Path("out")},
                Path("none.csv") + ": error: No such file or directory (expected a record file)\n");
  ExpectRefusal({"diagnose", folder_.path().string(), "--out", Path("out")},
                folder_.path().string() +
                    ": error: not a campaign (expected a folder with schedule.yaml, "
                    "bench.yaml and campaign.db)\n");
}

TEST_F(Diagnose, RefusesARecordThatIsTooShort) {
  const std::string text = Sweep(12, Nothing);
  const std::string record = Write("short.csv", text.substr(0, text.find("\n5.00,") + 1));
  const ProgramResult result = RunProgram({"diagnose", record, "--json", "--out", Path("out")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(result.error.starts_with(record + ": error: ")) << result.error;
}

TEST_F(Diagnose, WarnsOfTimeStampsThatRepeat) {
  const std::string record = Write("sweep.csv", Changed([](auto& cells, int row) {
                                     char text[40];
                                     std::snprintf(text, sizeof text, "%d", row / 2);
                                     cells[0] = text;
                                   }));
  const auto json = Json({"diagnose", record, "--json"});
  EXPECT_EQ(json["verdict"], "no_effect");
  EXPECT_EQ(json["warnings"][0], "50.1 % of the time stamps repeat the one before");
}

TEST_F(Diagnose, WarnsOfTimeStampsThatJitter) {
  const std::string record =
      Write("sweep.csv", Changed([](auto& cells, int row) {
              char text[40];
              std::snprintf(text, sizeof text, "%.2f", 0.5 * row + 0.2 * std::sin(row * row));
              cells[0] = text;
            }));
  const auto json = Json({"diagnose", record, "--json"});
  EXPECT_EQ(json["verdict"], "no_effect");
  EXPECT_EQ(json["warnings"][0],
            "the time stamps jitter: half of them are off by 30 % and more of their step of 500 ms");
}

class Simulate : public Diagnose {};

TEST_F(Simulate, WritesWhatTheModelWouldHaveMeasured) {
  const std::string record = Write("sweep.csv", Sweep(11, FirstHarmonic));
  ASSERT_EQ(RunProgram({"diagnose", record, "--out", Path("out")}).exit_code, 0);
  const std::string model = Path("out/extended_model.yaml");
  const ProgramResult result =
      RunProgram({"simulate", model, "--like", record, "--out", Path("simulated.csv"), "--seed", "3"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const auto json = Json({"diagnose", Path("simulated.csv"), "--json"});
  ASSERT_EQ(json["causes"].size(), 1u);
  EXPECT_EQ(json["causes"][0]["name"], "wave_generator_first_harmonic");
  const auto& amplitude = json["causes"][0]["parameters"]["amplitude_arcmin"];
  EXPECT_NEAR(amplitude["value"].get<double>(), 0.25, 6.0 * amplitude["se"].get<double>());
  EXPECT_NEAR(json["extended"]["heldout_rmse"].get<double>(), kNoise_arcmin, 0.15 * kNoise_arcmin);
}

TEST_F(Simulate, GivesTheSameBytesForTheSameSeedOnly) {
  const auto bytes = [&](const std::string& seed, const std::string& name) {
    EXPECT_EQ(RunProgram({"simulate", "transmission_error", "--out", Path(name), "--seed", seed}).exit_code,
              0);
    return WholeFile(Path(name));
  };
  EXPECT_EQ(bytes("1", "a.csv"), bytes("1", "b.csv"));
  EXPECT_NE(bytes("1", "a.csv"), bytes("2", "c.csv"));
}

TEST_F(Simulate, RunsTheNominalModelOfEveryKindToNothingFound) {
  for (const char* kind : {"transmission_error", "hysteresis", "motion", "vibration"}) {
    const std::string record = Path(std::string(kind) + ".csv");
    const ProgramResult result = RunProgram({"simulate", kind, "--out", record, "--seed", "4"});
    ASSERT_EQ(result.exit_code, 0) << kind << ": " << result.error;
    const auto json = Json({"diagnose", record, "--json"});
    EXPECT_EQ(json["kind"], kind);
    EXPECT_EQ(json["verdict"], "no_effect")
        << kind << ": " << json["causes"].dump() << json["corrections"].dump();
  }
}

TEST_F(Simulate, NothingButMotionIsJudgedByIt) {
  for (const std::string kind : {"transmission_error", "hysteresis", "vibration"}) {
    const std::string record = Path(kind + ".csv");
    ASSERT_EQ(RunProgram({"simulate", kind, "--out", record, "--seed", "4"}).exit_code, 0);
    ExpectRefusal({"diagnose", record, "--judge-by-simulation", "--out", Path("out")},
                  record + ": error: a record of kind " + kind +
                      " is not judged by simulation (expected one of kind motion, or no "
                      "--judge-by-simulation)\n");
  }
}

TEST_F(Simulate, RefusesAModelThatIsNone) {
  ExpectRefusal({"simulate", "weather", "--out", Path("out")},
                "weather: error: there is no such model (expected transmission_error, hysteresis, motion or "
                "vibration, or an extended_model.yaml that diagnose has written)\n");
}

TEST_F(Simulate, RefusesARecordOfAnotherKind) {
  const std::string record = Write("sweep.csv", Sweep(11, Nothing));
  ExpectRefusal(
      {"simulate", "hysteresis", "--like", record, "--out", Path("out")},
      record + ": error: no record of kind hysteresis (expected the kind of the model hysteresis)\n");
}

TEST_F(Simulate, TheBenchRunsTheVeryFile) {
  const std::string record = Write("sweep.csv", Sweep(11, FirstHarmonic));
  ASSERT_EQ(RunProgram({"diagnose", record, "--out", Path("out")}).exit_code, 0);
  std::string bench = WholeFile(SourceFolder() + "/bench/configuration/embedded_bench.cc");
  bench = bench.substr(bench.find("R\"(") + 3);
  bench = bench.substr(0, bench.find("  plant: []"));
  const std::string bench_file = Write("bench.yaml", bench + "  plant_file: out/extended_model.yaml\n");
  const std::string schedule = SourceFolder() + "/tests/simulation/small.yaml";
  const ProgramResult validated = RunProgram({"validate", schedule, "--bench", bench_file});
  EXPECT_EQ(validated.exit_code, 0) << validated.error;
  const ProgramResult run = RunProgram({"run", schedule, "--bench", bench_file, "--out", Path("campaign")});
  EXPECT_EQ(run.exit_code, 0) << run.error;
}

}  // namespace
}  // namespace strainwave::diagnose_command_test
