#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files of 50 MB that nobody means well with, given to the command that reads their kind: each is refused with exit code
2 and a message that says what was expected, or read, with less than a minute of the processor and 2 GB of memory.

usage: tests/simulation/large_inputs_test.py build/strainwave [NAME...]   all cases, or those whose names begin so
"""
import os
import pathlib
import resource
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIZE = 50_000_000
MOST_PROCESSOR_S = 60
MOST_MEMORY_BYTES = 2 * 10**9
MOST_MESSAGE_BYTES = 200_000  # a thousand findings of 200 bytes
SMALL = 1_000_000  # of files that people write, above which they are refused by their size alone


class Content:
    """`begin`, as often `middle` as makes `size`, `end`. Written piece by piece: what this process holds would count as
    the program's."""

    def __init__(self, begin=b"", middle=b"", end=b"", size=SIZE):
        self.begin, self.middle, self.end, self.size = begin, middle, end, size

    def write(self, path):
        together = 10_000
        left = (self.size - len(self.begin) - len(self.end)) // max(1, len(self.middle)) if self.middle else 0
        with open(path, "wb") as file:
            file.write(self.begin)
            while left > 0:
                count = min(left, together)
                file.write(self.middle * count)
                left -= count
            file.write(self.end)


class Numbered(Content):
    """`begin`, then `middle` with a number from 0 for as long as it fits into `size`, `end`."""

    def write(self, path):
        with open(path, "wb") as file:
            file.write(self.begin)
            for i in range(self.size // len(self.middle % 99_999)):
                file.write(self.middle % i)
            file.write(self.end)


TEXTS = {
    "one_line": Content(middle=b"a"),
    "lines": Content(middle=b"a\n"),
    "nested_lists": Content(middle=b"["),
    "nested_maps": Content(middle=b'{"a":'),
    "keys": Content(middle=b"a: b\n"),
    "zeros": Content(middle=b"\0"),
    "digits": Content(b"x: ", b"1"),
}


def bomb():
    """Each list is the one before ten times."""
    text = b"a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
    for level in range(1, 12):
        text += b"a%d: &a%d [%s]\n" % (level, level, b", ".join([b"*a%d" % (level - 1)] * 10))
    return text


SMALL_YAML = {
    "references": Content(bomb()),
    "reference_to_itself": Content(b"a: &a [*a, *a]\n"),
    "nested_lists_in_1_MB": Content(middle=b"[", size=SMALL),
    "nested_maps_in_1_MB": Content(middle=b"{a: ", size=SMALL),
    "nested_blocks_in_1_MB": Content(middle=b"- ", size=SMALL),
    "keys_in_1_MB": Numbered(middle=b"k%06d: 1\n", size=SMALL),
    "one_line_in_1_MB": Content(middle=b"a", size=SMALL),
    "list_in_1_MB": Content(b"phases: [", b"1,", b"1]\n", size=SMALL),
    "anchors_in_1_MB": Numbered(middle=b"- &k%06d 1\n", size=SMALL),
}

JSON = {
    "nested": Content(b'{"format":', b"["),
    "nested_objects": Content(b'{"format":', b'{"a":'),
    "keys": Numbered(b'{"format":1', b',"k%07d":1', b"}"),
    "string": Content(b'{"format":"', b"a", b'"}'),
    "list": Content(b'{"format":[', b"1,", b"1]}"),
    "objects": Content(b'{"format":[', b'{"a":1},', b"1]}"),
}

CSV_HEAD = b"# kind: hysteresis\ntime_s,torque_Nm,output_angle_deg\n"
CSV = {
    "one_column": Content(b"time_s\n", b"1\n"),
    "columns": Content(b"# kind: hysteresis\n", b"a,", b"\n"),
    "metadata": Content(middle=b"# key: value\n"),
    "wrong_cells": Content(CSV_HEAD, b"x,y,z\n"),
    "same_rows": Content(CSV_HEAD, b"0,0,0\n"),
    "quotes": Content(CSV_HEAD, b'"'),
    "separators": Content(b"a,b\n", b";"),
    "empty_lines": Content(CSV_HEAD, b"\n"),
}

SIGNATURE = b"\x89HDF\r\n\x1a\n"
HDF5 = {"zeros_behind_signature": Content(SIGNATURE, b"\0"), "ones_behind_signature": Content(SIGNATURE, b"\xff")}


class Claiming:
    """An HDF5 file whose sets have no storage, and claim extents that no memory holds."""

    def __init__(self, *shape):
        self.shape = shape

    def write(self, path):
        import h5py

        with h5py.File(path, "w") as file:
            file.attrs["kind"] = "hysteresis"
            for column in ("time_s", "torque_Nm", "output_angle_deg"):
                file.create_dataset(column, shape=self.shape, dtype="f8", chunks=(16,) * len(self.shape))


def claiming():
    try:
        import h5py  # noqa: F401
    except ImportError:
        print("h5py is not there: no HDF5 file that claims huge extents")
        return {}
    return {"claims_2_to_60": Claiming(2**60), "claims_a_product_of_0": Claiming(2**33, 2**33), "claims_2_to_32": Claiming(2**32)}


MAT5 = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
TDMS = b"TDSm" + struct.pack("<IIQQ", 0x0E, 4713, SIZE - 28, SIZE - 28) + struct.pack("<I", 0xFFFFFFFF)
UFF = b"    -1\n    58\n"
WAV = b"RIFF\xff\xff\xff\xffWAVEfmt " + struct.pack("<IHHIIHH", 16, 1, 65535, 48000, 48000, 1, 8)
OTHERS = {
    "zeros.mat": Content(MAT5, b"\0"),
    "elements.mat": Content(MAT5, struct.pack("<II", 14, 0)),
    "claims.mat": Content(MAT5 + struct.pack("<II", 14, 0xFFFFFFF0), b"\0"),
    "objects.tdms": Content(TDMS, b"\0"),
    "segments.tdms": Content(middle=b"TDSm" + struct.pack("<IIQQ", 0, 4713, 0, 0)),
    "lines.uff": Content(UFF, b"NONE\n"),
    "one_line.uff": Content(UFF, b"1 "),
    "marks.uff": Content(middle=b"    -1\n"),
    "claims.wav": Content(WAV + b"data\xff\xff\xff\xff", b"\0"),
    "chunks.wav": Content(WAV, b"LIST\0\0\0\0"),
    "zeros.flac": Content(b"fLaC", b"\0"),
}

EDS = {
    "sections": Numbered(middle=b"[%x]\nParameterName=a\n"),
    "objects": Numbered(b"[MandatoryObjects]\nSupportedObjects=65535\n", b"%d=0x1000\n"),
    "one_value": Content(b"[FileInfo]\nFileName=", b"a"),
    "heads": Content(middle=b"[\n"),
    "sections_in_1_MB": Numbered(middle=b"[%x]\nParameterName=a\n", size=SMALL),
    "heads_in_1_MB": Content(middle=b"[\n", size=SMALL),
}

YAML_READERS = {
    "schedule": ["validate", "{}"],
    "bench_file": ["validate", str(ROOT / "schedules/quick.yaml"), "--bench", "{}"],
    "users": ["users", "{}"],
    "monitor_settings": ["monitor", "{folder}/model", "--simulate", "--settings", "{}"],
    "notices": ["watch", "{folder}/campaign", "--notices", "{}", "--dry-run"],
    "map": ["convert", "{folder}/small.csv", "--map", "{}", "--out", "{folder}/out.csv"],
    "extended_model": ["simulate", "{}", "--out", "{folder}/out.csv"],
}
RECORD_READERS = {"recompute": ["recompute", "{}"], "preview": ["convert", "{}", "--preview"], "diagnose": ["diagnose", "{}"]}
X = Content(b"x")


def cases():
    """(name, content of files below a folder, arguments); {} is the first of the files."""
    for reader, arguments in YAML_READERS.items():
        for name, content in {**TEXTS, **SMALL_YAML}.items():
            yield f"{reader}.{name}", {"any.yaml": content, "small.csv": Content(b"a,b\n1,2\n")}, arguments
    for reader, arguments in RECORD_READERS.items():
        for name, content in {**TEXTS, **CSV}.items():
            yield f"{reader}_csv.{name}", {"any.csv": content}, arguments
        for name, content in {**HDF5, **claiming()}.items():
            yield f"{reader}_hdf5.{name}", {"any.h5": content}, arguments
    for name, content in OTHERS.items():
        yield f"preview.{name}", {name: content}, ["convert", "{}", "--preview"]
    for name, content in {**TEXTS, **EDS}.items():
        yield f"eds.{name}", {"any.eds": content}, ["drive-profile", "{}"]
    for name, content in JSON.items():
        beside = {"numbers.h5": X, "a.csv": X}
        yield f"predictor.{name}", {"predictor.json": content, **beside}, ["predict", "{folder}", "{folder}/a.csv"]
        yield f"exported.{name}", {"recipe.json": content}, ["monitor", "{folder}", "--simulate"]
        yield f"health.{name}", {"health.json": content, **beside}, ["health", "whatif", "{folder}", "--state", "hd=0.5"]
        yield f"faults.{name}", {"faults.json": content, "predictor.json": content, **beside}, ["faults", "classify", "{folder}", "{folder}/a.csv"]
        yield f"fingerprint.{name}", {"fingerprint.json": content, **beside}, ["fingerprint", "classify", "{folder}", "{folder}/a.csv"]
    for name, content in TEXTS.items():
        yield f"labels.{name}", {"labels.csv": content}, ["health", "train", "{folder}", "--out", "{folder}/out"]
        yield f"campaign.{name}", {"schedule.yaml": content, "bench.yaml": content, "campaign.db": content}, ["status", "{folder}"]


def run(program, arguments, folder, file):
    """Exit code, messages, seconds of the processor, bytes of memory."""
    command = [str(program)] + [argument.format(file, folder=folder) for argument in arguments]

    def limits():
        resource.setrlimit(resource.RLIMIT_CPU, (MOST_PROCESSOR_S, MOST_PROCESSOR_S))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    with open(folder / "said", "wb") as said:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, preexec_fn=limits)
        _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    messages = (folder / "said").read_text(errors="replace")
    return process.returncode, messages, used.ru_utime + used.ru_stime, used.ru_maxrss * 1024


def complaint(name, code, messages, processor_s, memory_bytes):
    """What is wrong with an end, in words; empty: nothing."""
    # What the program itself has kept and cannot read any more is the disk's fault.
    if code not in ((2, 3) if name.startswith("campaign.") else (0, 2)):
        return f"exit code {code}"
    if code == 2 and ("error: " not in messages or "expected" not in messages):
        return "no message says what was expected"
    if len(messages) > MOST_MESSAGE_BYTES:
        return f"{len(messages)} bytes of messages"
    if processor_s > MOST_PROCESSOR_S:
        return "too long"
    return "too much memory" if memory_bytes > MOST_MEMORY_BYTES else ""


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    failures = []
    most_s, most_bytes, count = 0.0, 0, 0
    for name, files, arguments in cases():
        if len(sys.argv) > 2 and not any(name.startswith(begin) for begin in sys.argv[2:]):
            continue
        with tempfile.TemporaryDirectory() as made:
            folder = pathlib.Path(made)
            for path, content in files.items():
                content.write(folder / path)
            code, messages, processor_s, memory_bytes = run(program, arguments, folder, folder / next(iter(files)))
        wrong = complaint(name, code, messages, processor_s, memory_bytes)
        count += 1
        most_s, most_bytes = max(most_s, processor_s), max(most_bytes, memory_bytes)
        first = "".join(messages.replace(made + "/", "").splitlines()[:1])
        print(f"{name}: {code}, {processor_s:.1f} s, {memory_bytes / 1e6:.0f} MB: {wrong or 'as it should be'}: {first:.160}", flush=True)
        if wrong:
            failures.append(name)
    print(f"{count} inputs, at most {most_s:.1f} s of the processor and {most_bytes / 1e6:.0f} MB of memory")
    if failures or count == 0:
        sys.exit(f"{len(failures)} of {count} did not end as they should: {' '.join(failures)}")


if __name__ == "__main__":
    main()
