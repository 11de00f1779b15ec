# SPDX-License-Identifier: Apache-2.0
"""What loggers do to samples and their stamps. Each function changes a record and says what it did, or None where it has no place.

Those of `MACHINE_STANDS` happen to the machine, before its sensors have measured; those of `SAMPLES` to what was measured.
"""
import numpy


def pick(rng, items):
    return items[int(rng.integers(len(items)))]


def stand(record, rng):
    count = int(rng.uniform(0.1, 0.6) * record.rows())
    if record.kind == "motion":
        velocity = numpy.diff(record.columns["position_rad"])
        turns = numpy.nonzero(velocity[1:] * velocity[:-1] < 0.0)[0] + 1
        row = int(pick(rng, turns))
        record.stay(row, count)
        # Friction holds the axis; the drive keeps whatever torque it had, within what friction takes.
        hold = record.truth["offset_Nm"].value + rng.uniform(-0.8, 0.8) * record.truth["coulomb_Nm"].value
        record.columns["torque_Nm"][row:row + count] = hold
        if "velocity_rad_per_s" in record.columns:
            record.columns["velocity_rad_per_s"][row:row + count] = 0.0
    elif record.kind == "vibration":
        # The machine is off at first, the sensor's noise is not.
        row, clock = 0, record.columns.get("time_s")
        rows = record.rows()
        for name in record.channels():
            record.columns[name] = numpy.concatenate([numpy.zeros(count), record.columns[name]])
        if clock is not None:
            record.columns["time_s"] = numpy.arange(rows + count) * (clock[1] - clock[0])
    else:
        row = int(pick(rng, [0, rng.integers(1, record.rows() - 1)]))
        record.stay(row, count)
    return "stands still for %d rows from row %d" % (count, row)


def slow(record, rng):
    """A sweep that is sampled in time, slow over a part of the turn: its rows lie closer there."""
    if record.kind != "transmission_error":
        return None
    turned = numpy.asarray(record.columns["input_angle_deg"])
    part = numpy.abs(turned - turned[0]) / numpy.ptp(turned)
    centre = rng.uniform(0.2, 0.8)
    kept = (numpy.abs(part - centre) < 0.15) | (numpy.arange(len(part)) % int(rng.integers(2, 5)) == 0)
    kept[[0, -1]] = True
    record.keep(kept)
    return "is slow around %.0f %% of the way" % (100.0 * centre)


def angle_of(record, rng):
    names = [name for name in record.angles if name in record.columns]
    return pick(rng, names) if names else None


def wrap(record, rng):
    name = angle_of(record, rng)
    if name is None:
        return None
    turn = record.angles[name] / pick(rng, [1, 1, 1, 2, 4])
    lowest = pick(rng, [0.0, -turn / 2.0])
    before = record.columns[name]
    if rng.random() < 0.5 and record.kind != "transmission_error":
        before = before - before[0] + rng.uniform(0.0, turn)  # an encoder's zero lies anywhere
    record.columns[name] = lowest + numpy.mod(before - lowest, turn)
    return "%s wrapped to %g ... %g" % (name, lowest, lowest + turn)


def hold(record, rng):
    name = pick(rng, record.channels())
    rows, most = record.rows(), int(rng.integers(2, 7))
    if rng.random() < 0.6:
        last = numpy.arange(rows) // most * most
        how = "for %d rows each" % most
    else:
        fresh = rng.random(rows) < 1.0 / most
        fresh[0] = True
        last = numpy.maximum.accumulate(numpy.where(fresh, numpy.arange(rows), 0))
        how = "until the next comes, every %d rows or so" % most
    record.columns[name] = record.columns[name][last]
    return "%s held %s" % (name, how)


def freeze(record, rng):
    name = pick(rng, record.channels())
    rows = record.rows()
    count = int(rng.uniform(0.02, 0.1) * rows)
    row = int(rng.integers(rows // 10, rows - count - rows // 10))
    record.columns[name][row:row + count] = record.columns[name][row]
    return "%s frozen for %d rows from row %d" % (name, count, row)


def steps(record, rng):
    name = pick(rng, record.channels())
    values = record.columns[name]
    if name in record.angles:
        bits = int(rng.integers(12, 23))
        step, how = record.angles[name] / 2.0 ** bits, "of %d bits" % bits
    else:
        bits = int(rng.integers(8, 13))
        step, how = 2.0 * float(numpy.max(numpy.abs(values))) / 2.0 ** bits, "of %d bits of its range" % bits
    record.columns[name] = step * numpy.round(values / step)
    record.decimals[name] = 9
    return "%s in steps %s" % (name, how)


def outliers(record, rng):
    name = pick(rng, record.channels())
    values = record.columns[name]
    count = int(rng.integers(1, 4))
    where = 1 + rng.choice(len(values) - 2, count, replace=False)
    reach = float(numpy.ptp(values))
    how = pick(rng, ["zero", "far", "near"])
    if how == "zero":
        values[where] = 0.0
    else:
        values[where] += rng.choice([-1.0, 1.0], count) * reach * rng.uniform(*((0.5, 3.0) if how == "far" else (0.02, 0.2)), count)
    return "%s has %d outliers (%s)" % (name, count, how)


def saturate(record, rng):
    """A range that is too small; an angle has none."""
    names = [name for name in record.channels() if name not in record.angles and name != "temperature_degC"]
    if not names:
        return None
    name = pick(rng, names)
    values = record.columns[name]
    end = rng.uniform(0.7, 0.97) * float(numpy.max(numpy.abs(values)))
    record.columns[name] = numpy.clip(values, -end, end)
    return "%s ends at %.4g" % (name, end)


def double_rows(record, rng):
    count = int(rng.uniform(0.005, 0.1) * record.rows()) + 1
    twice = rng.choice(record.rows(), count, replace=False)
    record.keep(numpy.sort(numpy.concatenate([numpy.arange(record.rows()), twice])))
    return "%d rows written twice" % count


def gap(record, rng):
    if record.kind == "vibration" and "time_s" not in record.columns:
        return None  # nobody can see a gap without a clock
    rows = record.rows()
    count = int(rng.uniform(0.02, 0.15) * rows)
    row = int(rng.integers(rows // 10, rows - count - rows // 10))
    record.keep(numpy.r_[0:row, row + count:rows])
    return "a gap of %d rows before row %d" % (count, row)


def rounded_stamps(record, rng):
    clock = record.columns.get("time_s")
    if clock is None:
        return None
    step_s = float(numpy.median(numpy.diff(clock)))
    if step_s <= 0.0:
        return None
    record.decimals["time_s"] = max(int(numpy.floor(-numpy.log10(step_s * rng.uniform(0.3, 3.0)))), 0)
    return "stamps with %d decimals" % record.decimals["time_s"]


def jittering_stamps(record, rng):
    clock = record.columns.get("time_s")
    if clock is None:
        return None
    share = rng.uniform(0.05, 0.4)
    step_s = float(numpy.median(numpy.diff(clock)))
    late_s = share * step_s * rng.uniform(-1.0, 1.0, len(clock))
    record.columns["time_s"] = numpy.maximum.accumulate(clock + late_s - late_s[0])
    record.decimals["time_s"] = 9
    return "stamps off by up to %.0f %% of a step" % (100.0 * share)


def shared_noise(record, rng):
    """Two accelerometers on one housing share background noise."""
    if record.kind != "vibration" or len(record.channels()) < 2:
        return None
    record.shared_noise = rng.uniform(0.2, 0.9)
    return "channels share noise (correlation %.2f)" % record.shared_noise


MACHINE_STANDS = {"stand": stand, "slow": slow, "shared_noise": shared_noise}
SAMPLES = {"wrap": wrap, "hold": hold, "freeze": freeze, "steps": steps, "outliers": outliers, "saturate": saturate,
           "double_rows": double_rows, "gap": gap, "rounded_stamps": rounded_stamps, "jittering_stamps": jittering_stamps}
