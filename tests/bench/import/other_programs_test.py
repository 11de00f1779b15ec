#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The rows of docs/files-of-others.md: what other programs write of one loop is read as the numbers that they had. A program
that is not installed is skipped, with a word.

usage: other_programs_test.py PROGRAM     exit code 77: skipped, there is no NumPy or h5py"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import needed  # noqa: E402

with needed.peers():
    import h5py
    import numpy

PROGRAM = ""
RATE_HZ, ROWS = 1000, 400
TIME_S = numpy.arange(ROWS) / RATE_HZ
TORQUE_NM = 34 * numpy.sin(2 * numpy.pi * TIME_S / 0.4) + 0.1 * numpy.cos(70 * TIME_S)
ANGLE_DEG = 0.02 * TORQUE_NM + 0.001
PYTHON = """import numpy
import sys
time, torque, angle = numpy.loadtxt(sys.argv[1], unpack=True)
"""
# Program, module or library of it, file, what it runs, names of time, torque and angle. {loop}: the numbers as a text.
BY_TIME = [
    ("python3", "pandas", "comma.csv", 'd.to_csv("comma.csv", index=False)', "Time [s]", "Torque [Nm]", "Angle [deg]"),
    ("python3", "pandas", "decimal.csv", 'd.to_csv("decimal.csv", sep=";", decimal=",")', "Time [s]", "Torque [Nm]", "Angle [deg]"),
    ("python3", "pandas", "labels.txt", 'd.to_csv("labels.txt", sep="\\t")', "Time [s]", "Torque [Nm]", "Angle [deg]"),
    ("python3", "scipy.io", "plain.mat", 'scipy.io.savemat("plain.mat", {"t": time, "q": torque, "a": angle})', "t", "q", "a"),
    ("python3", "scipy.io", "matrix.mat", 'scipy.io.savemat("matrix.mat", {"m": numpy.stack([time, torque, angle], 1)}, '
     'do_compression=True)', "m(:,1)", "m(:,2)", "m(:,3)"),
    ("python3", "tables", "tables.h5", 'f = tables.open_file("tables.h5", "w"); f.create_table("/", "log", obj=numpy.rec.fromarrays('
     '[time, torque, angle], names="t,q,a")); f.close()', "log.t", "log.q", "log.a"),
    ("python3", "xarray", "xarray.nc", 'xarray.Dataset({"q": ("t", torque), "a": ("t", angle)}, {"t": time}).to_netcdf('
     '"xarray.nc", engine="h5netcdf")', "t", "q", "a"),
    ("octave-cli", "", "octave.mat", 'save("-v7", "octave.mat", "t", "q", "a")', "t", "q", "a"),
    ("octave-cli", "", "octave.h5", 'save("-hdf5", "octave.h5", "t", "q", "a")', "t/value[0,:]", "q/value[0,:]", "a/value[0,:]"),
    ("octave-cli", "", "octave.csv", 'dlmwrite("octave.csv", m, "precision", 17)', "column 1", "column 2", "column 3"),
    ("Rscript", "utils", "csv2.csv", 'write.csv2(d, "csv2.csv")', "t", "q", "a"),
    ("Rscript", "hdf5r", "hdf5r.h5", 'f <- H5File$new("hdf5r.h5", "w"); for (n in names(d)) f[[n]] <- d[[n]]; f$close_all()',
     "t", "q", "a"),
    ("Rscript", "rhdf5", "rhdf5.h5", 'h5createFile("rhdf5.h5"); h5write(d, "rhdf5.h5", "d")', "d.t", "d.q", "d.a"),
    ("mlr", "", "miller.tsv", "mlr --icsv --otsv cat loop.csv > miller.tsv", "t", "q", "a"),
    ("ssconvert", "", "gnumeric.csv", "ssconvert loop.csv gnumeric.csv", "t", "q", "a"),
    ("sqlite3", "", "sqlite.csv", 'sqlite3 :memory: -cmd ".mode csv" -cmd ".import loop.csv d" -cmd ".headers on" '
     '"SELECT * FROM d" > sqlite.csv', "t", "q", "a")]
# The same of one series of sound, in shares of full scale, which is 50 Nm; bits that are kept.
BY_RATE = [("python3", "scipy.io.wavfile", "scipy.wav", 'scipy.io.wavfile.write("scipy.wav", 1000, torque)', None),
           ("python3", "soundfile", "soundfile.flac", 'soundfile.write("soundfile.flac", torque / 50, 1000, "PCM_24")', 24),
           ("octave-cli", "", "octave.wav", 'audiowrite("octave.wav", q / 50, 8000, "BitsPerSample", 24)', 24),
           ("sox", "", "sox.wav", "sox plain.wav -b 24 sox.wav", 16),
           ("flac", "", "flac.flac", "flac -s -f plain.wav -o flac.flac", 16),
           ("ffmpeg", "", "ffmpeg.flac", "ffmpeg -loglevel error -y -i plain.wav ffmpeg.flac", 16)]


class OtherPrograms(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        loop = numpy.stack([TIME_S, TORQUE_NM, ANGLE_DEG], 1)
        numpy.savetxt(cls.folder / "loop.txt", loop, fmt="%.17g")
        numpy.savetxt(cls.folder / "loop.csv", loop, fmt="%.17g", delimiter=",", header="t,q,a", comments="")
        samples = numpy.round(TORQUE_NM / 50 * 32768).astype("<i2").tobytes()
        head = b"RIFF" + (36 + len(samples)).to_bytes(4, "little") + b"WAVEfmt " + bytes.fromhex("10000000 0100 0100")
        head += RATE_HZ.to_bytes(4, "little") + (2 * RATE_HZ).to_bytes(4, "little") + bytes.fromhex("0200 1000") + b"data"
        (cls.folder / "plain.wav").write_bytes(head + len(samples).to_bytes(4, "little") + samples)

    def write(self, program, module, script):
        if not shutil.which(program, path="/usr/bin"):
            self.skipTest(f"there is no {program}")
        here = {"python3": PYTHON + (f"import {module}\n" if module else ""),
                "Rscript": f'library({module}); d <- read.table("loop.txt", col.names = c("t", "q", "a"))\n',
                "octave-cli": 'm = load("loop.txt"); t = m(:,1); q = m(:,2); a = m(:,3);\n'}
        if module == "pandas":
            here["python3"] += 'd = pandas.DataFrame({"Time [s]": time, "Torque [Nm]": torque, "Angle [deg]": angle})\n'
        command = {"python3": ["/usr/bin/python3", "-W", "ignore", "-c", here["python3"] + script, "loop.txt"],
                   "Rscript": ["Rscript", "--vanilla", "-e", here["Rscript"] + script],
                   "octave-cli": ["octave-cli", "--no-init-file", "--eval", here["octave-cli"] + script]}
        done = subprocess.run(command.get(program, ["sh", "-ec", script]), cwd=self.folder, capture_output=True, text=True,
                              check=False, env={"PATH": "/usr/bin:/bin", "HOME": str(self.folder), "LC_ALL": "C.UTF-8"})
        if done.returncode != 0 and module and ("No module named" in done.stderr or "there is no package" in done.stderr):
            self.skipTest(f"{program} has no {module}")
        self.assertEqual(done.returncode, 0, done.stderr)

    def read(self, file, text):
        (self.folder / "map.yaml").write_text(text)
        out = self.folder / "out.h5"
        out.unlink(missing_ok=True)
        done = subprocess.run([PROGRAM, "convert", self.folder / file, "--map", self.folder / "map.yaml", "--out", out, "--json"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(out) as record:
            columns = {}
            record.visititems(lambda name, item: columns.update({name.split("/")[-1]: item[:]})
                              if isinstance(item, h5py.Dataset) else None)
        return columns

    def test_loops(self):
        for program, module, file, script, time, torque, angle in BY_TIME:
            with self.subTest(file):
                self.write(program, module, script)
                unit = "" if "[" in torque and torque.endswith("]") and "," not in torque else ", unit: {}"
                columns = self.read(file, f"map: 1\nkind: hysteresis\ntime: {{column: {json.dumps(time)}{unit.format('s')}}}\ncolumns:\n"
                                          f"  torque_Nm: {{from: {json.dumps(torque)}{unit.format('Nm')}}}\n"
                                          f"  output_angle_deg: {{from: {json.dumps(angle)}{unit.format('deg')}}}\n"
                                          "metadata: {t1_Nm: 7, t2_Nm: 25, t3_Nm: 34}\n")
                # Some write 15 digits.
                numpy.testing.assert_allclose(columns["torque_Nm"], TORQUE_NM, rtol=1e-14, atol=1e-13)
                numpy.testing.assert_allclose(columns["output_angle_deg"], ANGLE_DEG, rtol=1e-14, atol=1e-13)

    def test_sound(self):
        for program, module, file, script, bits in BY_RATE:
            with self.subTest(file):
                self.write(program, module, script)
                columns = self.read(file, "map: 1\nkind: vibration\ncolumns:\n  accel_x_m_per_s2: {from: '1', unit: m/s2, factor: "
                                          f"{50 if bits else 1}}}\n")
                step = 50 / 2**(bits - 1) if bits else 0
                numpy.testing.assert_allclose(columns["accel_x_m_per_s2"], TORQUE_NM, rtol=1e-14, atol=1.01 * step)


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
