// SPDX-License-Identifier: Apache-2.0
// Truth by h5py, another face of HDF5 than the one under test.
#include "daq/acquisition/stream_recorder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "daq/data_file_error.h"
#include "tests/daq/acquisition/sample_blocks.h"
#include "tests/daq/run_python.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::acquisition::stream_recorder_test {
namespace {

constexpr double kRate_hz = 1000;

class StreamRecorderTest : public testing::Test {
 protected:
  void SetUp() override {
    if (RunPython(folder_, "import h5py").status != 0)
      GTEST_SKIP() << "skipped, because /usr/bin/python3 has no h5py";
  }
  RecorderSettings Settings() const {
    return {.folder = folder_.path(),
            .name = "run",
            .most_rows_a_file = 1000,
            .ring_blocks = 8,
            .rows_between_flushes = 100,
            .attributes = {{"specimen", "A-3"}}};
  }
  void ExpectInPython(const std::string& script) {
    const PythonResult result = RunPython(folder_, "import h5py, numpy as np, os\n" + script);
    EXPECT_EQ(result.status, 0) << result.output;
  }
  // A ring may be full for a moment: a device would lose the block, a test tries again.
  static void PushSurely(StreamRecorder& recorder, const SampleBlock& block) {
    while (!recorder.Push(block)) ::usleep(100);
  }
  ScratchFolder folder_;
};

TEST_F(StreamRecorderTest, WritesFilesThatH5pyReadsWithGapsAndCalibration) {
  SourceDescription source = SourceOf(3, kRate_hz, SampleType::kInt32);
  source.channels[1].sensor_serial = "0815";
  source.channels[1].calibration = {.id = "T-2026-11",
                                    .sensor_serial = "0815",
                                    .sensitivity = 12.5,
                                    .zero = -3,
                                    .polynomial = {0, 1, 0.25},
                                    .due = DateFrom("2027-11-01")};
  StreamRecorder recorder(Settings(), source);
  std::uint64_t number = 500;
  for (int i = 0; i < 25; ++i) {
    if (i == 7 || i == 20) number += 33;  // lost on the way
    PushSurely(recorder, BlockAt(source, number, 100, [](std::uint64_t n, std::size_t c) {
                 return 10.0 * static_cast<double>(n) + static_cast<double>(c);
               }));
    number += 100;
  }
  recorder.Finish();
  EXPECT_EQ(recorder.totals().samples, (GapTotals{.received = 2500, .lost = 66, .gaps = 2}));
  EXPECT_EQ(recorder.totals().files, 3U);
  ExpectInPython(R"(
assert sorted(os.listdir('.')) == ['run-000001.h5', 'run-000002.h5', 'run-000003.h5', 'script.py']
files = [h5py.File('run-00000%d.h5' % i) for i in (1, 2, 3)]
assert [f['samples'].shape for f in files] == [(1000, 3), (1000, 3), (500, 3)]
numbers = np.concatenate([np.arange(500, 1200), np.arange(1233, 2533), np.arange(2566, 3066)])
samples = np.concatenate([f['samples'][:] for f in files])
assert samples.dtype == np.int32 and files[0]['samples'].fletcher32
assert (samples == 10 * numbers[:, None] + np.arange(3)).all()
gaps = [f['gaps'][:] for f in files]
assert [len(g) for g in gaps] == [1, 0, 1]
assert gaps[0]['row'][0] == 700 and gaps[0]['first_lost'][0] == 700 and gaps[0]['lost'][0] == 33
assert gaps[2]['row'][0] == 0 and gaps[2]['first_lost'][0] == 2033 and gaps[2]['is_exact'][0] == 1
blocks = np.concatenate([f['blocks'][:] for f in files])
assert len(blocks) == 25 and (blocks['samples'] == 100).all() and blocks['lost_before'].sum() == 66
assert (blocks['device_counter'] == numbers[::100]).all()
assert (blocks['arrival_ns'] == (blocks['device_counter'].astype('i8') + 100) * 1000000).all()
a = dict(files[1].attrs)
assert a['strainwave_stream'] == 1 and a['source'] == b'test' and a['rate_hz'] == 1000 and a['specimen'] == b'A-3', a
assert a['software'].startswith(b'strainwave '), a
assert list(files[0]['channels']) == ['a_V', 'b_V', 'c_V']
b = dict(files[0]['channels/b_V'].attrs)
assert b['column'] == 1 and b['unit'] == b'V' and b['sensor_serial'] == b'0815' and b['calibration'] == b'T-2026-11'
assert b['sensitivity'] == 12.5 and b['zero'] == -3 and b['polynomial'] == b'0 1 0.25'
assert b['calibration_due'] == b'2027-11-01'
)");
}

TEST_F(StreamRecorderTest, CountsWhatTheRingHadNoRoomForAlsoAtTheEnd) {
  const SourceDescription source = SourceOf(2, kRate_hz);
  StreamRecorder recorder(Settings(), source);
  std::uint64_t refused = 0;
  std::uint64_t pushed = 0;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    if (recorder.Push(BlockAt(source, 50 * i, 50, SampleNumber))) {
      pushed += 50;
    } else {
      refused += 50;
    }
  }
  recorder.Finish();
  const RecorderTotals totals = recorder.totals();
  EXPECT_EQ(totals.samples.received, pushed);
  EXPECT_EQ(totals.samples.lost, refused);
  EXPECT_EQ(totals.blocks_without_room, refused / 50);
  ExpectInPython(R"(
import glob
files = [h5py.File(n) for n in sorted(glob.glob('run-*.h5'))]
assert sum(len(f['samples']) for f in files) + sum(int(f['gaps']['lost'].sum()) for f in files) == 150000
samples = np.concatenate([f['samples'][:, 1] for f in files])
numbers = np.concatenate([np.arange(b['first_sample'], b['first_sample'] + b['samples']) for f in files for b in f['blocks']])
assert (samples == numbers % 100000 + 0.25).all()
)");
}

TEST_F(StreamRecorderTest, LosesOnlyWhatCameAfterTheLastFlushWhenItIsKilled) {
  const SourceDescription source = SourceOf(2, kRate_hz);
  std::array<int, 2> channel{};
  ASSERT_EQ(::pipe(channel.data()), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    StreamRecorder recorder(Settings(), source);
    for (std::uint64_t i = 0; i < 37; ++i) PushSurely(recorder, BlockAt(source, 50 * i, 50, SampleNumber));
    while (recorder.totals().samples.received < 37 * 50) ::usleep(100);
    static_cast<void>(::write(channel[1], "x", 1));
    ::pause();
    ::_exit(0);
  }
  char ready{};
  ASSERT_EQ(::read(channel[0], &ready, 1), 1);
  ExpectInPython(R"(
f = h5py.File('.run-000002.h5.partial', 'r', swmr=True)  # while it is being written
assert len(f['samples']) == 800
)");
  ASSERT_EQ(::kill(child, SIGKILL), 0);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  ExpectInPython(R"(
assert sorted(os.listdir('.')) == ['.run-000002.h5.partial', 'run-000001.h5', 'script.py']
f = h5py.File('.run-000002.h5.partial', 'r', swmr=True)
assert len(f['samples']) == 800 and len(f['blocks']) == 16  # of 850: flushed every 100
assert (f['samples'][:, 0] == np.arange(1000, 1800)).all()
)");
  // The next run leaves the unfinished file alone.
  StreamRecorder next(Settings(), source);
  next.Finish();
  EXPECT_TRUE(std::filesystem::exists(folder_ / "run-000003.h5"));
}

TEST_F(StreamRecorderTest, SaysWhyItCouldNotWriteAndCountsWhatIsMissing) {
  const SourceDescription source = SourceOf(2, kRate_hz);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{300000, 300000};
    if (::setrlimit(RLIMIT_FSIZE, &small) != 0) ::_exit(9);
    RecorderSettings settings = Settings();
    settings.most_rows_a_file = 10000000;
    StreamRecorder recorder(settings, source);
    for (std::uint64_t i = 0; i < 2000; ++i) PushSurely(recorder, BlockAt(source, 50 * i, 50, SampleNumber));
    const std::string message = MessageOf<DataFileError>([&] { recorder.Finish(); });
    const RecorderTotals totals = recorder.totals();
    if (!message.starts_with("cannot write (") ||
        !message.ends_with(".run-000001.h5.partial': File too large")) {
      ::_exit(1);
    }
    if (!recorder.has_failed() || totals.samples.received != 100000) ::_exit(2);
    if (totals.not_written < 50000 || totals.not_written > 99950 || totals.files != 0) ::_exit(3);
    ::_exit(0);
  }
  int status{};
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(StreamRecorderTest, RefusesWhatCannotBeRecorded) {
  const SourceDescription source = SourceOf(2, kRate_hz);
  const auto message = [&](auto change) {
    RecorderSettings settings = Settings();
    SourceDescription changed = source;
    change(settings, changed);
    return MessageOf<std::invalid_argument>([&] { StreamRecorder(settings, changed); });
  };
  using S = RecorderSettings;
  using D = SourceDescription;
  EXPECT_EQ(message([](S& s, D&) { s.name = "a/b"; }), "name = 'a/b' cannot name a file");
  EXPECT_EQ(message([](S& s, D&) { s.most_rows_a_file = 0; }), "most_rows_a_file = 0 is not above zero");
  EXPECT_EQ(message([](S& s, D&) { s.rows_between_flushes = 0; }),
            "rows_between_flushes = 0 is not above zero");
  EXPECT_EQ(message([](S& s, D&) { s.ring_blocks = 0; }), "slots = 0 is not above zero");
  EXPECT_EQ(message([](S&, D& d) { d.channels.clear(); }), "the source has no channels");
  EXPECT_EQ(message([](S&, D& d) { d.channels[1].name = "a_V"; }), "two channels have the name 'a_V'");
  EXPECT_EQ(message([](S&, D& d) { d.channels[1].name = "x/y"; }), "'x/y' cannot name a channel in a file");
  RecorderSettings nowhere = Settings();
  nowhere.folder = folder_ / "none";
  EXPECT_THROW(StreamRecorder(nowhere, source), std::filesystem::filesystem_error);
}

}  // namespace
}  // namespace strainwave::daq::acquisition::stream_recorder_test
