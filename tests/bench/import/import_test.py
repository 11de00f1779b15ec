#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Files as instruments write them become records: values, units and rates against what was written, and the exact
message of what is refused.

usage: import_test.py PROGRAM     exit code 77: skipped, there is no NumPy or h5py"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest
import wave

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import needed  # noqa: E402

with needed.peers():
    import h5py
    import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import instrument_files as files  # noqa: E402

PROGRAM = ""


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


class Import(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.random = numpy.random.default_rng(5)

    def write(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def map(self, columns, kind="vibration", time=None, rate=None, metadata=None):
        text = f"map: 1\nkind: {kind}\n"
        text += f"time: {json.dumps(time)}\n" if time else ""
        text += f"sample_rate: {rate}\n" if rate else ""
        text += "columns:\n" + "".join(f"  {name}: {json.dumps(source)}\n" for name, source in columns.items())
        text += f"metadata: {json.dumps(metadata)}\n" if metadata else ""
        return self.write("map.yaml", text)

    def convert(self, path, *arguments):
        """The record as columns and metadata, and what was told."""
        out = self.folder / "out.csv"
        code, said, told = run("convert", path, "--out", out, "--json", *arguments)
        self.assertEqual(code, 0, told)
        lines = out.read_text().splitlines()
        metadata = dict(line[2:].split(": ", 1) for line in lines if line.startswith("#"))
        rows = [line.split(",") for line in lines if not line.startswith("#")]
        columns = {name: [row[c] for row in rows[1:]] for c, name in enumerate(rows[0])}
        return columns, metadata, json.loads(said)["warnings"]

    def refused(self, path, *arguments):
        (self.folder / "out.csv").unlink(missing_ok=True)
        code, said, told = run("convert", path, "--out", self.folder / "out.csv", *arguments)
        self.assertEqual(code, 2, said + told)
        self.assertFalse((self.folder / "out.csv").exists())
        return told.replace(str(self.folder) + "/", "").strip()

    def preview(self, path):
        code, said, told = run("convert", path, "--preview", "--json")
        self.assertEqual(code, 0, told)
        return json.loads(said)["preview"]

    def same(self, texts, values, relative=1e-12):
        numpy.testing.assert_allclose(numpy.array(texts, float), values, rtol=relative, atol=1e-12)


class Mat(Import):
    def test_arrays_of_every_number_and_flat_structs(self):
        wave_m = self.random.standard_normal(500)
        for compressed in (False, True):
            for code in ("f8", "f4", "i2", "i4", "u1", "i8"):
                numbers = (100 * wave_m).astype(code) if code[0] != "u" else numpy.abs(100 * wave_m).astype(code)
                path = files.mat5(self.folder / "a.mat", {"x": numbers.reshape(-1, 1), "s": {"y": numbers, "fs": numpy.array(5.0)},
                                                          "note": "bench 3"}, compressed)
                mapping = self.map({"accel_x_m_per_s2": {"from": "x", "unit": "m/s^2"},
                                    "accel_y_m_per_s2": {"from": "s.y", "unit": "g"}}, rate="51.2 kHz")
                columns, metadata, _ = self.convert(path, "--map", mapping)
                self.same(columns["accel_x_m_per_s2"], numbers.astype(float))
                self.same(columns["accel_y_m_per_s2"], numbers.astype(float) * 9.80665)
                self.assertEqual(metadata["sample_rate_hz"], "51200")
        self.assertIn("s.fs = 5", self.preview(path))
        self.assertIn("note = bench 3", self.preview(path))

    def test_a_matrix_is_a_series_a_column_or_a_row(self):
        values = self.random.standard_normal((400, 3))
        tall = files.mat5(self.folder / "tall.mat", {"data": values})
        flat = files.mat5(self.folder / "flat.mat", {"data": values.T})
        for path, name in ((tall, "data(:,2)"), (flat, "data(2,:)")):
            for unit in ({"unit": "m/s^2"}, {}):  # what stands in brackets here is no unit
                mapping = self.map({"accel_x_m_per_s2": {"from": name} | unit}, rate="1 kHz")
                columns, _, told = self.convert(path, "--map", mapping)
                self.same(columns["accel_x_m_per_s2"], values[:, 1])
                self.assertEqual([line for line in told if "(:,2)'" in line and "by the file" in line], [])

    def test_what_is_no_series_is_left_out_in_words(self):
        path = files.mat5(self.folder / "a.mat", {"x": numpy.arange(9.0), "c": [numpy.arange(3.0)], "z": numpy.arange(4.0) * 1j,
                                                  "deep": {"s": {"t": numpy.arange(3.0)}}})
        lines = self.preview(path)
        for line in ("variable c is left out: it is a cell array", "variable z is left out: its numbers are complex",
                     "variable deep.s is left out: it is a struct in a struct"):
            self.assertIn(line, lines)

    def test_a_file_that_is_cut_off_says_what_is_whole(self):
        path = files.mat5(self.folder / "a.mat", {"x": numpy.arange(100.0), "y": numpy.arange(100.0)})
        size = path.stat().st_size
        path.write_bytes(path.read_bytes()[:-100])
        self.assertEqual(self.refused(path, "--map", self.map({"accel_x_m_per_s2": {"from": "x"}}, rate="1 kHz")),
                         f"a.mat: byte {128 + (size - 128) // 2}: error: the file is cut off within variable 2; 1 before it is "
                         "whole (expected 100 bytes more)")

    def test_of_version_7_3(self):
        path = self.folder / "a.mat"
        with h5py.File(path, "w", userblock_size=512) as file:
            data = file.create_dataset("x", data=numpy.arange(50.0).reshape(1, 50))
            text = h5py.h5t.C_S1.copy()  # ended by a zero, as MATLAB writes it
            text.set_size(6)
            attribute = h5py.h5a.create(data.id, b"MATLAB_class", text, h5py.h5s.create(h5py.h5s.SCALAR))
            attribute.write(numpy.array(b"double", "S6"), text)
        with path.open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + b"\0" * 8 + b"\x00\x02IM")
        self.assertEqual(self.preview(path)[0], "MAT 7.3")
        columns, _, _ = self.convert(path, "--map", self.map({"accel_x_m_per_s2": {"from": "x", "unit": "g"}}, rate="1 kHz"))
        self.same(columns["accel_x_m_per_s2"], numpy.arange(50) * 9.80665)

    def test_its_own_files_come_back(self):
        record = self.write("r.csv", "# kind: hysteresis\n# t1_Nm: 6\ntime_s,torque_Nm,output_angle_deg\n" +
                            "".join(f"{i * 0.01},{i % 7},{i % 5 * 0.1}\n" for i in range(50)))
        self.assertEqual(run("convert", record, "--out", self.folder / "r.mat")[0], 0)
        columns, metadata, _ = self.convert(self.folder / "r.mat")
        self.same(columns["torque_Nm"], [i % 7 for i in range(50)])
        self.assertEqual((metadata["kind"], metadata["t1_Nm"]), ("hysteresis", "6"))


class Uff(Import):
    def read(self, content, unit=None, **rest):
        source = {"from": "accel z"} | ({"unit": unit} if unit else {})
        return self.convert(self.write("a.uff", content), "--map", self.map({"accel_z_m_per_s2": source}, **rest))

    def test_text_and_binary_of_either_order(self):
        values = self.random.standard_normal(103)
        for binary in (None, "<", ">"):
            for double in (False, True):
                columns, metadata, _ = self.read(files.uff_set("accel z", values, 1 / 51200, binary=binary, double=double))
                self.same(columns["accel_z_m_per_s2"], values, 1e-10 if double else 1e-4)
                self.assertEqual(metadata["sample_rate_hz"], "51200")

    def test_what_writers_do(self):
        values = numpy.array([1.5, -2.25, 3.0e-5])
        for content in (files.uff_set("accel z", values, 0.01, exponent="D"), files.uff_set("accel z", values, 0.01, end="\r\n"),
                        files.uff_set("accel z", values, 0.01, binary="<", before_border="\r\n"),
                        b"    -1\n   151\nmodel\n    -1\n" + files.uff_set("accel z", values, 0.01)):
            columns, _, _ = self.read(content)
            self.same(columns["accel_z_m_per_s2"], values)
        _, _, told = self.read(files.uff_set("accel z", values, 0.01, binary="<", said_bytes=12))
        self.assertTrue(any("the file says 12 bytes of values; 3 values take 24" in line for line in told), told)

    def test_uneven_times_and_units(self):
        times, values = numpy.array([0, 0.1, 0.25, 0.3]), numpy.array([1.0, 2, 3, 4])
        for binary in (None, "<"):
            columns, _, _ = self.read(files.uff_set("accel z", values, times=times, unit="g", binary=binary),
                                      time={"column": "accel z time"})
            self.same(columns["time_s"], times, 1e-6)
            self.same(columns["accel_z_m_per_s2"], values * 9.80665)

    def test_is_refused_where_it_breaks_off(self):
        whole = files.uff_set("accel z", numpy.arange(40.0), 0.01)
        mapping = self.map({"accel_z_m_per_s2": {"from": "accel z"}})
        broken = self.write("a.uff", whole + whole[:-200])
        self.assertRegex(self.refused(broken, "--map", mapping),
                         r"^a.uff:\d+: error: .* \(expected .*; before it 1 function is whole\)$")
        binary = files.uff_set("accel z", numpy.arange(40.0), 0.01, binary="<")
        self.assertRegex(self.refused(self.write("a.uff", binary[:-100]), "--map", mapping),
                         r"the file is cut off: 227 of 320 bytes of values are there")

    def test_its_own_files_come_back(self):
        record = self.write("r.csv", "# kind: vibration\n# sample_rate_hz: 12800\naccel_x_m_per_s2\n" +
                            "".join(f"{i % 9 - 4.125}\n" for i in range(90)))
        self.assertEqual(run("convert", record, "--out", self.folder / "r.uff")[0], 0)
        columns, metadata, _ = self.convert(self.folder / "r.uff", "--map",
                                            self.map({"accel_x_m_per_s2": {"from": "accel_x_m_per_s2"}}))
        self.same(columns["accel_x_m_per_s2"], [i % 9 - 4.125 for i in range(90)])
        self.assertEqual(metadata["sample_rate_hz"], "12800")


class Tdms(Import):
    X = "/'m'/'x'"

    def objects(self, values, **properties):
        return {"/": (None, {"operator": "bench 3"}), "/'m'": (None, {}),
                self.X: (values, {"wf_increment": 1 / 25600, "unit_string": "g"} | properties)}

    def read(self, content):
        path = self.write("a.tdms", content)
        return self.convert(path, "--map", self.map({"accel_x_m_per_s2": {"from": "m/x"}}))

    def test_segments_chunks_and_interleaved_values(self):
        for code in ("<f8", "<f4", "<i2", "<u1"):
            values = numpy.arange(60).astype(code)
            content = files.tdms_segment(self.objects(values), chunks=3)
            content += files.tdms_segment({self.X: (values, {})}, new_list=False, same=True, chunks=3)
            columns, metadata, _ = self.read(content)
            self.same(columns["accel_x_m_per_s2"], numpy.tile(values.astype(float), 2) * 9.80665)
            self.assertEqual(metadata["sample_rate_hz"], "25600")
        two = {**self.objects(numpy.arange(5.0)), "/'m'/'y'": (numpy.arange(5.0) + 10, {})}
        columns, _, _ = self.read(files.tdms_segment(two, interleaved=True))
        self.same(columns["accel_x_m_per_s2"], numpy.arange(5) * 9.80665)
        self.assertIn("operator = bench 3", self.preview(self.folder / "a.tdms"))

    def test_scales_of_the_writer(self):
        scale = {"NI_Scaling_Status": "unscaled", "NI_Number_Of_Scales": 1, "NI_Scale[0]_Scale_Type": "Linear",
                 "NI_Scale[0]_Linear_Slope": 0.5, "NI_Scale[0]_Linear_Y_Intercept": 2.0}
        values = numpy.arange(6).astype("<i2")
        columns, _, _ = self.read(files.tdms_segment(self.objects(values, **scale)))
        self.same(columns["accel_x_m_per_s2"], (0.5 * values + 2) * 9.80665)

    def test_an_unfinished_segment_is_never_filled_up(self):
        content = files.tdms_segment(self.objects(numpy.arange(40.0)), chunks=4, unfinished=True)
        columns, _, told = self.read(content[:-30])
        self.same(columns["accel_x_m_per_s2"], numpy.arange(30) * 9.80665)
        self.assertTrue(any("was not finished by its writer" in line for line in told), told)

    def test_what_is_refused(self):
        mapping = self.map({"accel_x_m_per_s2": {"from": "m/x"}})
        whole = files.tdms_segment(self.objects(numpy.arange(40.0)))
        cut = self.write("a.tdms", whole + whole[:-10])
        self.assertEqual(self.refused(cut, "--map", mapping),
                         f"a.tdms: byte {len(whole) + 28}: error: the file is cut off within segment 2; 40 values of each channel "
                         "before it are whole (expected a whole file)")
        daqmx = self.write("a.tdms", files.tdms_segment(self.objects(numpy.arange(4).astype("<i2")), daqmx=True))
        self.assertIn("error: the values are raw DAQmx data, whose scaling is not published (expected plain values: export them "
                      "with DIAdem or LabVIEW, or record without raw DAQmx data)", self.refused(daqmx, "--map", mapping))


class Audio(Import):
    def test_whole_numbers_are_shares_of_full_scale(self):
        path = self.folder / "a.wav"
        values = (self.random.standard_normal((300, 2)) * 3000).astype("<i2")
        with wave.open(str(path), "wb") as file:
            file.setnchannels(2), file.setsampwidth(2), file.setframerate(48000)
            file.writeframes(values.tobytes())
        mapping = self.map({"accel_x_m_per_s2": {"from": "2", "unit": "m/s^2", "factor": 50}})
        columns, metadata, told = self.convert(path, "--map", mapping)
        self.same(columns["accel_x_m_per_s2"], values[:, 1] / 32768 * 50)
        self.assertEqual(metadata["sample_rate_hz"], "48000")
        path.write_bytes(path.read_bytes()[:-100])
        self.assertEqual(self.refused(path, "--map", mapping),
                         "a.wav: byte 36: error: the file is cut off: 1100 of 1200 bytes of samples are there (expected a whole file)")

    def test_flac_has_the_same_values_without_loss(self):
        values = (self.random.standard_normal((9000, 2)) * 1e6).astype("<i4")
        path = files.flac(self.folder / "a.flac", values, 48000)
        mapping = self.map({"accel_x_m_per_s2": {"from": "1", "unit": "m/s^2", "factor": 50}})
        columns, metadata, _ = self.convert(path, "--map", mapping)
        self.same(columns["accel_x_m_per_s2"], values[:, 0] / 2**23 * 50)
        self.assertEqual(metadata["sample_rate_hz"], "48000")
        self.assertEqual(self.preview(path)[0], "FLAC: whole numbers; full scale is 1")
        path.write_bytes(path.read_bytes()[:9000])
        self.assertRegex(self.refused(path, "--map", mapping),
                         r"^a.flac: error: the file is cut off: \d+ of 9000 samples are there \(expected a whole file\)$")


class Csv(Import):
    LOOP = [(0.0, 1.5, 0.25), (0.01, -2.125, 0.5), (0.02, 1000.5, -0.75)]

    def read(self, text, time="Time", torque="Torque", angle="Angle", **sources):
        mapping = self.map({"torque_Nm": {"from": torque} | sources.get("torque_more", {}),
                            "output_angle_deg": {"from": angle} | sources.get("angle_more", {})}, "hysteresis",
                           time={"column": time} | sources.get("time_more", {}))
        return self.convert(self.write("a.csv", text), "--map", mapping)

    def check(self, columns, time_s=(0.0, 0.01, 0.02)):
        self.same(columns["time_s"], time_s)
        self.same(columns["torque_Nm"], [row[1] for row in self.LOOP])
        self.same(columns["output_angle_deg"], [row[2] for row in self.LOOP])

    def test_dialects(self):
        for separator in (";", "\t", ",", "|", "  "):
            for comma in (False, True):
                if comma and separator == ",":
                    continue
                for head in ("", "Bench 3\nOperator: me\n", "\ufeff"):
                    for end in ("\n", "\r\n"):
                        names = ["Time", "Torque", "Angle"]
                        rows = [separator.join(names)]
                        rows += [separator.join(f"{v:.4f}" for v in row) for row in self.LOOP]
                        text = end.join(rows).replace(".", "," if comma else ".") + end
                        with self.subTest(separator=separator, comma=comma, head=head, end=end):
                            columns, _, _ = self.read(head + text)
                            self.check(columns)

    def test_units_in_brackets_in_a_row_or_in_the_map(self):
        rows = "".join(f"{t * 1000};{1000 * m};{a * 60}\n" for t, m, a in self.LOOP)
        columns, _, told = self.read("Time [ms];Torque (mNm);Angle [arcmin]\n" + rows)
        self.check(columns)
        self.assertEqual([line for line in told if "metadata t" not in line], [])
        self.check(self.read("Time;Torque;Angle\nms;mNm;arcmin\n" + rows)[0])
        columns, _, told = self.read("Time [s];Torque;Angle\n" + rows, time_more={"unit": "ms"}, torque_more={"unit": "mNm"},
                                     angle_more={"unit": "arcmin"})
        self.check(columns)
        self.assertEqual(told[:1], ["'Time [s]' is in s by the file and in ms by the map, which counts"])
        # As data frames are written: their row labels have no name.
        tabs = "".join(f"{row}\t{t}\t{m}\t{a}\n" for row, (t, m, a) in enumerate(self.LOOP))
        self.check(self.read("\tTime [s]\tTorque [Nm]\tAngle [deg]\n" + tabs, time="Time", torque="Torque", angle="Angle")[0])

    def test_no_header_times_of_day_and_sep(self):
        rows = "".join(f"12:00:{t:06.3f};{m};{a};\n" for t, m, a in self.LOOP)
        columns, _, _ = self.read("sep=;\n" + rows, time="column 1", torque="column 2", angle="column 3")
        self.check(columns, (43200.0, 43200.01, 43200.02))
        night = "".join(f"{t};{m};{a}\n" for t, (_, m, a) in zip(("23:59:59.5", "23:59:59.9", "00:00:00.4"), self.LOOP, strict=True))
        columns, _, _ = self.read("Time;Torque;Angle\n" + night)
        self.same(numpy.array(columns["time_s"], float) - 86399.5, [0, 0.4, 0.9], 1e-9)
        dated = "".join(f'"2026/11/29 12:00:{t:06.3f}",{m},{a}\n' for t, m, a in self.LOOP)  # as Gnumeric writes it
        columns, _, _ = self.read("Time,Torque,Angle\n" + dated)
        self.same(columns["time_s"], [0, 0.01, 0.02], 1e-6)
        self.same(columns["torque_Nm"], [row[1] for row in self.LOOP])

    def test_two_readings_are_refused_with_both(self):
        mapping = self.map({"accel_x_m_per_s2": {"from": "column 1"}}, rate="1 kHz")
        self.assertEqual(
            self.refused(self.write("a.csv", "1,5\n2,5\n3,5\n"), "--map", mapping),
            "a.csv:1:1: error: '1,5' can be read in two ways, semicolons between the cells and decimal commas: 1.5, or commas "
            "between the cells and decimal points: 1 | 5 (expected a header with a name for each cell, or a first line such as sep=;)")
        self.assertIn("has a sign between thousands", self.refused(self.write("a.csv", "t;x\n1;1.234,5\n2;2.345,5\n"), "--map", mapping))

    def test_a_cell_that_is_none_is_told_where_it_is_needed(self):
        text = "Time;Torque;Angle;Spare\n0;1;2;\n1;;2;5\n2;1;2;6\n"
        mapping = self.map({"torque_Nm": {"from": "Torque"}, "output_angle_deg": {"from": "Angle"}}, "hysteresis", {"column": "Time"})
        self.assertEqual(self.refused(self.write("a.csv", text), "--map", mapping),
                         "a.csv:3:3: error: '' is no number (expected a value in every row of 'Torque')")
        text = text.replace("1;;2;5", "1;1;2;5")
        code, _, told = run("convert", self.write("a.csv", text), "--map", mapping, "--out", self.folder / "o.csv")
        self.assertEqual(code, 0, told)
        self.assertEqual(self.refused(self.write("a.csv", text + "3;1\n"), "--map", mapping),
                         "a.csv:5:1: error: the line has 2 cells (expected 4, as line 2 has)")

    def test_directions_in_their_words(self):
        for cw, ccw in (("cw", "ccw"), ("CW", "CCW"), ("forward", "backward"), ("1", "-1"), ("+1", "-1")):
            text = "way;in;out\n" + f"{cw};0;0\n{ccw};90;-1\n"
            mapping = self.map({"direction": {"from": "way"}, "input_angle_deg": {"from": "in"}, "output_angle_deg": {"from": "out"}},
                               "transmission_error")
            columns, _, _ = self.convert(self.write("a.csv", text), "--map", mapping)
            self.assertEqual(columns["direction"], ["cw", "ccw"])


class Map(Import):
    def refuse(self, *arguments, text="x,x [g],y\n1,2,3\n2,3,4\n", **rest):
        return self.refused(self.write("a.csv", text), "--map", self.map(*arguments, **rest))

    def test_messages(self):
        self.assertEqual(self.refuse({"accel_x_m_per_s2": {"from": "z"}}, rate="1 kHz"),
                         "map.yaml:5:3: error: 'z' is no channel of a.csv (expected one of x, x [g], y)")
        self.assertEqual(self.refuse({"accel_x_m_per_s2": {"from": "y", "unit": "mm"}}, rate="1 kHz"),
                         "map.yaml:5:3: error: the unit of 'y', 'mm', does not fit accel_x_m_per_s2 (expected m/s^2, g, mm/s^2, mg)")
        self.assertEqual(self.refuse({"accel_x_m_per_s2": {"from": "y"}}, text="y [g],y (g)\n1,2\n3,4\n", rate="1 kHz"),
                         "map.yaml:5:3: error: 'y' names two channels of a.csv, 'y [g]' and 'y (g)' (expected the whole name of one)")
        self.assertIn("neither column 'time_s' nor metadata 'sample_rate_hz' is there", self.refuse({"accel_x_m_per_s2": {"from": "y"}}))

    def test_a_file_of_others_without_a_map_says_how_to_write_one(self):
        path = files.mat5(self.folder / "a.mat", {"x": numpy.arange(9.0)})
        self.assertEqual(self.refused(path),
                         "a.mat: error: is MAT 5, which does not say what its series mean (expected --map FILE; strainwave convert "
                         "a.mat --preview shows what is in it)")


class Hdf5(Import):
    def test_datasets_and_tables_of_others(self):
        path = self.folder / "a.h5"
        with h5py.File(path, "w") as file:
            file["run/acc"] = numpy.arange(20.0)
            file["run/acc"].attrs["units"] = "g"
            file["both"] = numpy.arange(40.0).reshape(20, 2)
            file["table"] = numpy.array([(1.0, i) for i in range(20)], dtype=[("a", "f8"), ("b", "i4")])
        for name, values, unit in (("run/acc", numpy.arange(20) * 9.80665, None), ("both[:,1]", numpy.arange(1, 40, 2), "m/s^2"),
                                   ("table.b", numpy.arange(20), "m/s^2")):
            mapping = self.map({"accel_x_m_per_s2": {"from": name} | ({"unit": unit} if unit else {})}, rate="1 kHz")
            columns, _, _ = self.convert(path, "--map", mapping)
            self.same(columns["accel_x_m_per_s2"], values)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
