#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The list of software that a build is made of, held against the built program itself.

usage: sbom_test.py BUILD"""
import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BUILD = pathlib.Path()
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "packaging" / "sbom.py"
SPECIFICATION = importlib.util.spec_from_file_location("sbom", SCRIPT)
sbom = importlib.util.module_from_spec(SPECIFICATION)
SPECIFICATION.loader.exec_module(sbom)


def run(*arguments):
    return subprocess.run(["/usr/bin/python3", "-B", SCRIPT, *map(str, arguments)], capture_output=True, text=True, check=False)


class Sbom(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.done = run(BUILD)
        cls.components = {one["name"]: one for one in json.loads(cls.done.stdout or "{}").get("components", [])}

    def test_nothing_is_linked_that_our_licence_does_not_allow(self):
        self.assertEqual((self.done.returncode, self.done.stderr), (0, ""))

    def test_every_library_that_the_program_asks_for_is_in_it(self):
        packages = {package.split(":")[0] for one in self.components.values() if one["bom-ref"].startswith("debian/")
                    for package in next(each["value"] for each in one["properties"] if each["name"] == "strainwave:packages").split()}
        asked = [line.split("[")[1].rstrip("]") for line in
                 subprocess.run(["readelf", "-d", BUILD / "strainwave"], capture_output=True, text=True, check=True).stdout.splitlines()
                 if "(NEEDED)" in line]
        self.assertGreater(len(asked), 20)
        # By the names of Debian's files, and not by where this machine has found them.
        for name in asked:
            owners = subprocess.run(["dpkg-query", "--search", f"*/{name}"], capture_output=True, text=True, check=True).stdout
            found = {word.strip().split(":")[0] for line in owners.splitlines() for word in line.split(": /")[0].split(",")}
            self.assertTrue(found & packages, name)

    def test_headers_and_what_is_part_of_the_program_are_in_it(self):
        for name, licence in (("eigen3", "MPL-2.0"), ("nlohmann-json3", "MIT"), ("cli11", "BSD-3-Clause"), ("uplot", "MIT"),
                              ("openssl", "Apache-2.0")):
            self.assertEqual(self.components[name]["licenses"], [{"license": {"id": licence}}])
        self.assertNotIn("googletest", self.components)  # of tests alone

    def test_versions_are_those_that_are_installed(self):
        for name, package in (("sqlite3", "libsqlite3-0"), ("eigen3", "libeigen3-dev")):
            version = subprocess.run(["dpkg-query", "--show", "--showformat=${source:Version}", package], capture_output=True,
                                     text=True, check=True).stdout
            self.assertEqual(self.components[name]["version"], version)
            self.assertEqual(self.components[name]["purl"], f"pkg:deb/debian/{name}@{version}?arch=source")

    def test_licences_that_would_bind_whoever_links_are_refused(self):
        for licence in ("GPL-2+", "GPL-3", "AGPL-3+", "GPL-2 or GPL-3", sbom.UNSTATED):
            self.assertTrue(sbom.is_refused("some", licence), licence)
        for licence in ("MIT", "LGPL-2.1+", "GPL-2+ or LGPL-2.1+", "GPL-3.0 or BSD-3-clause or HIDAPI"):
            self.assertFalse(sbom.is_refused("some", licence), licence)

    def test_a_folder_without_a_build_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run(folder)
        self.assertEqual((done.returncode, done.stderr), (1, f"sbom.py: error: {pathlib.Path(folder).resolve()} has no program strainwave "
                                                             "(expected the folder of a build: ./setup.sh build)\n"))


if __name__ == "__main__":
    BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
