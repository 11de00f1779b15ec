// SPDX-License-Identifier: Apache-2.0
// What others write, we read, and the other way round: h5py, another face of HDF5 than the one under test.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "daq/cycle_file.h"
#include "daq/read_records.h"
#include "daq/record_error.h"
#include "daq/whole_file.h"
#include "tests/daq/run_python.h"
#include "tests/daq/sample_records.h"
#include "tests/daq/scratch_folder.h"

namespace strainwave::daq::h5py_test {
namespace {

class H5pyTest : public testing::Test {
 protected:
  void SetUp() override {
    if (RunPython(folder_, "import h5py").status != 0)
      GTEST_SKIP() << "skipped, because /usr/bin/python3 has no h5py";
  }

  std::string Write(const std::string& script) {
    const PythonResult result =
        RunPython(folder_, "import h5py, numpy as np\nf = h5py.File('r.h5', 'w')\n" + script);
    EXPECT_EQ(result.status, 0) << result.output;
    return (folder_ / "r.h5").string();
  }

  std::string ErrorOf(const std::string& script) {
    const std::string path = Write(script);
    std::string message = MessageOf<RecordError>([&] { ReadRecords(path); });
    for (std::size_t at = 0; (at = message.find(path)) != message.npos;)
      message.replace(at, path.size(), "r.h5");
    return message;
  }

  ScratchFolder folder_;
};

TEST_F(H5pyTest, ReadsWhatWeWrite) {
  const std::vector<NamedRecord> records{
      {"sweep", SampleSweep()}, {"loop", SampleLoop()}, {"accel", SampleVibration()}};
  WriteRecordsAtomically(folder_ / "a.h5", records, {{"cycle", "17"}, {"specimen", "A-3"}});
  const PythonResult result = RunPython(folder_, R"(
import h5py, numpy as np
f = h5py.File('a.h5')
assert f.attrs['cycle'] == 17.0 and f.attrs['specimen'] == b'A-3' and f.attrs['strainwave_format'] == 1
assert list(f) == ['sweep', 'loop', 'accel'] or sorted(f) == ['accel', 'loop', 'sweep']
sweep, loop, accel = f['sweep'], f['loop'], f['accel']
assert sweep.attrs['kind'] == b'transmission_error' and sweep.attrs['ratio'] == -80.0
assert list(sweep['direction'][:]) == [b'cw', b'ccw']
assert loop.attrs['t2_Nm'] == b'25.0' and loop.attrs['specimen'].decode() == 'Nr. 007 "ä"'
torque = loop['torque_Nm']
assert torque.dtype == np.float64 and torque.fletcher32 and torque.compression is None
assert torque[:].tobytes() == np.array([-0.0, 5e-324, -34.5]).tobytes()
assert dict(torque.attrs) == {'unit': b'Nm', 'sensor_serial': b'0815', 'calibration': b'T-2024-11'}
x = accel['accel_x_m_per_s2']
assert x.dtype == np.float32 and x.attrs['unit'] == b'm/s^2' and x.attrs['sample_rate_hz'] == 25600.0
)");
  EXPECT_EQ(result.status, 0) << result.output;
}

TEST_F(H5pyTest, ReadsWhatWeDeflate) {
  Record loop = SampleLoop();
  loop.columns.clear();
  for (const char* name : {"time_s", "torque_Nm", "output_angle_deg"}) {
    std::vector<double> values(100'000);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i) / 64.0;
    loop.columns.push_back({name, std::move(values), "", ""});
  }
  WriteFileAtomically(folder_ / "a.h5", ImageOfRecords(std::vector<NamedRecord>{{"loop", loop}}, {}, "a.h5",
                                                       Packing::kDeflated));
  const PythonResult result = RunPython(folder_, R"(
import h5py, numpy as np, os
loop = h5py.File('a.h5')['loop']
for name in 'time_s', 'torque_Nm', 'output_angle_deg':
    column = loop[name]
    assert column.compression == 'gzip' and column.shuffle and column.fletcher32, name
    assert column[:].tobytes() == (np.arange(100000) / 64).tobytes(), name
assert os.path.getsize('a.h5') < 600000, os.path.getsize('a.h5')
)");
  EXPECT_EQ(result.status, 0) << result.output;
}

TEST_F(H5pyTest, WritesWhatWeReadAtAnyDepthAndInAnyNumberType) {
  const std::vector<Record> records = ReadRecords(Write(R"(
g = f.create_group('bench/left/loop')
g.attrs['kind'] = 'hysteresis'; g.attrs['t1_Nm'] = 6; g.attrs['t3_Nm'] = np.float32(33.3)
g.attrs['absolute'] = True; g.attrs['list'] = [1, 2]
g['time_s'] = np.arange(3); g['torque_Nm'] = np.array([0.1, 2, 3], 'f4')
g['output_angle_deg'] = np.array([[1.0, 2.0, 3.0]])
g['torque_Nm'].attrs['sensor_serial'] = 'S1'; g['spectrum'] = np.zeros((4, 4)); g['long'] = np.zeros(9)
g['remark'] = ['a', 'b', 'c']
)"));
  ASSERT_EQ(records.size(), 1U);
  const Record& record = records[0];
  EXPECT_EQ(record.source.group, "/bench/left/loop");
  EXPECT_EQ(record.Metadata("t1_Nm"), "6");
  EXPECT_EQ(record.Metadata("t3_Nm"), "33.3");
  EXPECT_EQ(record.Metadata("absolute"), "true");
  EXPECT_EQ(record.Doubles("time_s")[2], 2.0);
  EXPECT_EQ(record.Doubles("torque_Nm")[0], static_cast<double>(0.1F));
  EXPECT_EQ(record.Doubles("output_angle_deg")[2], 3.0);
  EXPECT_EQ(record.FindColumn("torque_Nm")->sensor_serial, "S1");
  EXPECT_EQ(record.notes,
            (std::vector<RecordNote>{{0, "attribute 'list' is left out: it is not one text or number"},
                                     {0, "dataset 'remark' is left out: remark does not hold numbers"},
                                     {0, "dataset 'spectrum' is left out: spectrum is not one-dimensional"},
                                     {0, "dataset 'long' is left out: it has 9 rows, the record has 3"}}));
}

TEST_F(H5pyTest, WritesARecordInTheRootGroup) {
  const std::vector<Record> records = ReadRecords(Write(R"(
f.attrs['kind'] = np.bytes_('vibration'); f.attrs['sample_rate_hz'] = 12800
f['accel_x_m_per_s2'] = np.array([1, 2], 'f4'); f['mic_Pa'] = np.array([1.5, 2.5])
)"));
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(std::get<std::vector<float>>(records[0].FindColumn("accel_x_m_per_s2")->values)[1], 2.0F);
  EXPECT_EQ(records[0].Doubles("mic_Pa")[1], 2.5);
}

TEST_F(H5pyTest, WritesDirectionsInEachWayThatWeRead) {
  for (const char* directions :
       {"np.array([b'cw', b'ccw'])", "np.array(['cw', 'ccw'], dtype=h5py.string_dtype())",
        "np.array([b'CW', b'CCW'])", "np.array(['forward', 'backward'], dtype=h5py.string_dtype())",
        "np.array([b'+1', b'-1'])",
        "np.array([0, 1], dtype=h5py.enum_dtype({'Forward': 0, 'Reverse': 1}, 'i1'))",
        "np.array([1, -1], 'i1')", "np.array([1.0, -1.0])",
        "np.array([3, 9], dtype=h5py.enum_dtype({'cw': 3, 'ccw': 9}, 'i4'))",
        "np.array([1, -1], dtype=h5py.enum_dtype({'RIGHT': 1, 'LEFT': -1}, 'i2'))"}) {
    const std::vector<Record> records = ReadRecords(Write(std::string(R"(
g = f.create_group('s'); g.attrs['kind'] = 'transmission_error'
g['input_angle_deg'] = [0, 80]; g['output_angle_deg'] = [0.0, 1.0]
g.create_dataset('direction', data=)") + directions + ")"));
    EXPECT_EQ(records.at(0).Directions("direction")[0], Direction::kClockwise) << directions;
    EXPECT_EQ(records.at(0).Directions("direction")[1], Direction::kCounterClockwise) << directions;
  }
}

constexpr char kLoop[] = R"(
g = f.create_group('x'); g.attrs['kind'] = 'hysteresis'
g['time_s'] = np.arange(20) / 10; g['torque_Nm'] = np.zeros(20); g['output_angle_deg'] = np.zeros(20)
)";

TEST_F(H5pyTest, BreaksTheRulesWithGroupDatasetAndRow) {
  const std::string loop = kLoop;
  EXPECT_EQ(
      ErrorOf(loop + "g['torque_Nm'][17] = np.nan"),
      "r.h5: error: group '/x', dataset 'torque_Nm', row 17: torque_Nm is nan (expected a finite number)");
  EXPECT_EQ(ErrorOf(loop + "g['time_s'][3] = 0.05"),
            "r.h5: error: group '/x', dataset 'time_s', row 3: time_s runs backwards from 0.2 to 0.05 "
            "(expected time "
            "that never decreases)");
  EXPECT_EQ(
      ErrorOf(loop + "g.attrs['t1_Nm'] = 30.0"),
      "r.h5: error: group '/x', attribute 't1_Nm': t1_Nm = 30 is not below t2_Nm = 25 (expected 0 < t1_Nm < "
      "t2_Nm < t3_Nm)");
  EXPECT_EQ(
      ErrorOf(loop + "g.attrs['kind'] = 'loop'"),
      "r.h5: error: group '/x', attribute 'kind': kind is 'loop' (expected transmission_error, hysteresis, "
      "motion, vibration, motor, joints or history)");
  EXPECT_EQ(ErrorOf(loop + "del g['torque_Nm']"),
            "r.h5: error: group '/x': column 'torque_Nm' is missing (expected the columns time_s, torque_Nm, "
            "output_angle_deg in a hysteresis record)");
  EXPECT_EQ(ErrorOf(loop + "del g['torque_Nm']; g['torque_Nm'] = np.zeros(19)"),
            "r.h5: error: group '/x', dataset 'torque_Nm': torque_Nm has 19 rows (expected 20, as "
            "'output_angle_deg' "
            "has)");
  EXPECT_EQ(
      ErrorOf(loop + "del g['torque_Nm']; g['torque_Nm'] = ['a'] * 20"),
      "r.h5: error: group '/x', dataset 'torque_Nm': torque_Nm does not hold numbers (expected floats or "
      "integers)");
  EXPECT_EQ(
      ErrorOf(
          "f.attrs['kind'] = 'transmission_error'\nf['direction'] = [1, 2]\nf['input_angle_deg'] = [1, 2]\n"
          "f['output_angle_deg'] = [1, 2]\nf.attrs['ratio'] = 0"),
      "r.h5: error: group '/', dataset 'direction', row 1: direction is 2 (expected cw or ccw, forward or "
      "backward, 1 or -1)\n"
      "r.h5: error: group '/', attribute 'ratio': ratio is 0 (expected a number other than zero)");
}

TEST_F(H5pyTest, NamesTheCompressionThatItCannotRead) {
  const std::string expected = " (expected gzip or none, as after h5repack -f GZIP=4)";
  EXPECT_EQ(ErrorOf(R"(
g = f.create_group('x'); g.attrs['kind'] = 'hysteresis'
for name in ('time_s', 'torque_Nm', 'output_angle_deg'): g.create_dataset(name, data=np.arange(2000) // 500, compression='lzf')
f.close()
)"),
            "r.h5: error: group '/x', datasets 'output_angle_deg', 'time_s', 'torque_Nm': compressed with "
            "LZF, which "
            "needs h5py" +
                expected);
  const auto with_filter = [&](int filter) {
    return ErrorOf(fmt::format(R"({}
del g['torque_Nm']
p = h5py.h5p.create(h5py.h5p.DATASET_CREATE); p.set_chunk((20,)); p.set_filter({}, h5py.h5z.FLAG_OPTIONAL, ())
d = h5py.h5d.create(g.id, b'torque_Nm', h5py.h5t.NATIVE_DOUBLE, h5py.h5s.create_simple((20,)), dcpl=p)
d.write_direct_chunk((0,), b'0123456789')
f.close()
)",
                               kLoop, filter));
  };
  EXPECT_EQ(with_filter(32015),
            "r.h5: error: group '/x', dataset 'torque_Nm': compressed with Zstandard, which needs a plug-in" +
                expected);
  EXPECT_EQ(with_filter(31999),
            "r.h5: error: group '/x', dataset 'torque_Nm': compressed with filter 31999 of HDF5, which needs "
            "a plug-in" +
                expected);
}

TEST_F(H5pyTest, ReadsTablesOfCompoundRowsByTheNamesInThem) {
  const std::vector<Record> records = ReadRecords(Write(R"(
g = f.create_group('sweep'); g.attrs['kind'] = 'transmission_error'
rows = np.zeros(3, [('index', 'i8'), ('output_angle_deg', '>f4'), ('direction', 'S3'), ('input_angle_deg', 'f8'),
                    ('cell', 'f8', (2,))])
rows['output_angle_deg'] = [1, 2, 3.5]; rows['direction'] = [b'cw', b'ccw', b'cw']; rows['input_angle_deg'] = [80, 160.25, 7]
g.create_dataset('table', data=rows, compression='gzip')
)"));
  ASSERT_EQ(records.size(), 1U);
  EXPECT_EQ(records[0].Doubles("output_angle_deg")[2], 3.5);
  EXPECT_EQ(records[0].Doubles("input_angle_deg")[1], 160.25);
  EXPECT_EQ(records[0].Directions("direction")[1], Direction::kCounterClockwise);
  EXPECT_EQ(records[0].notes,
            (std::vector<RecordNote>{{0, "dataset 'table' is left out: cell does not hold numbers"}}));
}

TEST_F(H5pyTest, SaysWhatATableOfOtherNamesIs) {
  EXPECT_EQ(ErrorOf(R"(
g = f.create_group('x'); g.attrs['kind'] = 'hysteresis'
g['table'] = np.zeros(9, [('index', 'i8'), ('values_block_0', 'f8', (3,))])
f.close()
)"),
            "r.h5: error: group '/x', dataset 'table': its rows hold several values, none with the name of a "
            "column "
            "(expected a dataset for each column, or rows whose values have the names of columns, such as "
            "torque_Nm)");
  EXPECT_EQ(ErrorOf(std::string(kLoop) + "g['table'] = np.zeros(20, [('torque_Nm', 'f8')])\nf.close()"),
            "r.h5: error: group '/x', dataset 'torque_Nm': column 'torque_Nm' is doubled (expected each "
            "column once)");
}

TEST_F(H5pyTest, NeverFillsInValuesThatWereNotWritten) {
  const std::string loop = kLoop;
  const std::string message =
      "r.h5: error: group '/x', dataset 'torque_Nm': torque_Nm has values missing that were never written "
      "(expected "
      "as many values stored as there are rows)";
  EXPECT_EQ(ErrorOf(loop + "del g['torque_Nm']; g.create_dataset('torque_Nm', (20,))"), message);
  EXPECT_EQ(
      ErrorOf(loop + "del g['torque_Nm']; d = g.create_dataset('torque_Nm', (20,), chunks=(5,)); d[:12] = 1"),
      message);
}

TEST_F(H5pyTest, WritesAForeignFileWithoutARecord) {
  EXPECT_EQ(ErrorOf("f['data/values'] = np.zeros(4)"),
            "r.h5: error: no record is in the file (expected a group with the attribute 'kind')");
}

TEST_F(H5pyTest, MayLinkAGroupBackToItsParent) {
  EXPECT_EQ(
      ReadRecords(Write(std::string(kLoop) + "g['up'] = f['/']; g['soft'] = h5py.SoftLink('/none')")).size(),
      1U);
}

// 80 MB of zeros in 80 kB: whoever writes so little has not measured so much.
TEST_F(H5pyTest, RefusesAFewBytesThatBecomeVeryMany) {
  const std::string message = ErrorOf(R"(
g = f.create_group('v')
g.attrs['kind'] = 'vibration'
g.attrs['sample_rate_hz'] = 1000.0
g.create_dataset('accel_x_m_per_s2', data=np.zeros(10**7), chunks=(10**5,), compression='gzip')
f.close()
)");
  EXPECT_TRUE(std::regex_search(
      message, std::regex("^r\\.h5: error: group '/v', dataset 'accel_x_m_per_s2': accel_x_m_per_s2 becomes "
                          "80000000 bytes out of [0-9]+ \\(expected at most 100 times as many, as measured "
                          "values do\\)")))
      << message;
}

TEST_F(H5pyTest, RefusesAnObjectOfTooManyAttributes) {
  EXPECT_EQ(
      ErrorOf(R"(
f.close()
f = h5py.File('r.h5', 'w', libver='latest')
g = f.create_group('v')
g.attrs['kind'] = 'vibration'
kind, one = h5py.h5t.NATIVE_INT32, h5py.h5s.create(h5py.h5s.SCALAR)
for i in range(10000): h5py.h5a.create(g.id, b'k%d' % i, kind, one)
f.close()
)"),
      "r.h5: error: HDF5 cannot read the file: an object has 10001 attributes (at most 10000) (expected "
      "the file as it was written)");
}

TEST_F(H5pyTest, RefusesGroupsThatAreTooManyOrTooDeep) {
  EXPECT_EQ(ErrorOf("for i in range(10001): f.create_group('g%d' % i)\nf.close()"),
            "r.h5: error: HDF5 cannot read the file: a group has 10001 members (at most 10000) (expected the "
            "file as it was written)");
  EXPECT_EQ(
      ErrorOf("f.create_group('/'.join('g' * 40))\nf.close()"),
      "r.h5: error: HDF5 cannot read the file: groups are in one another more than 32 deep (expected the "
      "file as it was written)");
}

TEST_F(H5pyTest, RefusesValuesThatAreInAnotherFile) {
  EXPECT_EQ(ErrorOf(std::string(kLoop) + R"(
del g['torque_Nm']
open('raw', 'wb').write(bytes(8 * len(g['time_s'])))
g.create_dataset('torque_Nm', shape=g['time_s'].shape, dtype='f8', external=[('raw', 0, 8 * len(g['time_s']))])
f.close()
)"),
            "r.h5: error: group '/x', dataset 'torque_Nm': torque_Nm has values missing that were never "
            "written (expected as many values stored as there are rows)");
}

TEST_F(H5pyTest, RefusesWhatAQuantityCannotBe) {
  EXPECT_EQ(ErrorOf(std::string(kLoop) + "g['torque_Nm'][1] = 1e200\nf.close()"),
            "r.h5: error: group '/x', dataset 'torque_Nm', row 1: torque_Nm is 1e+200 (expected a number "
            "from -1e+06 to 1e+06 Nm)");
}

}  // namespace
}  // namespace strainwave::daq::h5py_test
