#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The program as installed: `cmake --install` into a folder of its own, and everything beside it is found.

  tests/packaging/install_test.py CMAKE BUILD
"""
import json
import os
import pathlib
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD = sys.argv[1], pathlib.Path(sys.argv[2])
del sys.argv[1:3]
CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
LISTED = re.compile(r"^  ([a-z-]+) .*", re.M)
USER = """#include <stdio.h>
#include <strainwave_predictor.h>
int main(void) {
  char error[256];
  return strainwave_predictor_open("nothing", error, sizeof error) == NULL ? puts(error) < 0 : 1;
}
"""


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        root = pathlib.Path(cls.folder.name)
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", root / "first"], check=True, stdout=subprocess.DEVNULL)
        # Moved as a whole: nothing keeps where it was installed.
        cls.prefix = (root / "first").rename(root / "moved")
        cls.program = cls.prefix / "bin/strainwave"
        cls.data = cls.prefix / "share/strainwave"
        cls.libraries = next(cls.prefix.glob("lib/**/libstrainwave_predictor.so")).parent
        cls.home = root / "home"
        cls.home.mkdir()

    def run_it(self, *command, code=0, **environment):
        done = subprocess.run([str(word) for word in command], cwd=self.home, stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, check=False, env={**os.environ, **environment})
        self.assertEqual(done.returncode, code, f"{command}\n{done.stdout}{done.stderr}")
        return done

    def commands(self, *of):
        return LISTED.findall(self.run_it(self.program, *of, "--help").stdout.split("\nSubcommands:\n")[1])

    def test_unit_of_a_service_is_hardened(self):
        unit = self.prefix / "lib/systemd/system/strainwave@.service"
        self.assertIn("\nUser=strainwave\n", unit.read_text())
        self.assertTrue((self.prefix / "lib/sysusers.d/strainwave.conf").exists())
        if not shutil.which("systemd-analyze"):
            self.skipTest("skipped, because systemd-analyze is missing")
        self.run_it("systemd-analyze", "security", "--no-pager", "--offline=true", "--threshold=20", unit)

    def test_version_stands_alone(self):
        said = self.run_it(self.program, "--version").stdout
        self.assertRegex(said, r"^strainwave \d+\.\d+\.\d+( \([0-9a-f]{7,}(-dirty)?\))?\n$")
        self.assertEqual(self.run_it(self.prefix / "bin/strainwave-devices", "--version").stdout, said)
        for words in (["--version", "--version"], ["--version", "validate"], ["run", "x.yaml", "--version"],
                      ["--version=1"], ["--version", "--"]):
            done = self.run_it(self.program, *words, code=2)
            self.assertEqual(done.stderr, f"error: '{' '.join(words)}': --version stands beside something else "
                                          "(expected 'strainwave --version' alone)\n")
            self.assertEqual(done.stdout, "")
        file = self.run_it(self.program, "validate", "--", "--version", code=2).stderr
        self.assertTrue(file.startswith("--version:"), file)

    def test_every_file_says_which_program_has_written_it(self):
        software = self.run_it(self.program, "--version").stdout.strip()
        self.run_it(self.program, "simulate", "transmission_error", "--out", "sweep.h5")
        said = self.run_it("/usr/bin/python3", "-c", "import h5py; print(h5py.File('sweep.h5').attrs['software'].decode())")
        self.assertEqual(said.stdout.strip(), software)
        diagnosis = self.run_it(self.program, "diagnose", "sweep.h5", "--json").stdout
        self.assertEqual(json.loads(diagnosis)["software"], software)

    def test_every_start_of_a_campaign_is_of_a_program(self):
        software = self.run_it(self.program, "--version").stdout.strip()
        text = (CHECKOUT / "tests/simulation/small.yaml").read_text(encoding="utf-8")
        for cycles, more in ((1, ()), (2, ("--resume", "--extend"))):
            (self.home / "small.yaml").write_text(re.sub(r"(?m)^cycles: .*", f"cycles: {cycles}", text), encoding="utf-8")
            self.run_it(self.program, "run", "small.yaml", "--out", "small", *more)
            with sqlite3.connect(self.home / "small/campaign.db") as journal:
                events = journal.execute("SELECT text FROM events WHERE code = 'software'").fetchall()
            self.assertEqual(events, [(software,)] * cycles)

    def test_schedules_and_examples_are_there_and_find_their_files(self):
        schedules = sorted(self.data.glob("schedules/*.yaml"))
        self.assertEqual([file.name for file in schedules],
                         sorted(file.name for file in CHECKOUT.glob("schedules/*.yaml")))
        for schedule in schedules:
            self.assertIs(json.loads(self.run_it(self.program, "validate", schedule, "--json").stdout)["valid"], True)
        examples = sorted(self.data.glob("bench/examples/*.yaml"))
        self.assertEqual(len(examples), 2)
        for example in examples:
            self.run_it(self.program, "validate", self.data / "schedules/quick.yaml", "--bench", example)
        self.assertTrue((self.data / "bench/monitor/monitor.yaml").exists())
        self.assertTrue((self.data / "bench/notices/notices.yaml").exists())

    def test_devices_are_described_by_the_installed_profiles(self):
        broken = self.data / "bench/devices/profiles/broken.yaml"
        broken.write_text("hid_device: 2\n", encoding="utf-8")
        self.addCleanup(broken.unlink)
        self.assertIn(f"warning: {broken}:1:1: error: missing key 'device'", self.run_it(self.program, "devices", "--json").stderr)

    def test_the_camera_finds_its_module(self):
        # A test that takes pictures, in the program's place.
        taker = shutil.copy(BUILD / "tests/camera_test", self.prefix / "bin")
        one = "--gtest_filter=Cameras.GiveTheNextPictureOfASequenceForEachRequest"
        self.run_it(taker, one)
        module = self.libraries / "strainwave/strainwave_camera.so"
        aside = module.rename(module.with_suffix(".aside"))
        self.addCleanup(lambda: aside.rename(module))
        self.assertIn("the camera's module cannot be loaded (of the Debian package strainwave-camera, or of a build with "
                      f"libopencv-videoio-dev and libopencv-imgcodecs-dev): {module}: cannot open shared object file: No such file or directory",
                      self.run_it(taker, one, code=1).stdout)

    def test_a_program_in_c_is_built_by_pkg_config(self):
        (self.home / "user.c").write_text(USER, encoding="utf-8")
        flags = self.run_it("pkg-config", "--cflags", "--libs", "strainwave_predictor",
                            PKG_CONFIG_PATH=str(self.libraries / "pkgconfig")).stdout.split()
        self.run_it("cc", "-std=c99", "-Wall", "-Werror", "user.c", *flags, "-o", "by_pkg_config")
        said = self.run_it("./by_pkg_config", LD_LIBRARY_PATH=str(self.libraries)).stdout
        self.assertTrue(said.startswith("nothing"), said)

    def test_a_program_in_c_is_built_by_cmake(self):
        project = self.home / "project"
        project.mkdir()
        (project / "user.c").write_text(USER, encoding="utf-8")
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(user C)\nfind_package(strainwave_predictor 0.1 REQUIRED)\n"
            "add_executable(user user.c)\ntarget_link_libraries(user PRIVATE strainwave::predictor)\n", encoding="utf-8")
        self.run_it(CMAKE, "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}")
        self.run_it(CMAKE, "--build", project / "build")
        self.assertTrue(self.run_it(project / "build/user").stdout.startswith("nothing"))

    def test_the_manual_has_every_command(self):
        page = self.prefix / "share/man/man1/strainwave.1"
        section = page.read_text(encoding="utf-8").split("\n.SH COMMANDS\n")[1].split("\n.SH ")[0].split("\n.PP\n")[0]
        self.assertEqual([name.replace(r"\-", "-") for name in re.findall(r"^\.TP\n\.B (.*)$", section, re.M)], self.commands())
        below = re.findall(r"^\.B[R]? ([a-z\\-]+) ?[,.]$", section, re.M)
        self.assertEqual([name.replace("\\-", "-") for name in below], [*self.commands("bench"), *self.commands("central")])

    def called(self, *of):
        """Every command, with those of commands, as its words."""
        for command in self.commands(*of):
            words = (*of, command)
            yield words
            if "\nSubcommands:\n" in self.run_it(self.program, *words, "--help").stdout:
                yield from self.called(*words)

    def helps(self):
        """What each page was made of: file, and the help of its command or program."""
        for words in self.called():
            yield self.page("strainwave", *words), self.run_it(self.program, *words, "--help").stdout
        yield self.page("strainwave-devices"), self.run_it(self.prefix / "bin/strainwave-devices", "--help").stdout

    def page(self, *words):
        return self.prefix / "share/man/man1" / ("-".join(words) + ".1")

    def test_every_command_has_a_page(self):
        pages = {self.page("strainwave", *words).stem for words in self.called()}
        self.assertIn("strainwave-bench-jog", pages)
        self.assertEqual({file.stem for file in self.page().parent.iterdir()}, {"strainwave", *pages})
        seen = self.page("strainwave").read_text(encoding="utf-8").split("\n.SH SEE ALSO\n")[1].replace("\\", "")
        self.assertEqual(seen, ",\n".join(f".BR {page} (1)" for page in sorted(pages)) + "\n")

    def test_every_option_stands_in_its_page(self):
        for page, said in self.helps():
            names = re.findall(r"^  ((?:-\w,)?--[a-z-]+|[A-Z]+)", said, re.M)
            self.assertIn("-h,--help", names)
            set_bold = re.findall(r"^\\fB(.*)\\fR", page.read_text(encoding="utf-8").replace("\\-", "-"), re.M)
            self.assertEqual(set(names) - set(set_bold), set(), page)

    @unittest.skipUnless(shutil.which("man") and shutil.which("groff"), "needs man and groff, to show the pages")
    def test_man_shows_every_page_as_help_says_it_and_without_a_warning(self):
        shown = {}
        for page in sorted(self.page().parent.iterdir()):
            for locale in ("C", "C.UTF-8"):
                done = self.run_it("man", "--warnings", "-l", page, LC_ALL=locale, MANWIDTH="80")
                self.assertEqual(done.stderr, "", page)
            shown[page] = done.stdout.split()
        for page, said in self.helps():
            about, _, parts = said.replace("…", "...").partition("\nUsage: ")
            # A command's page has the examples of that command, not those of the commands below it.
            parts = re.sub(r"^ *Example: .*\n", "", parts.partition("\n\n")[2], flags=re.M)
            for row in re.sub("^Example: ", "", about, flags=re.M).splitlines() + parts.splitlines():
                if not re.fullmatch("([A-Z][a-z]+:)?", row):  # headings are others
                    self.assertIn(f" {' '.join(row.split())} ", f" {' '.join(shown[page])} ", page)

    def complete(self, *words):
        """What bash offers for the last of the words."""
        script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _strainwave; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        completions = self.prefix / "share/bash-completion/completions/strainwave"
        return self.run_it("bash", "-c", script, "bash", completions, *words,
                           PATH=f"{self.prefix}/bin:{os.environ['PATH']}").stdout.split()

    def test_bash_completes_commands_and_options(self):
        self.assertEqual(self.complete("strainwave", "dia"), ["diagnose"])
        self.assertEqual(self.complete("strainwave", ""), self.commands())
        self.assertEqual(self.complete("strainwave", "bench", "c"), ["check", "commission"])
        self.assertEqual(self.complete("strainwave", "bench", "jog", "--sp"), ["--speed"])
        self.assertEqual(self.complete("strainwave", "run", "s.yaml", "--accept-"), ["--accept-pause", "--accept-expired"])
        self.assertEqual(self.complete("strainwave", "--v"), ["--version"])
        self.assertEqual(self.complete("strainwave-devices", "--"), ["--help", "--ratio", "--period", "--version"])

    def test_bash_completes_files_where_no_command_is_due(self):
        for words in (["validate", ""], ["validate", "quick"], ["run", "s.yaml", "--out", ""]):
            self.assertEqual(self.complete("strainwave", *words), [])
        for name in ("strainwave", "strainwave-devices"):
            registered = self.run_it("bash", "-c", f'source "{self.prefix}/share/bash-completion/completions/{name}"; '
                                                   f"complete -p {name}").stdout
            self.assertEqual(registered, f"complete -o default -F _strainwave {name}\n")


if __name__ == "__main__":
    unittest.main()
