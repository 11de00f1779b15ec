#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Files that are damaged, far too large or nested: refused by name, in bounded time and memory.

usage: hostile_import_test.py PROGRAM     exit code 77: skipped, there is no NumPy or h5py"""
import pathlib
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import import_test  # noqa: E402
from import_test import Import, files, numpy  # noqa: E402


class Hostile(Import):
    MIB = 1 << 20

    def refused_in_bounds(self, path, *arguments):
        """The message, and that neither the program nor its reader took more than the file and 300 MiB."""
        program = ("import resource, subprocess, sys\ndone = subprocess.run(sys.argv[1:], capture_output=True, text=True)\n"
                   "print(done.returncode, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)\n"
                   "print(done.stderr, end='')")
        out = self.folder / "out.csv"
        done = subprocess.run([sys.executable, "-c", program, import_test.PROGRAM, "convert", path, "--out", out, *map(str, arguments)],
                              capture_output=True, text=True, check=True)
        first, _, told = done.stdout.partition("\n")
        code, peak = map(int, first.split())
        self.assertEqual(code, 2, told)
        self.assertFalse(out.exists())
        self.assertLess(peak, path.stat().st_size + 300 * self.MIB)
        return told.replace(str(self.folder) + "/", "").strip()

    def test_fifty_megabytes_in_one_line(self):
        mapping = self.map({"accel_x_m_per_s2": {"from": "a"}}, rate="1 kHz")
        for text, line, size in (("a,b\n1,2\n" + "3," * 25_000_000 + "\n", 3, 50_000_000), ("7" * 50_000_000, 1, 50_000_000),
                                 ("a;b\n" + "1;2\n" * 1000 + "8" * 50_000_000 + ";1\n", 1002, 50_000_002)):
            told = self.refused_in_bounds(self.write("a.csv", text), "--map", mapping)
            self.assertEqual(told, f"a.csv:{line}:1048577: error: the line has {size} bytes (expected lines of at most 1048576)")

    def test_structs_in_structs_and_sizes_that_no_file_holds(self):
        deep = numpy.arange(3.0)
        for _ in range(300):
            deep = {"s": deep}
        path = files.mat5(self.folder / "a.mat", {"x": deep})
        mapping = self.map({"accel_x_m_per_s2": {"from": "x"}}, rate="1 kHz")
        told = self.refused_in_bounds(path, "--map", mapping)
        self.assertRegex(told, r"^(map\.yaml:\d+:\d+|a\.mat): error: [^\n]{1,400}$")
        whole = files.mat5(self.folder / "a.mat", {"x": numpy.arange(400.0)}).read_bytes()
        huge = whole.replace(numpy.array([1, 400], "<i4").tobytes(), numpy.array([1, 400_000_000], "<i4").tobytes())
        self.assertNotEqual(huge, whole)
        told = self.refused_in_bounds(self.write("a.mat", huge), "--map", mapping)
        self.assertRegex(told, r"^a\.mat: error: [^\n]{1,400}$")

    def test_a_tdms_file_of_many_small_segments_takes_its_time_by_its_size(self):
        objects = {f"/'m'/'{c}'": (numpy.arange(2.0), {}) for c in range(300)}
        first = files.tdms_segment(objects)
        again = files.tdms_segment(objects, new_list=False, same=True)
        path = self.write("a.tdms", first + again * 300)
        columns, _, _ = self.convert(path, "--map", self.map({"accel_x_m_per_s2": {"from": "m/299", "unit": "g"}}, rate="1 kHz"))
        self.assertEqual(len(columns["accel_x_m_per_s2"]), 602)

    def test_chunks_whose_sizes_lead_nowhere_are_refused(self):
        mapping = self.map({"accel_x_m_per_s2": {"from": "1"}})
        head = b"RIFF\xff\xff\xff\xffWAVE"
        for size in (0xFFFFFFF7, 0xFFFFFFF8, 0xFFFFFFFF):  # what comes behind them lies before them in 32 bits
            path = self.write("a.wav", head + b"LIST" + size.to_bytes(4, "little") + bytes(16))
            self.assertRegex(self.refused(path, "--map", mapping), r"^a\.wav: error: cannot be read: [^\n]+ \(expected WAV or FLAC\)$")
        path = self.write("a.wav", head + b"LIST\0\0\0\0" * 10_001)
        self.assertEqual(self.refused(path, "--map", mapping),
                         "a.wav: byte 80012: error: 10000 chunks come before the samples (expected fewer of them, as recorders write)")


if __name__ == "__main__":
    import_test.PROGRAM = sys.argv.pop(1)
    unittest.main()
