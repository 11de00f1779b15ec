#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave drive-profile`: what it takes from a maker's file, what it leaves open, and that the rest of the program
refuses the profile until a person has filled it in.

usage: drive_profile_command_test.py PROGRAM CHECKOUT"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM, CHECKOUT = "", pathlib.Path()
OPEN = ["units.counts_per_rev", "units.velocity_units_per_rpm", "units.acceleration_units_per_rpm_per_s", "units.rated_torque",
        "limits.speed", "limits.torque", "limits.acceleration", "limits.quick_stop_deceleration",
        "limits.following_error_window", "limits.following_error_time"]
# As in bench/devices/profiles/strainwave_drive.yaml, whose drive the file describes.
FILLED_IN = {"counts_per_rev": "65536", "velocity_units_per_rpm": "1092.2666666666667",
             "acceleration_units_per_rpm_per_s": "1092.2666666666667", "rated_torque": "2.39 Nm", "speed": "6000 rpm",
             "torque": "7.16 Nm", "acceleration": "5000 rad/s2", "quick_stop_deceleration": "5000 rad/s2",
             "following_error_window": "270 deg", "following_error_time": "50 ms"}


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def without(text, index):
    """The data sheet `text` without one object, its sub-objects; it stays in the list, which is noted."""
    return re.sub(rf"(?ms)^\[{index}(sub\w+)?\]\n.*?(?=^\[|\Z)", "", text)


def with_object(text, index, value, key="DefaultValue"):
    return without(text, index) + (f"\n[{index}]\nParameterName=x\nObjectType=0x7\nDataType=0x0007\nAccessType=rw\n"
                                   f"{key}={value}\nPDOMapping=0\n")


class DriveProfile(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        shutil.copytree(CHECKOUT / "bench/devices/profiles", self.folder / "devices/profiles")
        shutil.copytree(CHECKOUT / "bench/examples", self.folder / "examples")
        self.profiles = self.folder / "devices/profiles"
        self.sheet = (self.profiles / "strainwave_drive.eds").read_text(encoding="utf-8")

    def draft(self, text, name="x.eds"):
        """The report about a data sheet `text`, and the profile made of it."""
        (self.profiles / name).write_text(text, encoding="utf-8")
        code, said, told = run("drive-profile", self.profiles / name, "--json")
        self.assertEqual(code, 0, told)
        report = json.loads(said)
        report["warnings"] = [line for line in report["warnings"] if ": note: " not in line]
        return report, report["profile"]

    def validate(self):
        return run("validate", CHECKOUT / "schedules/quick.yaml", "--bench", self.folder / "examples/in_process.yaml")

    def test_a_draft_is_refused_by_line_and_key_until_it_is_filled_in(self):
        mine = self.profiles / "my_drive.yaml"
        code, said, told = run("drive-profile", self.profiles / "strainwave_drive.eds", "--out", mine)
        self.assertEqual((code, told), (0, ""))
        self.assertEqual(said, f"{mine}: 10 values to fill in: {', '.join(OPEN)}\n")
        text = mine.read_text(encoding="utf-8")
        bench = self.folder / "examples/in_process.yaml"
        bench.write_text(bench.read_text(encoding="utf-8").replace("strainwave_drive.yaml", "my_drive.yaml"), encoding="utf-8")
        code, _, told = self.validate()
        self.assertEqual(code, 2)
        expected = []
        for number, line in enumerate(text.splitlines(), 1):
            if found := re.match(r"( +(\w+): )to be filled in", line):
                expected.append(f"{bench.parent}/../devices/profiles/my_drive.yaml:{number}:{len(found[1]) + 1}: error: "
                                f"{found[2]} = to be filled in: not a number")
        refused = told.splitlines()
        self.assertEqual(len(refused), len(OPEN), told)
        for line, begin in zip(refused, expected, strict=True):
            self.assertTrue(line.startswith(begin), (line, begin))
        for key, value in FILLED_IN.items():
            text, count = re.subn(rf"(?m)^  {key}: to be filled in", f"  {key}: {value}", text)
            self.assertEqual(count, 1, key)
        mine.write_text(text, encoding="utf-8")
        code, _, told = self.validate()
        self.assertEqual(code, 0, told)

    def test_identity_and_modes_are_taken_and_their_source_is_said(self):
        report, profile = self.draft(self.sheet)
        self.assertEqual(report["to_fill_in"], OPEN)
        self.assertEqual(report["warnings"], [])
        self.assertRegex(profile, r"(?m)^  vendor: 0x00005357 +# of the file's \[DeviceInfo\]$")
        self.assertRegex(profile, r"(?m)^modes: \[csv, csp, cst\] +# 6502h is 0x3AD, the file's default; it has pp, pv, tq, homing, too$")
        self.assertRegex(profile, r"(?m)^  torque: to be filled in +# as in 2\.5 Nm; 6072h is 3000, the file's default; it takes 0 to 3000$")

    def test_a_drive_without_modes_and_identity(self):
        sheet = without(without(self.sheet, "6502"), "1018")
        report, profile = self.draft(re.sub(r"(?m)^(Vendor|Product|Revision)Number=.*\n", "", sheet))
        self.assertEqual(report["to_fill_in"], ["modes", *OPEN])
        self.assertRegex(profile, r"(?m)^  product: 0 +# any: the file does not say$")
        self.assertRegex(profile, r"(?m)^modes: \[to be filled in\] +# 6502h is not in the file$")
        code, _, told = run("drive-profile", self.profiles / "x.eds", "--out", self.profiles / "strainwave_drive.yaml")
        self.assertEqual(code, 2, told)
        (self.profiles / "strainwave_drive.yaml").write_text(profile, encoding="utf-8")
        code, _, told = self.validate()
        self.assertEqual(code, 2)
        self.assertIn("modes has to be filled in (expected some of pp, pv, tq, homing, csp, csv and cst)", told)

    def test_units_of_speed_are_taken_where_they_are_told_and_looked_for_in_the_drive(self):
        for number, speed, words in (("0x00B44700", "1", "10^0 rpm"), ("0xFDB44700", "1000", "10^-3 rpm"),
                                     ("0x00B40300", "0.016666666666666666", "10^0 turns/s")):
            _, profile = self.draft(with_object(self.sheet, "60A9", number))
            line = re.search(r"(?m)^  velocity_units_per_rpm: (\S+) +# (.*)$", profile)
            self.assertEqual(line.groups(), (speed, f"60A9h is {number}, the file's default, which is {words}"))
            self.assertIn(f"{{index: 0x60A9, subindex: 0, type: unsigned32, value: {int(number, 16)}, action: expect, "
                          "purpose: unit of speed}", profile)
        report, profile = self.draft(with_object(self.sheet, "60A9", "0x00B50300"))
        self.assertIn("units.velocity_units_per_rpm", report["to_fill_in"])
        _, profile = self.draft(with_object(self.sheet, "60AA", "0x00C00300"))
        self.assertRegex(profile, r"(?m)^  acceleration_units_per_rpm_per_s: 1 ")

    def test_what_belongs_to_one_motor_is_taken_from_a_dcf_alone(self):
        report, profile = self.draft(with_object(self.sheet, "6076", 1500, "ParameterValue"), "x.dcf")
        self.assertNotIn("units.rated_torque", report["to_fill_in"])
        self.assertRegex(profile, r"(?m)^  rated_torque: 1\.5 Nm +# 6076h is 1500, as the DCF sets it$")
        epos4 = with_object(self.sheet, "6076", 1500000, "ParameterValue").replace("VendorNumber=0x00005357", "VendorNumber=0xFB")
        _, profile = self.draft(epos4.replace("ProductName=Strainwave servo", "ProductName=EPOS4"), "x.dcf")
        self.assertRegex(profile, r"(?m)^  rated_torque: 1\.5 Nm ")
        self.assertRegex(profile, r"(?m)^  rated_torque_unit: uNm ")
        unscaled = without(without(self.sheet, "6091"), "6092")
        report, _ = self.draft(unscaled)
        self.assertIn("units.counts_per_rev", report["to_fill_in"])
        _, profile = self.draft(re.sub(r"(?s)(\[608Fsub1\].*?)DefaultValue=65536", r"\1ParameterValue=8192", unscaled), "x.dcf")
        self.assertRegex(profile, r"(?m)^  counts_per_rev: 8192 +# 608Fh:01 is 8192, as the DCF sets it$")
        self.assertIn("{index: 0x608F, subindex: 1, type: unsigned32, value: 8192, action: expect", profile)

    def test_what_the_drive_lacks_is_a_quirk_where_it_may_be_missing_and_else_told(self):
        report, profile = self.draft(without(self.sheet, "605D"))
        self.assertRegex(profile, r"(?m)^    - 0x605D +# halt option code$")
        self.assertEqual(report["warnings"], [])
        report, profile = self.draft(without(self.sheet, "1016"))
        said = ("1016h:01 (watch over the master's heartbeat) is not in the EDS: a drive without heartbeats (1016h, 1017h) cannot "
                "be watched")
        self.assertEqual(report["warnings"], [f"{self.profiles / 'x.eds'}:1:1: warning: {said}"])
        self.assertIn(f"\n#   1:1: {said}\n", profile)

    def test_what_does_not_fit_stands_at_its_value_by_line_and_column(self):
        odd = self.sheet
        for section, key, value in (("6085", "AccessType", "const"), ("6060", "DataType", "0x0003"), ("60FF", "PDOMapping", "0")):
            odd, count = re.subn(rf"(?ms)(^\[{section}\]\n[^\[]*?^{key}=)[^\n]*", rf"\g<1> {value}", odd)
            self.assertEqual(count, 1, section)

        def place(section, key):
            lines = odd.splitlines()
            number = next(i for i in range(lines.index(f"[{section}]"), len(lines)) if lines[i].startswith(key))
            return f"{self.profiles / 'x.eds'}:{number + 1}:{len(key) + 3}: warning: {section}h:00 "

        report, profile = self.draft(odd)
        for section, key in (("6085", "AccessType"), ("6060", "DataType"), ("60FF", "PDOMapping")):
            self.assertTrue(any(line.startswith(place(section, key)) for line in report["warnings"]), (section, report["warnings"]))
        self.assertTrue(all(re.search(r"x\.eds:\d+:\d+: warning: ", line) for line in report["warnings"]))
        # The profile of it is refused with the same places.
        mine = self.profiles / "strainwave_drive.yaml"
        profile = re.sub(r"(?m)^eds: .*$", "eds: x.eds", profile)  # it was written elsewhere
        for key, value in FILLED_IN.items():
            profile = re.sub(rf"(?m)^  {key}: to be filled in", f"  {key}: {value}", profile)
        mine.write_text(profile, encoding="utf-8")
        code, _, told = self.validate()
        self.assertEqual(code, 2)
        self.assertIn(place("6085", "AccessType").replace("warning: ", "").split("/")[-1], told)

    def test_a_drive_that_cannot_repeat_or_map_is_read(self):
        sheet = re.sub(r"(?ms)^\[1800sub5\]\n.*?(?=^\[)", "", self.sheet)
        self.assertNotEqual(sheet, self.sheet)
        report, profile = self.draft(re.sub(r"(?ms)(^\[603F\]\n.*?PDOMapping=)1", r"\g<1>0", sheet))
        self.assertEqual(report["warnings"], [])
        self.assertRegex(profile, r"(?m)^    - 0x603F +# error code in a PDO: emergency messages tell it alone$")
        self.assertRegex(profile, r"(?m)^  lacks_tpdo_event_timer: true +# 1800h:05: the statusword comes with SYNC$")

    def test_controlword_and_statusword_make_a_drive_whatever_the_device_type_says(self):
        report, _ = self.draft(self.sheet.replace("0x00020192", "0x92010200"))
        self.assertEqual(report["warnings"], [
            f"{self.profiles / 'x.eds'}:123:14: warning: 1000h tells a device of profile 512 (expected 402; where the drive itself "
            "tells it, too, quirks: {absent_objects: [0x1000]} in the profile)"])

    def test_an_option_code_that_the_drive_does_not_take_is_its_own(self):
        _, profile = self.draft(self.sheet)
        self.assertRegex(profile, r"(?m)^option_codes:\n  disable_operation: 0 +# 605Ch is 0, the file's default; the program's 1 is "
                                  r"outside the file's limits$")

    def test_names_that_are_no_plain_text(self):
        _, profile = self.draft(self.sheet.replace("VendorName=strainwave", 'VendorName=a: "b" # \\ ä'))
        self.assertIn('name: "a: \\"b\\" # \\\\ ?? Strainwave servo"\n', profile)

    def test_bad_input(self):
        def refused(said, *arguments):
            code, out, told = run("drive-profile", *arguments)
            self.assertEqual((code, out, told), (2, "", said + "\n"))
        none = self.folder / "none.eds"
        refused(f"{none}: error: cannot be read: No such file or directory (expected a CANopen data sheet file)", none)
        none.write_text("", encoding="utf-8")
        refused(f"{none}:1:1: error: no object is described (expected an electronic data sheet, as in CiA 306)", none)
        other = self.folder / "io.eds"
        other.write_text(without(self.sheet, "6040").replace("0x00020192", "0x000F0191"), encoding="utf-8")
        refused(f"{other}:123:14: error: 1000h tells a device of profile 401 (expected 402, a drive by CiA 402)", other)
        other.write_text(without(without(self.sheet, "6041"), "1000"), encoding="utf-8")
        refused(f"{other}:1:1: error: there is no controlword or no statusword (expected 6040h and 6041h, a drive by CiA 402)", other)
        sheet = self.profiles / "strainwave_drive.eds"
        there = self.profiles / "strainwave_drive.yaml"
        before = there.read_bytes()
        refused(f"{there}: error: is there already (expected a new name, since a profile is filled in by hand)",
                sheet, "--out", there)
        self.assertEqual(there.read_bytes(), before)


if __name__ == "__main__":
    PROGRAM, CHECKOUT = sys.argv.pop(1), pathlib.Path(sys.argv.pop(1))
    unittest.main()
