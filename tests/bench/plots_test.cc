// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "analysis/units.h"
#include "bench/plots/child_program.h"
#include "bench/plots/gnuplot.h"
#include "bench/plots/hysteresis_picture.h"
#include "bench/plots/script.h"
#include "bench/plots/transmission_error_picture.h"
#include "bench/plots/trend_picture.h"

namespace strainwave::bench::plots_test {
namespace {

namespace fs = std::filesystem;

// A folder of the running test alone, removed at its end.
class Pictures : public testing::Test {
 protected:
  Pictures()
      : folder_(fs::temp_directory_path() /
                fmt::format("strainwave-{}-{}", testing::UnitTest::GetInstance()->current_test_info()->name(),
                            getpid())) {
    fs::remove_all(folder_);
  }
  ~Pictures() override { fs::remove_all(folder_); }

  fs::path Stem() const { return folder_ / "picture"; }

  std::string Read(const std::string& suffix) const {
    std::ifstream file(Stem().string() + suffix, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  void ExpectBothFilesAndNothingElse() const {
    EXPECT_EQ(Read(".png").substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_EQ(Read(".svg").substr(0, 5), "<?xml");
    EXPECT_NE(Read(".svg").find("</svg>"), std::string::npos);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator{}), 2);
  }

  void ExpectText(const std::string& text) const {
    EXPECT_NE(Read(".svg").find(text), std::string::npos) << "the picture lacks '" << text << "'";
  }

 private:
  fs::path folder_;
};

template <typename Error, typename Callable>
std::string MessageOf(Callable callable) {
  try {
    callable();
  } catch (const Error& error) {
    return error.what();
  }
  return "no exception";
}

// A loop of four corners, enough for a picture.
struct Loop {
  std::vector<double> twist_rad{0.0, 1.5e-3, -1.5e-3, 0.0};
  std::vector<double> torque_Nm{1.0, 34.0, -34.0, -1.0};

  HysteresisCurve Curve(const std::string& label, double k1_Nm_per_rad) const {
    return {.label = label,
            .twist_rad = twist_rad,
            .torque_Nm = torque_Nm,
            .fitted_torque_Nm = torque_Nm,
            .torques = {7.0, 25.0, 34.0},
            .k1_Nm_per_rad = {k1_Nm_per_rad, 35.0},
            .k2_Nm_per_rad = {25000.0, 52.0},
            .k3_Nm_per_rad = {29000.0, 120.0},
            .friction_torque_Nm = 1.0};
  }
};

analysis::SweepError Sweep(double e_max_arcmin) {
  analysis::SweepError sweep;
  for (int i = 0; i < 360; ++i) {
    sweep.output_angle_rad.push_back(RadFromDeg(i));
    sweep.error_rad.push_back(RadFromArcmin(i % 2 == 0 ? 0.5 : -0.5) * e_max_arcmin);
  }
  sweep.e_max_rad = {RadFromArcmin(e_max_arcmin), RadFromArcmin(0.013)};
  sweep.orders = {{.order_per_output_rev = 160.0,
                   .order_per_input_rev = 2.0,
                   .amplitude_rad = {RadFromArcmin(0.42), 0.0},
                   .name = "wave generator, 2nd harmonic"},
                  {.order_per_output_rev = 320.0,
                   .order_per_input_rev = 4.0,
                   .amplitude_rad = {RadFromArcmin(0.03), 0.0},
                   .name = "wave generator, 4th harmonic",
                   .aliased = true,
                   .alias_order_per_output_rev = 40.0},
                  {.order_per_output_rev = 77.0,
                   .order_per_input_rev = 0.9625,
                   .amplitude_rad = {1e-6, 0.0},
                   .name = ""}};
  return sweep;
}

TEST(RunChild, TellsHowItEnded) {
  const ChildEnd failed = RunChild({"sh", "-c", "cat; echo wrong >&2; exit 3"}, "given ");
  EXPECT_EQ(failed.error, 0);
  EXPECT_EQ(failed.exit_code, 3);
  EXPECT_EQ(failed.signal, 0);
  EXPECT_EQ(failed.said, "given wrong");
  EXPECT_EQ(RunChild({"sh", "-c", "kill -9 $$"}, "").signal, SIGKILL);
  const ChildEnd apart =
      RunChild({"sh", "-c", "echo result; echo wrong >&2"}, "", std::nullopt, ChildOutputs::kApart);
  EXPECT_EQ(apart.said, "result");
  EXPECT_EQ(apart.words, "wrong");
  EXPECT_EQ(RunChild({"no-such-program-of-strainwave"}, "").error, ENOENT);
}

TEST(RunChild, EndsWhatTakesTooLongWithAllThatItStarted) {
  const ChildEnd end =
      RunChild({"sh", "-c", "sleep 1000 & echo $!; wait"}, "", std::chrono::milliseconds(300));
  EXPECT_TRUE(end.late);
  EXPECT_EQ(end.signal, SIGKILL);
  // The one that it had started is nobody's child, and ends when the system comes to it.
  const std::string status = "/proc/" + end.said + "/stat";
  const auto runs = [&] {
    std::ifstream file(status);
    std::string pid, name, state;
    return static_cast<bool>(file >> pid >> name >> state) && state != "Z";
  };
  while (runs()) std::this_thread::yield();
}

TEST(RunChild, LeavesWhatEndsInTime) {
  const ChildEnd end = RunChild({"echo", "done"}, "", std::chrono::minutes(1));
  EXPECT_FALSE(end.late);
  EXPECT_EQ(end.said, "done");
}

TEST(Quoted, KeepsEveryCharacterButControlOnes) {
  EXPECT_EQ(Quoted("Müller's \"K₁\" \\ {x}"), "'Müller''s \"K₁\" \\ {x}'");
  EXPECT_EQ(Quoted("one\ntwo\t"), "'one two '");
}

TEST(DataBlock, WritesOneRowForEachIndexAndAGapForNaN) {
  const std::vector<double> x{1.0, 2.0};
  const std::vector<double> y{0.5, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(DataBlock("d", {x, y}), "$d << END_OF_DATA\n1 0.5 \n2 NaN \nEND_OF_DATA\n");
}

TEST(DataBlock, RejectsColumnsOfTwoLengths) {
  const std::vector<double> x{1.0, 2.0};
  const std::vector<double> y{0.5};
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] {
              DataBlock("d", {x, y});
            }),
            "columns of 2 and 1 rows stand side by side (expected one length)");
}

TEST(EstimateText, GivesTheStandardErrorTwoDigitsAndTheValueTheSamePlace) {
  EXPECT_EQ(EstimateText({16020.4, 35.2}, "Nm/rad"), "16020 ± 35 Nm/rad");
  EXPECT_EQ(EstimateText({29012.0, 123.0}, "Nm/rad"), "29012 ± 123 Nm/rad");
  EXPECT_EQ(EstimateText({1.04049, 0.0131}, "arcmin"), "1.040 ± 0.013 arcmin");
  EXPECT_EQ(EstimateText({1.04049, 0.0}, "arcmin"), "1.04 arcmin");
}

TEST_F(Pictures, AreWrittenWholeAsSvgAndPng) {
  RenderPicture("plot x", Stem());
  ExpectBothFilesAndNothingElse();
}

TEST_F(Pictures, OfOneScriptAreTheSameBytes) {
  RenderPicture("plot sin(x)", Stem());
  const std::string svg = Read(".svg");
  const std::string png = Read(".png");
  RenderPicture("plot sin(x)", Stem());
  EXPECT_EQ(Read(".svg"), svg);
  EXPECT_EQ(Read(".png"), png);
}

TEST_F(Pictures, AreNeverOverwrittenByOthers) {
  EXPECT_EQ(RenderPicture("plot sin(x)", Stem()), Stem());
  const std::string before = Read(".svg");
  EXPECT_EQ(RenderPicture("plot cos(x)", Stem()), Stem().string() + "_2");
  EXPECT_EQ(RenderPicture("plot x", Stem()), Stem().string() + "_3");
  EXPECT_EQ(Read(".svg"), before);
  EXPECT_NE(Read("_2.svg"), before);
  EXPECT_EQ(RenderPicture("plot cos(x)", Stem()), Stem().string() + "_2") << "the same again is one picture";
}

TEST_F(Pictures, OfARefusedScriptFailWithTheWordsOfGnuplotAndLeaveNothing) {
  const std::string message =
      MessageOf<GnuplotError>([&] { RenderPicture("plot no_such_function(x)", Stem()); });
  EXPECT_EQ(message.rfind("gnuplot ended with exit code 1: ", 0), 0U) << message;
  EXPECT_NE(message.find("no_such_function"), std::string::npos) << message;
  EXPECT_TRUE(fs::is_empty(Stem().parent_path()));
}

TEST_F(Pictures, WithoutGnuplotNameThePackage) {
  EXPECT_EQ(
      MessageOf<GnuplotError>([&] { RenderPictureWith("gnuplot-that-is-not-there", "plot x", Stem()); }),
      "gnuplot-that-is-not-there could not be started: No such file or directory "
      "(expected the package gnuplot-nox)");
}

TEST_F(Pictures, OfAProgramThatDrawsNothingFail) {
  EXPECT_EQ(MessageOf<GnuplotError>([&] { RenderPictureWith("true", "plot x", Stem()); }),
            "true left no picture at " + Stem().string() + ".svg.part");
}

TEST_F(Pictures, OfHysteresisNameBothCyclesAndTheirStiffness) {
  const Loop loop;
  DrawHysteresis("unit 'A'\nset output", loop.Curve("cycle 1", 16000.0), loop.Curve("cycle 12", 14880.0),
                 Stem());
  ExpectBothFilesAndNothingElse();
  for (const char* text :
       {"unit 'A' set output", "cycle 1, measured", "cycle 1, fitted loop", "cycle 12, measured",
        "cycle 1, K₁ = 16000 ± 35 Nm/rad, 0 to 7 Nm", "cycle 12, K₁ = 14880 ± 35 Nm/rad, 0 to 7 Nm",
        "K₃ = 29000 ± 120 Nm/rad, 25 to 34 Nm", "output twist (arcmin)", "output torque (Nm)"}) {
    ExpectText(text);
  }
}

TEST_F(Pictures, OfHysteresisStandWithoutAFittedLoopAndWithoutALastCycle) {
  const Loop loop;
  HysteresisCurve curve = loop.Curve("record.csv", 16000.0);
  curve.fitted_torque_Nm = {};
  DrawHysteresis("a record", curve, std::nullopt, Stem());
  ExpectBothFilesAndNothingElse();
  EXPECT_EQ(Read(".svg").find("fitted loop"), std::string::npos);
}

TEST_F(Pictures, OfHysteresisLeaveOutASlopeThatTheRecordDoesNotHold) {
  const Loop loop;
  HysteresisCurve curve = loop.Curve("record.csv", 16000.0);
  curve.k3_Nm_per_rad.value = std::numeric_limits<double>::quiet_NaN();
  DrawHysteresis("a record", curve, std::nullopt, Stem());
  ExpectBothFilesAndNothingElse();
  ExpectText("K₃ = no value, 25 to 34 Nm");
  curve.k1_Nm_per_rad.value = curve.k3_Nm_per_rad.value;
  fs::remove_all(Stem().parent_path());
  DrawHysteresis("a record", curve, std::nullopt, Stem());
  ExpectText("K₁ = no value, 0 to 7 Nm");
}

TEST_F(Pictures, OfHysteresisRejectColumnsOfTwoLengths) {
  const Loop loop;
  HysteresisCurve curve = loop.Curve("cycle 1", 16000.0);
  curve.torque_Nm = curve.torque_Nm.first(3);
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { DrawHysteresis("t", curve, std::nullopt, Stem()); }),
            "the loop 'cycle 1' has 4 twists, 3 torques and 4 fitted torques (expected one length)");
  curve.twist_rad = {};
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { DrawHysteresis("t", curve, std::nullopt, Stem()); }),
            "the loop 'cycle 1' is empty (expected samples)");
}

TEST_F(Pictures, OfTransmissionErrorNameDirectionsAndOrders) {
  const analysis::TransmissionError first{
      .cw = Sweep(1.2), .ccw = Sweep(1.1), .lost_motion_rad = {}, .failed_checks = {}, .notes = {}};
  const analysis::TransmissionError last{
      .cw = Sweep(1.5), .ccw = Sweep(1.4), .lost_motion_rad = {}, .failed_checks = {}, .notes = {}};
  DrawTransmissionError("unit A", {"cycle 1", first}, TransmissionErrorCurve{"cycle 12", last}, Stem());
  ExpectBothFilesAndNothingElse();
  for (const char* text :
       {"unit A", "cycle 1, cw: e_max = 1.200 ± 0.013 arcmin", "cycle 12, ccw: e_max = 1.400 ± 0.013 arcmin",
        "wave generator, 2nd harmonic", "wave generator, 4th harmonic (seen at 40)", "output angle (deg)",
        "order per output revolution"}) {
    ExpectText(text);
  }
}

TEST_F(Pictures, OfTransmissionErrorStandWithOneDirectionAndNoSpectrum) {
  analysis::TransmissionError error;
  error.ccw = Sweep(1.2);
  error.ccw->orders.clear();
  DrawTransmissionError("unit A", {"record.csv", error}, std::nullopt, Stem());
  ExpectBothFilesAndNothingElse();
  EXPECT_EQ(Read(".svg").find("record.csv, cw"), std::string::npos);
}

TEST_F(Pictures, OfTransmissionErrorRejectACurveWithoutSweeps) {
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] {
              DrawTransmissionError("t", {"cycle 1", {}}, std::nullopt, Stem());
            }),
            "the curve 'cycle 1' has no sweep (expected cw, ccw or both)");
}

TEST_F(Pictures, OfTrendsHaveAPanelForEachQuantity) {
  const std::vector<double> cycle{1.0, 2.0, 3.0};
  const std::vector<double> k1_Nm_per_rad{16000.0, std::numeric_limits<double>::quiet_NaN(), 15900.0};
  const std::vector<double> error{35.0, 35.0, 35.0};
  const std::vector<Trend> trends{{"K₁", "Nm/rad", cycle, k1_Nm_per_rad, error},
                                  {"K₂", "Nm/rad", cycle, cycle, error}};
  DrawTrends("unit A", trends, Stem());
  ExpectBothFilesAndNothingElse();
  ExpectText("K₁ (Nm/rad)");
  ExpectText("K₂ (Nm/rad)");
  ExpectText("± standard error");
}

TEST_F(Pictures, OfTrendsStandForOneCycle) {
  const std::vector<double> one{1.0};
  const std::vector<Trend> trends{{"e_max", "arcmin", one, one, one}};
  DrawTrends("unit A", trends, Stem());
  ExpectBothFilesAndNothingElse();
}

TEST_F(Pictures, OfTrendsRejectWhatCannotBeDrawn) {
  const std::vector<double> two{1.0, 2.0};
  const std::vector<double> one{1.0};
  const std::vector<double> nothing{std::numeric_limits<double>::quiet_NaN()};
  const auto message = [&](const Trend& trend) {
    return MessageOf<std::invalid_argument>([&] { DrawTrends("t", {&trend, 1}, Stem()); });
  };
  EXPECT_EQ(message({"K₁", "Nm/rad", two, two, one}),
            "the trend 'K₁' has 2 cycles, 2 values and 1 standard errors (expected one length)");
  EXPECT_EQ(message({"K₁", "Nm/rad", one, nothing, one}),
            "the trend 'K₁' holds no value (expected at least one)");
  EXPECT_EQ(MessageOf<std::invalid_argument>([&] { DrawTrends("t", {}, Stem()); }),
            "trends is empty (expected at least one)");
}

}  // namespace
}  // namespace strainwave::bench::plots_test
