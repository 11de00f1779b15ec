// SPDX-License-Identifier: Apache-2.0
// A campaign on a bench of metal whose metal is the device side within the program, in real time: what it
// keeps of its streams, what they lose, and later calibrations.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "bench/campaign/calibrations.h"
#include "bench/campaign/campaign.h"
#include "bench/campaign/campaign_runner.h"
#include "bench/campaign/cycle_context.h"
#include "bench/campaign/recompute.h"
#include "bench/campaign/sample_totals.h"
#include "bench/machines/field/field_machine.h"
#include "daq/acquisition/stream_file_reader.h"
#include "tests/checkout.h"
#include "tests/schedules/schedule_text.h"
#include "tests/simulation/program.h"
#include "tests/simulation/until.h"

namespace strainwave::bench::field_campaign_test {
namespace {

std::filesystem::path Folder() { return std::filesystem::path(SourceFolder()) / "tests/simulation/field"; }

std::string FieldSchedule() {
  std::string text = schedules::With(schedules::GoodSchedule(), "cycles: 3", "cycles: 1");
  text.erase(text.find("phases:"));
  return text + R"(phases:
  - kind: zero_check
    allowed: 2 Nm
  - kind: shunt_check
    expected: 50 Nm
    allowed: 1 Nm
  - kind: load_run
    duration: 6 s
    output_torque: 30 Nm
    input_speed: 1200 rpm
    torque_rate: 200 Nm/s
    log_rate: 10 Hz
    vibration_statistics: 12.8 kHz
    record: [encoders, accelerometers]
  - kind: zero_check
    name: zero_after
    allowed: 2 Nm
measurements:
  declared_temperature: 25 degC
  temperature_tolerance: 20 K
  repeatability_repeats: 0
)";
}

// The bench with a camera that sees numbered pictures, all of one grey.
CampaignInputs InputsIn(const ScratchFolder& scratch) {
  std::ofstream(scratch / "schedule.yaml") << FieldSchedule();
  for (int i = 0; i < 3; ++i) {
    std::ofstream(scratch / ("frame_" + std::to_string(i) + ".ppm"))
        << "P6 64 48 255\n"
        << std::string(std::size_t{3} * 64 * 48, 'g');
  }
  CampaignInputs inputs = ReadInputs(scratch / "schedule.yaml", Folder() / "bench.yaml");
  DeviceDescription camera;
  camera.name = "camera";
  camera.kind = DeviceDescription::Kind::kCamera;
  camera.address = (scratch / "frame_%d.ppm").string();
  inputs.bench.devices.push_back(camera);
  return inputs;
}

// The camera's pictures are all of this grey; of 255 levels JPEG moves a plain one by less than two.
void ExpectPictureOfTheCamera(const std::filesystem::path& file) {
  const cv::Mat picture = cv::imread(file.string());
  ASSERT_EQ(picture.size(), cv::Size(64, 48)) << file;
  EXPECT_LT(cv::norm(picture, cv::Mat(picture.size(), CV_8UC3, cv::Scalar::all('g')), cv::NORM_INF), 2.0);
}

// Has the devices lose samples in the middle of the load run.
class Saboteur final : public ProgressSink {
 public:
  explicit Saboteur(DeviceSide& devices) : devices_(devices) {}
  void Update(const ProgressState& state) override {
    if (state.phase != "load_run" || ++beats_ != 3) return;
    devices_.Do("stream encoders drop 7");
    devices_.Do("stream accelerometers drop 650");
  }
  void Message(std::string_view severity, std::string_view text) override {
    if (severity == "alarm") ADD_FAILURE() << text;
  }
  void CycleStored(int, const std::vector<Result>&) override {}

 private:
  DeviceSide& devices_;
  int beats_{};
};

// Has the driving servo start anew in the load run.
class Reboot final : public ProgressSink {
 public:
  explicit Reboot(DeviceSide& devices) : devices_(devices) {}
  void Update(const ProgressState& state) override {
    if (state.phase == "load_run" && ++beats_ == 2) devices_.Do("drive 1 reboot");
  }
  void Message(std::string_view, std::string_view) override {}
  void CycleStored(int, const std::vector<Result>&) override {}

 private:
  DeviceSide& devices_;
  int beats_{};
};

double Dropped(DeviceSide& devices, const std::string& stream) {
  const std::string told = devices.Do("stream " + stream + " drop 0");
  return std::stod(told.substr(told.rfind(' ') + 1));
}

double LostInFiles(const std::filesystem::path& folder, const std::string& source, std::size_t& files) {
  double lost = 0.0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().filename().string().find(source) == std::string::npos) continue;
    const daq::acquisition::StreamFileReader file(entry.path());
    for (const auto& gap : file.gaps()) lost += static_cast<double>(gap.lost);
    EXPECT_GT(file.rows(), 0U);
    ++files;
  }
  return lost;
}

void RunUntilItTrips(const ScratchFolder& scratch) {
  const CampaignInputs inputs = InputsIn(scratch);
  const CampaignFolder folder{scratch / "campaign"};
  Journal journal = CreateCampaign(folder, inputs);
  FieldMachine machine(inputs.bench, 80.0, {});
  Until([&] { return machine.Devices().sampler.Read().bad_channels == 0; });
  Reboot reboot(*machine.device_side());
  const std::atomic<StopRequest> request{StopRequest::kNone};
  CampaignRunner runner(HeldFolder(folder), inputs.schedule, inputs.bench, machine, journal, request, reboot);
  EXPECT_EQ(runner.Run({}).kind, CampaignEnd::Kind::kFault);
}

/// Two campaigns over CANopen, Modbus TCP and TCP streams, one that trips, for all tests that look at what
/// they have left. Both at once, as they wait in real time.
class FieldCampaign : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    tripped_ = new ScratchFolder;
    auto trips = std::async(std::launch::async, [] { RunUntilItTrips(*tripped_); });
    try {
      RunToItsEnd();
      trips.get();
      if (end_.kind != CampaignEnd::Kind::kCompleted) trouble_ = "did not come to its end: " + end_.text;
    } catch (const std::exception& error) {
      trouble_ = error.what();
    }
  }
  // Each test says itself that there was nothing to look at, and why.
  void SetUp() override { ASSERT_EQ(trouble_, "") << "the two campaigns that these tests look at"; }
  static void RunToItsEnd() {
    scratch_ = new ScratchFolder;
    inputs_ = new CampaignInputs(InputsIn(*scratch_));
    const CampaignFolder folder{*scratch_ / "campaign"};
    Journal journal = CreateCampaign(folder, *inputs_);
    FieldMachine machine(inputs_->bench, 80.0, {});
    Until([&] { return machine.Devices().sampler.Read().bad_channels == 0; });
    DeviceSide& devices = *machine.device_side();
    const double before[] = {Dropped(devices, "encoders"), Dropped(devices, "accelerometers")};
    Saboteur saboteur(devices);
    const std::atomic<StopRequest> request{StopRequest::kNone};
    CampaignRunner runner(HeldFolder(folder), inputs_->schedule, inputs_->bench, machine, journal, request,
                          saboteur);
    end_ = runner.Run({});
    dropped_[0] = Dropped(devices, "encoders") - before[0];
    dropped_[1] = Dropped(devices, "accelerometers") - before[1];
  }
  static void TearDownTestSuite() {
    delete inputs_;
    delete scratch_;
    delete tripped_;
  }

  static CampaignFolder Campaign() { return {*scratch_ / "campaign"}; }
  static double Value(const std::string& quantity) {
    const auto journal = Journal::Open(Campaign().Journal(), Database::Mode::kReadOnly);
    const auto result = FindResult(journal.Results(1, 0), quantity);
    EXPECT_TRUE(result.has_value()) << quantity;
    return result ? result->value : 0.0;
  }

  static ScratchFolder* scratch_;
  static ScratchFolder* tripped_;
  static CampaignInputs* inputs_;
  static CampaignEnd end_;
  static std::string trouble_;
  static double dropped_[2];
};
ScratchFolder* FieldCampaign::scratch_ = nullptr;
ScratchFolder* FieldCampaign::tripped_ = nullptr;
CampaignInputs* FieldCampaign::inputs_ = nullptr;
CampaignEnd FieldCampaign::end_;
std::string FieldCampaign::trouble_;
double FieldCampaign::dropped_[2]{};

TEST_F(FieldCampaign, ReportsExactlyTheLossesThatWereInjected) {
  EXPECT_GE(dropped_[0], 7.0);
  EXPECT_GE(dropped_[1], 650.0);
  EXPECT_EQ(Value("samples_lost_encoders"), dropped_[0]);
  EXPECT_EQ(Value("samples_lost_accelerometers"), dropped_[1]);
  const auto journal = Journal::Open(Campaign().Journal(), Database::Mode::kReadOnly);
  EXPECT_EQ(SamplesOf(journal).at("accelerometers").lost, dropped_[1]);
  // The same as marks in the raw streams: nothing was lost but in the load run.
  std::size_t files = 0;
  EXPECT_EQ(LostInFiles(Campaign().Streams(), "encoders", files), dropped_[0]);
  EXPECT_EQ(LostInFiles(Campaign().Streams(), "accelerometers", files), dropped_[1]);
  EXPECT_EQ(files, 2U);
  EXPECT_EQ(Value("samples_lost_in_files_accelerometers"), dropped_[1]);
}

TEST_F(FieldCampaign, HasAPictureOfItsCycle) {
  ExpectPictureOfTheCamera(Campaign().CycleFile(1).replace_extension(".jpg"));
}

using daq::acquisition::StreamFileReader;

std::string AttributeOf(const StreamFileReader& file, const std::string& name) {
  const auto found = std::ranges::find(file.attributes(), name, &std::pair<std::string, std::string>::first);
  return found == file.attributes().end() ? "" : found->second;
}

// docs/requirements.md R20: raw data of all channels, ten seconds before the trip and ten after.
void ExpectAroundTrip(const std::filesystem::path& path, std::size_t channels, double stop_time_s) {
  const StreamFileReader file(path);
  EXPECT_EQ(file.description().channels.size(), channels);
  EXPECT_FALSE(AttributeOf(file, "stop_cause").empty());
  EXPECT_EQ(std::stod(AttributeOf(file, "stop_time_s")), stop_time_s);
  const std::uint64_t trip = std::stoull(AttributeOf(file, "trigger_row"));
  const auto ten_s = static_cast<std::uint64_t>(10.0 * file.description().rate_hz);
  EXPECT_GT(trip, ten_s / 10);  // as long as the stream had come
  EXPECT_LE(trip, ten_s);
  EXPECT_EQ(file.rows(), trip + 1 + ten_s);
  // The trip was seen at once after it had happened, by the bench's clock.
  const double zero_ns = std::stod(AttributeOf(file, "bench_clock_zero_ns"));
  const auto& blocks = file.blocks();
  const auto block =
      std::ranges::find_if(blocks, [&](const auto& row) { return row.row + row.samples > trip; });
  ASSERT_NE(block, blocks.end());
  const double seen_s = 1e-9 * (static_cast<double>(block->arrival_ns) - zero_ns);
  EXPECT_GT(seen_s, stop_time_s - 1.0);
  EXPECT_LT(seen_s, stop_time_s + 1.0);
  EXPECT_EQ(file.Words(0, file.rows()).size(), file.rows() * channels);
  EXPECT_TRUE(file.gaps().empty());
}

TEST_F(FieldCampaign, ThatTripsHasAPictureAndTheRawStreamsBesideItsBlackBox) {
  const CampaignFolder folder{*tripped_ / "campaign"};
  int black_boxes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.Faults())) {
    if (entry.path().extension() != ".h5" || daq::acquisition::IsStreamFile(entry.path())) continue;
    ++black_boxes;
    const std::filesystem::path stem = std::filesystem::path(entry.path()).replace_extension();
    ExpectPictureOfTheCamera(stem.string() + ".jpg");
    const auto box = daq::ReadCycleFile(entry.path(), daq::Checking::kNone).records.at(0).record;
    const double stop_time_s = std::stod(std::string(box.Metadata("stop_time_s").value()));
    ExpectAroundTrip(stem.string() + "-encoders.h5", 3, stop_time_s);
    ExpectAroundTrip(stem.string() + "-accelerometers.h5", 4, stop_time_s);
  }
  EXPECT_EQ(black_boxes, 1);
}

TEST_F(FieldCampaign, ChecksTheTransducerWithItsShunt) {
  EXPECT_NEAR(Value("zero_check_Nm"), 0.0, 0.5);
  EXPECT_NEAR(Value("shunt_check_Nm"), 50.0, 0.5);
}

// The whole load run at 12.8 kHz, none of it in the cycle's file; against the stream that was kept beside it.
TEST_F(FieldCampaign, HasTheStatisticsOfTheWholeLoadRun) {
  const double rms = Value("load_run_vibration_rms_accel_x_m_per_s2");
  const double peak = Value("load_run_vibration_peak_accel_x_m_per_s2");
  EXPECT_NEAR(Value("load_run_vibration_crest_accel_x"), peak / rms, 1e-9 * peak / rms);
  EXPECT_GT(Value("load_run_vibration_kurtosis_accel_x"), 1.0);
  int streams = 0;
  for (const auto& entry : std::filesystem::directory_iterator(Campaign().Streams())) {
    if (entry.path().filename().string().find("accelerometers") == std::string::npos) continue;
    ++streams;
    const daq::acquisition::StreamFileReader file(entry.path());
    const std::vector<double> values = file.Values(0);
    const auto [least, most] = std::ranges::minmax(values);
    // The file holds the run-up and the run-down, too.
    EXPECT_LE(peak, most - least);
    EXPECT_GT(peak, 0.2 * (most - least));
  }
  EXPECT_EQ(streams, 1);
}

TEST_F(FieldCampaign, ScalesAnewWithALaterCalibration) {
  const CampaignFolder folder = Campaign();
  const auto journal = Journal::Open(folder.Journal(), Database::Mode::kReadOnly);
  CycleContext context = ContextOf(journal, inputs_->schedule, inputs_->bench);
  auto cycles = RecomputeCampaign(folder, journal, context, {});
  EXPECT_TRUE(cycles.back().equal);
  // 24 bits over a quarter more than 100 Nm, as the device says; 1 % more counts a Nm, and a zero of 6711
  // counts.
  constexpr double kCountsPerNm = 8388607.0 / 125.0;
  std::ofstream(*scratch_ / "later.yaml")
      << "calibrations: 1\nsensors:\n  - {serial: DEV-TORQUE, calibration: LATER, sensitivity: "
      << std::to_string(1.01 * kCountsPerNm) << ", zero: 6711}\n";
  context.recalibrations = ReadCalibrations(*scratch_ / "later.yaml");
  cycles = RecomputeCampaign(folder, journal, context, {});
  EXPECT_FALSE(cycles.back().equal);
  const auto& again = cycles.back().again.results;
  EXPECT_NEAR(FindResult(again, "zero_check_Nm")->value,
              (Value("zero_check_Nm") * kCountsPerNm - 6711.0) / (1.01 * kCountsPerNm), 1e-6);
  EXPECT_NEAR(FindResult(again, "shunt_check_Nm")->value, Value("shunt_check_Nm") / 1.01, 1e-6);
}

TEST_F(FieldCampaign, StoresTheClocksOfTheSources) {
  const Journal journal = Journal::Open(Campaign().Journal(), Database::Mode::kReadOnly);
  const auto records = ReadCycleRecords(Campaign(), journal, 1);
  const auto encoders = std::ranges::find(records, "load_run/source_encoders", &NamedRecord::group);
  ASSERT_NE(encoders, records.end());
  // The devices live by the clock of this machine.
  EXPECT_NEAR(encoders->record.Doubles("clock_drift_ppm")[0], 0.0, 5000.0);
  EXPECT_GT(encoders->record.Doubles("received_samples")[0], 0.0);
}

}  // namespace
}  // namespace strainwave::bench::field_campaign_test
