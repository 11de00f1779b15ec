# SPDX-License-Identifier: Apache-2.0
"""What people do to a record's labels: units, signs, names, order, metadata. As in `samples.py`, None where it has no place.

Nothing is drawn that a careful reader of the file could not see: a scale or a sign needs a second witness, such as the ratio,
the knees of the gear or a column of speed.
"""
import math

import numpy

from samples import pick

FACTORS = {"1000": 1000.0, "1/1000": 1e-3, "60": 60.0, "1/60": 1.0 / 60.0, "2 pi": 2.0 * math.pi, "1/(2 pi)": 0.5 / math.pi,
           "180/pi": 180.0 / math.pi, "pi/180": math.pi / 180.0}
MISSPELT = {"t1_Nm": ("T1_Nm", "t1", "t1_nm", "knee1_Nm"), "t2_Nm": ("T2_Nm", "t2", "t2_nm"), "t3_Nm": ("T3_Nm", "t3"),
            "ratio": ("Ratio", "gear_ratio", "raito", "i"), "absolute": ("Absolute", "absolut", "abs"),
            "inertia_kgm2": ("inertia", "Inertia_kgm2", "inertia_kg_m2"),
            "input_speed_rpm": ("speed_rpm", "Input_speed_rpm", "input_speed", "input_rpm"),
            "sample_rate_hz": ("sample_rate", "sample_rate_Hz", "fs")}
# The same thing said with its unit, and in another unit.
WITH_UNIT = {"t1_Nm": lambda x: "%g Nm" % x, "t2_Nm": lambda x: "%g Nm" % x, "t3_Nm": lambda x: "%g mNm" % (1e3 * x),
             "ratio": lambda x: "%g:1" % x, "inertia_kgm2": lambda x: "%g kgcm2" % (1e4 * x),
             "input_speed_rpm": lambda x: "%g Hz" % (x / 60.0), "sample_rate_hz": lambda x: "%g kHz" % (1e-3 * x)}
OTHER_UNIT = {"torque_Nm": ("torque_mNm", 1e3), "output_angle_deg": ("output_angle_rad", math.pi / 180.0),
              "input_angle_deg": ("input_angle_rev", 1.0 / 360.0), "position_rad": ("position_deg", 180.0 / math.pi),
              "velocity_rad_per_s": ("velocity_rpm", 30.0 / math.pi), "time_s": ("time_ms", 1e3),
              "accel_x_m_per_s2": ("accel_x_g", 1.0 / 9.80665), "accel_z_m_per_s2": ("accel_z_g", 1.0 / 9.80665)}


def with_witness(record):
    """Columns whose scale or sign something else in the record tells."""
    if record.kind == "motion":
        names = ["time_s", "position_rad", "velocity_rad_per_s"] if "velocity_rad_per_s" in record.columns else []
        return names + (["torque_Nm"] if "inertia_kgm2" in record.metadata else [])
    if record.kind == "vibration":
        return ["time_s"] if "time_s" in record.columns else []
    return [name for name in record.channels() if name != "temperature_degC"]


def scale(record, rng):
    word = pick(rng, list(FACTORS))
    if record.kind == "vibration" and rng.random() < 0.7:
        # The shaft's own lines tell its speed from its rate.
        key = pick(rng, ["input_speed_rpm", "sample_rate_hz"])
        if key not in record.metadata:
            return None
        try:
            record.metadata[key] = "%.6g" % (float(record.metadata[key]) * FACTORS[word])
        except ValueError:
            return None  # it is in words already
        return "%s times %s" % (key, word)
    names = with_witness(record)
    if not names:
        return None
    name = pick(rng, names)
    record.columns[name] = record.columns[name] * FACTORS[word]
    record.decimals[name] = record.decimals.get(name, 6) + 3
    return "%s times %s" % (name, word)


def sign(record, rng):
    names = [name for name in record.channels() if name != "temperature_degC"]
    if record.kind == "vibration" or not names:
        return None
    name = pick(rng, names)
    record.columns[name] = -record.columns[name]
    return "%s with the other sign" % name


def swap(record, rng):
    """The names of two columns, one for the other."""
    pairs = {"hysteresis": ("torque_Nm", "output_angle_deg"), "transmission_error": ("input_angle_deg", "output_angle_deg"),
             "motion": ("position_rad", "velocity_rad_per_s")}
    pair = pairs.get(record.kind, ("", ""))
    if not set(pair) <= set(record.columns):
        return None
    values, decimals = [record.columns[name] for name in pair], [record.decimals.get(name, 6) for name in pair]
    record.columns[pair[0]], record.columns[pair[1]] = values[::-1]
    record.decimals[pair[0]], record.decimals[pair[1]] = decimals[::-1]
    return "%s and %s swapped" % pair


def order(record, rng):
    names = [str(name) for name in rng.permutation(list(record.columns))]
    record.columns = {name: record.columns[name] for name in names}
    return "columns in another order"


def unknown_column(record, rng):
    name = pick(rng, ["current_A", "counter", "pressure_bar"])
    if record.kind == "vibration":
        return None  # there a further channel is a signal
    record.columns[name] = numpy.arange(record.rows()) * 1.0 if name == "counter" else rng.normal(5.0, 0.1, record.rows())
    return "a column %s" % name


def other_unit(record, rng):
    names = [name for name in record.columns if name in OTHER_UNIT]
    name = pick(rng, names)
    other, factor = OTHER_UNIT[name]
    record.columns = {other if key == name else key: values * factor if key == name else values
                      for key, values in record.columns.items()}
    record.decimals[other] = record.decimals.get(name, 6) + (0 if factor > 1.0 else 4)
    return "%s as %s" % (name, other)


def missing_metadata(record, rng):
    keys = [key for key in record.metadata if key not in ("kind", "absolute")]
    if not keys:
        return None
    if record.kind == "hysteresis" and rng.random() < 0.5:
        for key in keys:
            del record.metadata[key]
        return "without " + ", ".join(keys)
    key = pick(rng, keys)
    del record.metadata[key]
    return "without " + key


def misspelt_metadata(record, rng):
    keys = [key for key in record.metadata if key in MISSPELT]
    if not keys:
        return None
    if record.kind == "hysteresis" and rng.random() < 0.5:
        chosen = [(key, MISSPELT[key][0]) for key in keys]
    else:
        key = pick(rng, keys)
        chosen = [(key, pick(rng, MISSPELT[key]))]
    for key, other in chosen:
        record.metadata = {other if name == key else name: value for name, value in record.metadata.items()}
    return ", ".join("%s for %s" % (other, key) for key, other in chosen)


def unit_in_metadata(record, rng):
    keys = [key for key in record.metadata if key in WITH_UNIT]
    if not keys:
        return None
    key = pick(rng, keys)
    try:
        record.metadata[key] = WITH_UNIT[key](float(record.metadata[key]))
    except ValueError:
        return None  # it has its unit already
    return "# %s: %s" % (key, record.metadata[key])


LABELS = {"scale": scale, "sign": sign, "swap": swap, "order": order, "unknown_column": unknown_column, "other_unit": other_unit,
          "missing_metadata": missing_metadata, "misspelt_metadata": misspelt_metadata, "unit_in_metadata": unit_in_metadata}
