// SPDX-License-Identifier: Apache-2.0
#include "daq/acquisition/sources/replay_source.h"

#include <gtest/gtest.h>

#include <thread>

#include "daq/acquisition/gap_ledger.h"
#include "daq/acquisition/stream_recorder.h"
#include "daq/record_error.h"
#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/run_python.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::replay_source_test {
namespace {

constexpr std::chrono::nanoseconds kLong = std::chrono::seconds(10);

std::filesystem::path RecordedStream(const ScratchFolder& folder, const SourceDescription& source) {
  StreamRecorder recorder({.folder = folder.path(),
                           .name = "run",
                           .most_rows_a_file = 100000,
                           .ring_blocks = 64,
                           .rows_between_flushes = 500,
                           .attributes = {{"specimen", "A-3"}}},
                          source);
  for (std::uint64_t i = 0; i < 20; ++i) {
    const std::uint64_t number = 100 * i + (i >= 5 ? 77 : 0);
    EXPECT_TRUE(recorder.Push(BlockAt(source, number, 100, [](std::uint64_t n, std::size_t c) {
      return static_cast<double>(n) - 400.0 * static_cast<double>(c);
    })));
  }
  recorder.Finish();
  return folder / "run-000001.h5";
}

SourceDescription Calibrated() {
  SourceDescription source = SourceOf(2, 1000, SampleType::kInt32);
  source.channels[1].sensor_serial = "0815";
  source.channels[1].calibration = {.id = "old", .sensitivity = 4, .zero = 2};
  return source;
}

TEST(ReplaySource, GivesAStreamBackAsItWasRecorded) {
  const ScratchFolder folder;
  const SourceDescription source = Calibrated();
  ReplaySource replay({.path = RecordedStream(folder, source)});
  replay.Start();
  EXPECT_EQ(replay.description().channels[1].calibration, source.channels[1].calibration);
  EXPECT_EQ(replay.description().channels[1].name, "b_V");
  EXPECT_EQ(replay.description().rate_hz, 1000);
  GapLedger ledger({}, 1000);
  SampleBlock block(2 * replay.description().most_samples_a_block);
  std::uint64_t samples = 0;
  while (replay.Next(block, kLong) == NextResult::kBlock) {
    ledger.Admit(block);
    for (std::uint32_t i = 0; i < block.header.samples; ++i) {
      ASSERT_EQ(block.Value(i, 1), static_cast<double>(block.header.first_sample + i) - 400);
    }
    samples += block.header.samples;
  }
  EXPECT_EQ(samples, 2000U);
  EXPECT_EQ(ledger.totals(), (GapTotals{.received = 2000, .lost = 77, .gaps = 1}));
  EXPECT_EQ(replay.Next(block, kLong), NextResult::kEnded);
}

TEST(StreamFile, IsRescaledByALaterCalibration) {
  const ScratchFolder folder;
  const StreamFileReader file(RecordedStream(folder, Calibrated()));
  const std::vector<double> raw = file.Values(1, Calibration{});
  const std::vector<double> old = file.Values(1);
  const Calibration better{.id = "new", .sensitivity = 3.9, .zero = 1.5, .polynomial = {0.01, 1, 1e-4}};
  const std::vector<double> rescaled = file.Values(1, better);
  ASSERT_EQ(raw.size(), 2000U);
  for (std::size_t i = 0; i < raw.size(); ++i) {
    ASSERT_EQ(raw[i], static_cast<double>(i) + (i >= 500 ? 77 : 0) - 400);
    ASSERT_EQ(old[i], (raw[i] - 2) / 4);
    const double x = (raw[i] - 1.5) / 3.9;
    ASSERT_NEAR(rescaled[i], 0.01 + x + 1e-4 * x * x, 1e-12);
  }
  ASSERT_EQ(file.gaps().size(), 1U);
  EXPECT_EQ(file.gaps()[0].row, 500U);
}

TEST(StreamFile, SaysWhatIsWrongWithAnother) {
  const ScratchFolder folder;
  const std::string path = RecordedStream(folder, Calibrated()).string();
  if (RunPython(folder, "import h5py").status != 0)
    GTEST_SKIP() << "skipped, because /usr/bin/python3 has no h5py";
  const auto message = [&](const std::string& change) {
    EXPECT_EQ(RunPython(folder,
                        "import h5py, shutil, numpy as np\nshutil.copy('run-000001.h5', 'x.h5')\nf = "
                        "h5py.File('x.h5', 'r+')\n" +
                            change)
                  .status,
              0);
    std::string text = MessageOf<RecordError>([&] { StreamFileReader(folder / "x.h5"); });
    const std::size_t at = text.find((folder / "x.h5").string());
    return at == 0 ? text.substr((folder / "x.h5").string().size()) : text;
  };
  EXPECT_EQ(message("del f.attrs['strainwave_stream']"),
            ": error: no stream is in the file (expected the attribute 'strainwave_stream')");
  EXPECT_EQ(message("f.attrs['strainwave_stream'] = 2"),
            ": error: attribute 'strainwave_stream' is 2 (expected 1, the format that this version reads)");
  EXPECT_EQ(message("f.attrs['rate_hz'] = -1"),
            ": error: attribute 'rate_hz' is -1 (expected a number not below zero)");
  EXPECT_EQ(
      message("del f['channels/b_V']"),
      ": error: a column of 'samples' has no channel (expected a group in '/channels' for each column)");
  EXPECT_EQ(
      message("f['channels/b_V'].attrs['column'] = 0"),
      ": error: channel 'b_V' has no column of its own (expected a column of 'samples' for each channel)");
  EXPECT_EQ(message("r = f['blocks'][3]; r['row'] = 301; f['blocks'][3] = r"),
            ": error: block 3 begins at row 301 (expected row 300)");
  EXPECT_EQ(message("f['channels/b_V'].attrs['sensitivity'] = 0"),
            ": error: sensitivity = 0 scales nothing (expected a stream as it was written)");
  // Cut: a chunk is missing at the end of the file.
  std::string bytes = daq::BytesOf(path);
  WriteBytes(folder / "y.h5", bytes.substr(0, bytes.size() - 3000));
  EXPECT_NE(MessageOf<RecordError>([&] { StreamFileReader(folder / "y.h5").Values(0); }), "no exception");
}

TEST(ReplaySource, GivesARecordWithItsMissingRowsAsAGap) {
  const ScratchFolder folder;
  std::string csv = "# kind: history\ntime_s,torque_Nm,output_angle_deg\n";
  for (int i = 0; i < 1000; ++i) {
    if (i >= 300 && i < 311) continue;
    csv += std::to_string(5 + i * 0.01) + "," + std::to_string(i * 0.5) + ",1\n";
  }
  WriteBytes(folder / "a.csv", csv);
  ReplaySource replay({.path = folder / "a.csv", .samples_a_block = 128});
  replay.Start();
  EXPECT_NEAR(replay.description().rate_hz, 100, 1e-6);
  ASSERT_EQ(replay.description().channels.size(), 2U);
  EXPECT_EQ(replay.description().channels[0].unit, "Nm");
  GapLedger ledger({}, replay.description().rate_hz);
  SampleBlock block(2 * 128);
  while (replay.Next(block, kLong) == NextResult::kBlock) {
    ledger.Admit(block);
    for (std::uint32_t i = 0; i < block.header.samples; ++i) {
      ASSERT_EQ(block.Value(i, 0), static_cast<double>(block.header.first_sample + i) * 0.5);
    }
  }
  EXPECT_EQ(ledger.totals(), (GapTotals{.received = 989, .lost = 11, .gaps = 1}));
}

TEST(ReplaySource, WaitsForTheTimeOfTheRecordWhenToldTo) {
  const ScratchFolder folder;
  ReplaySource replay({.path = RecordedStream(folder, Calibrated()), .speed = 1e-6});
  replay.Start();
  SampleBlock block(2 * replay.description().most_samples_a_block);
  EXPECT_EQ(replay.Next(block, {}), NextResult::kBlock);
  EXPECT_EQ(replay.Next(block, {}), NextResult::kNothingYet);
}

TEST(ReplaySource, RefusesARecordThatNoClockHolds) {
  const ScratchFolder folder;
  for (const char* const text :
       {"# kind: vibration\ntime_s,accel_x_m_per_s2\n0,1\n0.001,2\n0.002,3\n1e300,4\n",
        "# kind: vibration\n# sample_rate_hz: 1e-300\naccel_x_m_per_s2\n1\n2\n"}) {
    std::ofstream(folder / "a.csv") << text;
    ReplaySource replay({.path = folder / "a.csv"});
    EXPECT_THROW(replay.Start(), RecordError) << text;
  }
}

TEST(ReplaySource, RefusesARecordWithoutARate) {
  const ScratchFolder folder;
  WriteBytes(folder / "a.csv", "# kind: history\ntime_s,torque_Nm\n1,2\n1,3\n1,4\n");
  ReplaySource replay({.path = folder / "a.csv"});
  EXPECT_EQ(MessageOf<RecordError>([&] { replay.Start(); }),
            (folder / "a.csv").string() +
                ": error: the record has no rate to replay it at (expected sample_rate_hz, or a time_s that "
                "goes on)");
}

}  // namespace
}  // namespace strainwave::daq::acquisition::replay_source_test
