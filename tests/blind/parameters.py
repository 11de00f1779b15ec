# SPDX-License-Identifier: Apache-2.0
"""Which reported parameter is which true one. A parameter that has no clear partner by key word and unit is left out."""
import math
import re

# True name -> key words of which the reported name holds at least one; words of another convention rule a name out.
KEY_WORDS = {
    "amplitude": ("amplitude", "magnitude"), "width": ("width", "backlash", "gap", "play", "lost_motion", "dead"),
    "windup": ("windup", "wind_up", "compliance", "coefficient", "slope", "gain"),
    "drift": ("drift", "rate", "coefficient", "slope", "gain"), "total": ("total",),
    "height": ("height", "amplitude", "depth", "peak"), "centre": ("centre", "center", "position", "location"),
    "asymmetry": ("asymmetry",), "cubic": ("cubic", "k_3", "k3", "hardening"), "time_constant": ("time_constant", "tau"),
    "level": ("level", "threshold", "slip_torque", "limit"), "offset": ("offset", "zero"),
    "viscous": ("viscous", "rate", "damping"), "drag": ("drag", "quadratic", "coefficient"),
    "rise": ("rise", "amplitude", "stribeck", "excess", "breakaway", "static"),
    "coefficient": ("coefficient", "gain", "slope"), "frequency": ("frequency",), "damping": ("damping",),
    "gap": ("gap", "backlash", "width", "play"), "delay": ("delay",), "order": ("order",),
    "window_start": ("start",), "window_end": ("end",),
}
RULED_OUT = ("peak_to_peak", "half", "half_width", "log", "share", "phase")
SI = {"arcmin": ("rad", math.pi / 10800.0), "arcsec": ("rad", math.pi / 648000.0), "deg": ("rad", math.pi / 180.0),
      "mrad": ("rad", 1e-3), "urad": ("rad", 1e-6), "rad": ("rad", 1.0), "nm": ("nm", 1.0), "mnm": ("nm", 1e-3),
      "n": ("n", 1.0), "s": ("s", 1.0), "ms": ("s", 1e-3), "us": ("s", 1e-6), "min": ("s", 60.0), "hz": ("hz", 1.0),
      "rad/s": ("hz", 0.5 / math.pi), "m": ("m", 1.0), "mm": ("m", 1e-3), "m/s^2": ("m/s^2", 1.0), "k": ("k", 1.0),
      "degc": ("k", 1.0), "1": ("", 1.0), "-": ("", 1.0), "": ("", 1.0), "%": ("", 0.01), "1/rev": ("1/rev", 1.0),
      "perrev": ("1/rev", 1.0), "order": ("1/rev", 1.0), "1/turn": ("1/rev", 1.0)}


def _plain(unit):
    """One spelling: lower case, no blanks or dots, powers with ^."""
    text = (unit or "").strip().lower().replace("²", "^2").replace("³", "^3")
    text = text.replace("·", "").replace("*", "").replace(" ", "")
    text = text.replace("°c", "degc").replace("°", "deg").replace("_per_", "/")
    text = re.sub(r"(?<=[a-z])([23])$", r"^\1", text)
    return re.sub(r"(?<=[a-z])([23])(?=/)", r"^\1", text)


def _measure(unit):
    """(dimension, factor); a fraction is taken apart once, so arcmin/Nm and rad/Nm are alike."""
    plain = _plain(unit)
    if plain in SI:
        return SI[plain]
    if plain.count("/") == 1:
        above, below = (SI.get(part) for part in plain.split("/"))
        if above and below and below[1]:
            return above[0] + "/" + below[0], above[1] / below[1]
    return plain, 1.0


def to_truth_unit(value, unit, truth_unit):
    """`value` in the truth's unit; None where the units measure different things."""
    dimension, factor = _measure(unit)
    truth_dimension, truth_factor = _measure(truth_unit)
    return value * factor / truth_factor if dimension == truth_dimension else None


def coverage(true_cause, reported):
    """[{parameter, inside, error_in_se}] for each true parameter that has exactly one partner with a standard error."""
    found = []
    for name, true in true_cause["parameters"].items():
        partners = []
        for other, entry in reported.items():
            if not isinstance(entry, dict) or not isinstance(entry.get("value"), (int, float)) or not entry.get("se"):
                continue
            lowered = other.lower()
            if not any(word in lowered for word in KEY_WORDS.get(name, (name,))):
                continue
            if any(word in lowered for word in RULED_OUT):
                continue
            value = to_truth_unit(entry["value"], entry.get("unit"), true["unit"])
            if value is not None:
                partners.append((other, value, abs(entry["se"] * to_truth_unit(1.0, entry.get("unit"), true["unit"]))))
        if len(partners) == 1:
            other, value, se = partners[0]
            # A sign may be a matter of convention; how far it is off is not.
            distance = min(abs(value - true["value"]), abs(value + true["value"])) / se
            found.append({"cause": true_cause["name"], "parameter": name, "reported_as": other, "true": true["value"],
                          "value": value, "se": se, "inside": distance <= 1.96})
    return found
