#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The Debian packages that CPack makes of a build, and that tests are no part of it.

  tests/packaging/packages_test.py CMAKE BUILD
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD = sys.argv[1], pathlib.Path(sys.argv[2])
del sys.argv[1:3]
CHECKOUT = pathlib.Path(__file__).resolve().parents[2]


def said_by(*command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        said_by("cpack", "-B", folder.name, cwd=BUILD)
        cls.packages = {said_by("dpkg-deb", "-f", package, "Package").strip(): package
                        for package in pathlib.Path(folder.name).glob("*.deb")}

    def field(self, package, name):
        return said_by("dpkg-deb", "-f", self.packages[package], name).strip()

    def needed(self, package):
        return [entry.split(" ")[0] for entry in self.field(package, "Depends").split(", ")]

    def files(self, package):
        rows = said_by("dpkg-deb", "--contents", self.packages[package]).splitlines()
        return {row.split()[5][1:] for row in rows if not row.startswith("d")}

    def test_are_these_four_with_what_belongs_to_each(self):
        libraries = "/usr/lib/" + said_by("dpkg-architecture", "-qDEB_HOST_MULTIARCH").strip()
        belongs = {
            "strainwave": ["/usr/bin/strainwave", "/usr/bin/strainwave-devices", "/usr/share/man/man1/strainwave.1",
                           "/usr/share/man/man1/strainwave-run.1", "/usr/share/man/man1/strainwave-bench-jog.1",
                           "/usr/share/strainwave/schedules/quick.yaml",
                           "/usr/share/bash-completion/completions/strainwave"],
            "strainwave-camera": [f"{libraries}/strainwave/strainwave_camera.so"],
            "libstrainwave-predictor0": [f"{libraries}/libstrainwave_predictor.so.0"],
            "libstrainwave-predictor-dev": [f"{libraries}/libstrainwave_predictor.so", "/usr/include/strainwave_predictor.h",
                                            f"{libraries}/pkgconfig/strainwave_predictor.pc",
                                            f"{libraries}/cmake/strainwave_predictor/strainwave_predictor-config.cmake"]}
        self.assertEqual(set(self.packages), set(belongs))
        seen = set()
        for package, expected in belongs.items():
            files = self.files(package)
            self.assertEqual(set(expected) - files, set(), package)
            self.assertIn(f"/usr/share/doc/{package}/copyright", files)
            self.assertEqual(files & seen, set(), "two packages have the same file")
            seen |= files
        self.assertEqual({file for file in seen if "gtest" in file or "/tests/" in file or file.endswith(".md")},
                         {f"/usr/share/doc/{package}/CHANGELOG.md" for package in belongs})

    def test_need_the_libraries_that_they_are_linked_with(self):
        program = self.needed("strainwave")
        self.assertIn("libc6", program)
        self.assertIn("libhdf5-103-1", program)
        # Those of video are many, and of the camera alone.
        self.assertFalse([name for name in program if "videoio" in name or "imgcodecs" in name])
        self.assertTrue([name for name in self.needed("strainwave-camera") if "videoio" in name])
        version = self.field("libstrainwave-predictor0", "Version")
        self.assertEqual(self.field("libstrainwave-predictor-dev", "Depends"), f"libstrainwave-predictor0 (= {version})")
        self.assertNotIn("libhdf5-103-1", self.needed("libstrainwave-predictor0"))

    def test_are_made_without_tests_too(self):
        with tempfile.TemporaryDirectory() as folder:
            said_by(CMAKE, "-S", CHECKOUT, "-B", folder, "-G", "Ninja", "-DBUILD_TESTING=OFF",
                    "-DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON", "-DCMAKE_DISABLE_FIND_PACKAGE_benchmark=ON")
            self.assertFalse((pathlib.Path(folder) / "CTestTestfile.cmake").exists())
            targets = said_by("ninja", "-C", folder, "-t", "targets", "all")
            for target in ("strainwave", "strainwave-devices", "libstrainwave_predictor.so", "install"):
                self.assertIn(f"\n{target}: ", targets)
            self.assertNotIn("_test: ", targets)


if __name__ == "__main__":
    unittest.main()
