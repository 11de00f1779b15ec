#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The converters against what the makers of the records publish. Exit code 77: skipped, there are no records."""
import sys
import unittest

import numpy

import records
import sources

COLLECTION = records.source_folder()


def read_all(name):
    return {record.name: record for record in sources.read(name, COLLECTION)}


def low_pass(values, cutoff_hz, sample_rate_hz):
    """Zero-phase Butterworth of order 4, there and back, on the values without their end-to-end slope."""
    slope = numpy.linspace(values[0], values[-1], len(values))
    mirrored = numpy.concatenate([values - slope, (slope - values)[-2:0:-1]])
    frequency_hz = numpy.fft.rfftfreq(len(mirrored), 1.0 / sample_rate_hz)
    spectrum = numpy.fft.rfft(mirrored) / (1.0 + (frequency_hz / cutoff_hz) ** 8)
    return numpy.fft.irfft(spectrum, len(mirrored))[:len(values)] + slope


class Emps(unittest.TestCase):
    def test_a_fit_finds_the_published_parameters(self):
        columns = read_all("emps")["data_emps"].columns
        position_m = low_pass(columns["position_m"], 100.0, 1000.0)
        velocity = numpy.gradient(position_m, 1e-3)
        terms = numpy.stack([numpy.gradient(velocity, 1e-3), velocity, numpy.sign(velocity),
                             numpy.ones_like(velocity)], axis=1)
        force_N = low_pass(columns["force_N"], 100.0, 1000.0)
        inside = slice(50, -50, 10)
        mass_kg, viscous, coulomb_N, offset_N = numpy.linalg.lstsq(terms[inside], force_N[inside], rcond=None)[0]
        # IDIM-LS of the makers; our filter has other ends, which moves the numbers by about half a percent.
        self.assertAlmostEqual(mass_kg, 95.1089, delta=0.01 * 95.1)
        self.assertAlmostEqual(viscous, 203.5034, delta=0.01 * 203.5)
        self.assertAlmostEqual(coulomb_N, 20.3935, delta=0.01 * 20.4)
        self.assertAlmostEqual(offset_N, -3.1648, delta=0.05 * 3.2)


class FrictionDamper(unittest.TestCase):
    def test_peaks_are_those_of_the_source(self):
        loops = read_all("friction_damper_backlash")
        self.assertEqual(len(loops), 5)
        torque_Nm = loops["dataset-2-0.25Hz36lbtension1amplitude"].columns["torque_Nm"]
        self.assertAlmostEqual(torque_Nm.min(), -56.0, delta=0.5)  # −5.6 kip
        self.assertAlmostEqual(torque_Nm.max(), 36.0, delta=0.5)  # +3.6 kip


class ScrewAndWorm(unittest.TestCase):
    def test_every_steady_record_turns_at_the_speed_of_its_name(self):
        for name, record in read_all("screw_worm_drives_stribeck").items():
            if "steady_state" not in name:
                continue
            speed_rpm = float(name.rsplit("-", 1)[1].lstrip("n"))
            time_s, position_rad = record.columns["time_s"], record.columns["position_rad"]
            turned_rpm = abs(position_rad[-1]) / (time_s[-1] - time_s[0]) * 30.0 / numpy.pi
            # The drive reports whole revolutions per minute.
            self.assertAlmostEqual(turned_rpm, speed_rpm, delta=0.2 + 0.01 * speed_rpm, msg=name)

    def test_an_overwritten_sample_is_put_back(self):
        worm = read_all("screw_worm_drives_stribeck")["driveNo3-steady_state-n1"]
        self.assertAlmostEqual(worm.columns["torque_Nm"][0], 0.221 * 9.84e-3)


class PmMotor(unittest.TestCase):
    def test_speed_records_have_the_mean_speed_of_their_name(self):
        for name, record in read_all("pm_motor_torque_ripple").items():
            if record.metadata["kind"] == "vibration":
                mean_rpm = record.columns["speed_rad_per_s"].mean() * 30.0 / numpy.pi
                speed_rpm = record.metadata["input_speed_rpm"]
                self.assertAlmostEqual(mean_rpm, speed_rpm, delta=0.03 * speed_rpm, msg=name)


class Cwru(unittest.TestCase):
    def test_an_inner_race_fault_stands_out_in_the_envelope(self):
        bearings = read_all("cwru_bearing")

        def prominence(record):
            rate_hz = record.metadata["sample_rate_hz"]
            envelope = numpy.abs(record.columns["accel_x_m_per_s2"])
            power = numpy.abs(numpy.fft.rfft(envelope - envelope.mean())) ** 2
            frequency_hz = numpy.fft.rfftfreq(len(envelope), 1.0 / rate_hz)
            fault_hz = 5.4152 * float(record.metadata["input_speed_rpm"]) / 60.0
            distance_hz = numpy.abs(frequency_hz - fault_hz)
            return power[distance_hz < 2.0].max() / numpy.median(power[distance_hz < 40.0])

        self.assertGreater(prominence(bearings["IR007_0"]), 100.0 * prominence(bearings["normal_0"]))
        self.assertEqual(bearings["OR007@6_0"].metadata["class"], "outer_race")


class Femto(unittest.TestCase):
    def test_the_run_ends_in_the_failure_that_its_makers_declare(self):
        snapshots = list(sources.read("femto_bearing_run_to_failure", COLLECTION))
        self.assertEqual(len(snapshots), 515)
        self.assertTrue(all(len(s.columns["accel_x_m_per_s2"]) == 2560 for s in snapshots))
        peaks = [max(numpy.abs(values).max() for values in s.columns.values()) for s in snapshots]
        failure_m_per_s2 = 20.0 * records.GRAVITY_M_PER_S2
        self.assertGreater(max(peaks[450:]), failure_m_per_s2)
        self.assertLess(max(peaks[:450]), failure_m_per_s2)


if __name__ == "__main__":
    if COLLECTION is None:
        print("skipped, because there are no measured records (STRAINWAVE_DATA, or ../shared/data)")
        sys.exit(77)
    unittest.main()
