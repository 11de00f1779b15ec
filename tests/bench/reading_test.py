#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every block of docs/reading-our-files.md as it stands, on a campaign: it ends well and, where it says how large a torque
becomes, says the right one.

usage: reading_test.py PROGRAM CHECKOUT NPM_FOLDER     exit code 77: skipped, /usr/bin/python3 has no h5py"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import needed  # noqa: E402

with needed.peers():
    import h5py

BLOCK = re.compile(r"^```(\w+)(?: ([\w-]+))?\n(.*?)^```$", re.M | re.S)
PROGRAM, CHECKOUT, NPM = "", pathlib.Path(), pathlib.Path()


def missing(language, name):
    """What there is not of the program that the block needs; nothing where all is there."""
    if language == "python":
        return None if subprocess.run(["/usr/bin/python3", "-c", f"import {name}"], check=False, capture_output=True).returncode == 0 \
            else f"/usr/bin/python3 has no {name}"
    if language == "js":
        return None if (NPM / "node_modules" / name).exists() and shutil.which("node") else f"{NPM} has no {name}"
    program = {"r": "Rscript", "octave": "octave-cli"}.get(language) or name or "sh"
    if not shutil.which(program):
        return f"there is no {program}"
    if language == "r" and name and subprocess.run(["Rscript", "-e", f"library({name})"], check=False,
                                                   capture_output=True).returncode != 0:
        return f"R has no {name}"
    return None


class Reading(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = pathlib.Path(scratch.name)
        (cls.folder / "bin").mkdir()
        (cls.folder / "bin/strainwave").symlink_to(PROGRAM)
        (cls.folder / "node_modules").symlink_to(NPM / "node_modules")
        subprocess.run([PROGRAM, "run", CHECKOUT / "schedules/quick.yaml", "--out", cls.folder / "campaigns/first"], check=True,
                       capture_output=True)
        subprocess.run([PROGRAM, "table", cls.folder / "campaigns/first", "--out", cls.folder / "first.csv"], check=True,
                       capture_output=True)
        (cls.folder / "campaigns/first/can").mkdir()  # which a bench with CAN has
        (cls.folder / "campaigns/first/can/can0-20261129-120000-0001.log").write_text(
            "(1764417600.000001) can0 080#\n(1764417600.000420) can0 181#3704080000\n")
        with h5py.File(cls.folder / "campaigns/first/cycles/000001.h5") as file:
            cls.most_Nm = float(file["hysteresis/hysteresis_1/torque_Nm"][:].max())

    def run_block(self, language, name, script):
        absent = missing(language, name)
        if absent:
            print(f"skipped, because {absent}", file=sys.stderr)
            self.skipTest(absent)
        suffix = {"python": "py", "js": "mjs", "octave": "m", "r": "R", "sh": "sh"}[language]
        file = self.folder / f"block.{suffix}"
        file.write_text(script, encoding="utf-8")
        command = {"python": ["/usr/bin/python3", file], "js": ["node", file], "octave": ["octave-cli", "--no-init-file", file],
                   "r": ["Rscript", "--vanilla", file], "sh": ["sh", "-e", file]}[language]
        environment = os.environ | {"PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}", "QT_QPA_PLATFORM": "offscreen",
                                    "HOME": str(self.folder), "LC_ALL": "C.UTF-8"}
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False, env=environment)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        if "max(" in script:
            numbers = [float(word) for word in re.findall(r"\d+\.\d+", done.stdout)]
            self.assertTrue(any(abs(number - self.most_Nm) < 1e-3 for number in numbers), done.stdout)
        if "--png" in script or "Export(" in script:
            self.assertGreater((self.folder / "k2.png").stat().st_size, 10_000)
            (self.folder / "k2.png").unlink()
        else:
            self.assertTrue(done.stdout.strip(), script)

    def test_no_object_has_text_of_variable_length_or_more_than_eight_attributes(self):
        def look(name, item):
            self.assertLessEqual(len(item.attrs), 8, name)
            kinds = [item.attrs.get_id(attribute).dtype for attribute in item.attrs]
            for kind in kinds + ([item.dtype] if isinstance(item, h5py.Dataset) else []):
                text = h5py.check_string_dtype(kind)
                self.assertFalse(text and text.length is None, name)
        for path in sorted((self.folder / "campaigns/first/cycles").glob("*.h5")):
            with h5py.File(path) as file:
                look("/", file)
                file.visititems(look)


def add_blocks():
    text = (CHECKOUT / "docs/reading-our-files.md").read_text(encoding="utf-8")
    blocks = BLOCK.findall(text)
    assert len(blocks) > 8
    for number, (language, name, script) in enumerate(blocks):
        def test(self, language=language, name=name, script=script):
            self.run_block(language, name, script)
        setattr(Reading, f"test_block_{number:02}_{language}_{name.replace('-', '_')}", test)


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    CHECKOUT, NPM = pathlib.Path(sys.argv.pop(1)).resolve(), pathlib.Path(sys.argv.pop(1)).resolve()
    add_blocks()
    unittest.main()
