#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""One function for each folder of measured records: reads the maker's files, yields records of ours.

README.md beside this file says where the records come from and why each scale is what it is.
"""
import io
import json
import lzma
import math
import pathlib
import re
import tarfile

import numpy

import mat5
from records import GRAVITY_M_PER_S2, Record

TORQUE_NM_PER_KIP = 10.0
TWIST_DEG_PER_INCH = 1.0


def friction_damper(folder):
    """Force over displacement of a rotary friction damper, scaled to torque over twist: not a gear."""
    for path in sorted(folder.glob("*/*/*.json")):
        rows = numpy.array(json.loads(path.read_text())["data"])
        torque_Nm = TORQUE_NM_PER_KIP * rows[:, 2]
        reached_Nm = min(torque_Nm.max(), -torque_Nm.min())
        dataset = path.relative_to(folder).parts[0]
        yield Record(
            f"{dataset}-{path.stem}",
            {"kind": "hysteresis",
             "t1_Nm": f"{0.2 * reached_Nm:.1f}", "t2_Nm": f"{0.7 * reached_Nm:.1f}", "t3_Nm": f"{reached_Nm:.1f}",
             "specimen": "banded rotary friction damper, not a gear",
             "scale": f"{TORQUE_NM_PER_KIP:g} Nm for 1 kip, {TWIST_DEG_PER_INCH:g} deg for 1 in"},
            {"time_s": rows[:, 0], "torque_Nm": torque_Nm, "output_angle_deg": TWIST_DEG_PER_INCH * rows[:, 1]})


def emps(folder):
    """Linear axis with a ball screw: position, and the drive's voltage as force."""
    for path in sorted(folder.glob("DATA_EMPS*.mat")):
        arrays = {name: values.ravel() for name, values in mat5.read(path).items()}
        columns = {"time_s": arrays["t"], "position_m": arrays["qm"], "reference_position_m": arrays["qg"],
                   "force_N": arrays["gtau"] * arrays["vir"]}
        if "pulses_N" in arrays:
            columns["pulses_N"] = arrays["pulses_N"]
        yield Record(path.stem.lower(), {"kind": "motion", "specimen": "EMPS linear axis"}, columns)


MAXON_NOMINAL_TORQUE_NM = 9.84e-3


def _read_epos(path):
    """(time_s, speed_rpm, torque_percent) of a CSV of EPOS Studio; the sampling period differs by file."""
    lines = path.read_text(encoding="latin-1").splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("ms;rpm;%")) + 1
    rows = []
    for line in lines[start:]:
        fields = line.split(";")
        if len(fields) < 3:
            continue
        # A remark in the last field names what an overwritten sample was.
        remark = re.search(r"was ([-0-9.]+)", fields[2])
        torque_percent = float(remark[1] if remark else fields[2].split(",")[0])
        rows.append((float(fields[0]) / 1000.0, float(fields[1]), torque_percent))
    return numpy.array(rows).T


def screw_worm(folder):
    """Two lead screws and a worm drive at some 110 constant speeds, and starting and stopping."""
    for path in sorted(folder.glob("driveNo*/**/*.csv")):
        time_s, speed_rpm, torque_percent = _read_epos(path)
        velocity_rad_per_s = speed_rpm * (math.pi / 30.0)
        steps_rad = 0.5 * (velocity_rad_per_s[1:] + velocity_rad_per_s[:-1]) * numpy.diff(time_s)
        drive, state = path.relative_to(folder).parts[:2]
        yield Record(
            f"{drive}-{state}-{path.stem}",
            {"kind": "motion", "specimen": drive, "position": "integral of the measured speed"},
            {"time_s": time_s, "position_rad": numpy.concatenate(([0.0], numpy.cumsum(steps_rad))),
             "velocity_rad_per_s": velocity_rad_per_s,
             "torque_Nm": torque_percent / 100.0 * MAXON_NOMINAL_TORQUE_NM})


# Nominal power and speed of the two motors, from the plates.
_PM_MOTORS = {"MS4887": (6000.0, 2000.0), "SDM251": (720.0, 3000.0)}


def pm_motor(folder):
    """Torque ripple of servo motors as motion, speed ripple as a vibration channel."""
    for path in sorted(folder.glob("**/*OFF*.txt")):
        power_W, nominal_rpm = next(plate for name, plate in _PM_MOTORS.items() if name in path.as_posix())
        time_s, values = numpy.loadtxt(path, skiprows=1, usecols=(0, 1)).T
        speed_rpm = float(re.search(r"(\d+)rpm", path.relative_to(folder).as_posix())[1])
        parts = path.relative_to(folder).with_suffix("").parts
        name = re.sub(r"[^\w.-]+", "_", "-".join(parts)).removesuffix(".Monitor")
        if "-torque" in path.as_posix():
            nominal_torque_Nm = power_W / (nominal_rpm * math.pi / 30.0)
            yield Record(
                name,
                {"kind": "motion", "specimen": parts[0], "position": "nominal speed times time, not measured",
                 "speed_rpm": speed_rpm},
                {"time_s": time_s, "position_rad": speed_rpm * (math.pi / 30.0) * time_s,
                 "torque_Nm": -values / 100.0 * nominal_torque_Nm})
        else:
            yield Record(
                name,
                {"kind": "vibration", "specimen": parts[0], "sample_rate_hz": 1000, "input_speed_rpm": speed_rpm},
                {"time_s": time_s, "speed_rad_per_s": values * nominal_rpm * (math.pi / 30.0)})


_CWRU_CLASSES = {"normal": "normal", "IR": "inner_race", "OR": "outer_race"}
_CWRU_CHANNELS = {"DE": "accel_x_m_per_s2", "FE": "accel_fan_end_m_per_s2", "BA": "accel_base_m_per_s2"}


def cwru(folder):
    """Bearings with seeded faults; the drive end is channel x."""
    for path in sorted(folder.glob("*.mat")):
        arrays = mat5.read(path)
        speed_rpm = next(values.item() for name, values in arrays.items() if name.endswith("RPM"))
        label = next(label for start, label in _CWRU_CLASSES.items() if path.stem.startswith(start))
        columns = {}
        for name, values in arrays.items():
            channel = re.search(r"_(DE|FE|BA)_time$", name)
            if channel:
                columns[_CWRU_CHANNELS[channel[1]]] = GRAVITY_M_PER_S2 * values.ravel()
        yield Record(
            path.stem,
            {"kind": "vibration", "sample_rate_hz": 48000 if label == "normal" else 12000,
             "input_speed_rpm": f"{speed_rpm:g}", "class": label},
            columns)


def femto(folder):
    """Every snapshot of a bearing's life, two accelerometers, in the order in which they were taken."""
    # Unpacked at once: going to and fro in a compressed archive unpacks it anew each time.
    unpacked = io.BytesIO(lzma.decompress((folder / "Bearing3_1.tar.xz").read_bytes()))
    with tarfile.open(fileobj=unpacked) as archive:
        snapshots = sorted((member for member in archive.getmembers() if member.name.endswith(".csv")),
                           key=lambda member: member.name)
        for member in snapshots:
            text = archive.extractfile(member).read().decode("ascii").replace(";", ",")
            rows = numpy.fromstring(text.replace("\n", ","), sep=",").reshape(-1, 6)
            number = int(re.search(r"acc_(\d+)", member.name)[1])
            yield Record(
                f"bearing3_1-{number:05d}",
                {"kind": "vibration", "sample_rate_hz": 25600, "input_speed_rpm": 1500,
                 "taken_after_s": 10 * (number - 1)},
                {"accel_x_m_per_s2": GRAVITY_M_PER_S2 * rows[:, 4],
                 "accel_y_m_per_s2": GRAVITY_M_PER_S2 * rows[:, 5]})


# Name of the folder in the collection, and its reader.
SOURCES = {
    "friction_damper_backlash": friction_damper,
    "emps": emps,
    "screw_worm_drives_stribeck": screw_worm,
    "pm_motor_torque_ripple": pm_motor,
    "cwru_bearing": cwru,
    "femto_bearing_run_to_failure": femto,
}


def read(name, collection):
    """Yields the records of one folder of the collection."""
    return SOURCES[name](pathlib.Path(collection) / name)
