# SPDX-License-Identifier: Apache-2.0
"""What an answer of the program is worth, beside the truth of the machine.

`silent`: a number outside its interval or an accusation of what is not there, exit code 0 and no warning. `warned`: the same, with a
warning. `refused`: exit code 1 or 2, in words. `right`: everything said is true. `broken`: anything else, such as a crash.
A sentence "no verdict on ..." or "... cannot be judged" says what was not looked at; it warns of no number and spoils no clean record.
"""
import dataclasses
import json
import math
import re

WARNS_OF_NOTHING = re.compile(r"^no verdict on |^\w+ cannot be judged: ")


@dataclasses.dataclass
class Wrong:
    quantity: str
    value: object
    stated_error: float
    truth: object

    def row(self):
        if isinstance(self.value, str):
            return "%s | %s | | %s" % (self.quantity, self.value, self.truth)
        return "%s | %.6g | %.2g | %.6g" % (self.quantity, self.value, self.stated_error, self.truth)


@dataclasses.dataclass
class Verdict:
    status: str
    wrong: list
    warnings: list
    missing: list  # quantities of the truth for which no number was given


def _compare(pairs, truth, wrong, missing):
    """`pairs`: quantity -> (value, stated error)"""
    for quantity, expected in truth.items():
        value, stated_error = pairs.get(quantity, (None, None))
        if value is None:
            missing.append(quantity)
        elif not math.isfinite(value) or abs(value - expected.value) > expected.room(stated_error or 0.0):
            wrong.append(Wrong(quantity, float(value), stated_error or 0.0, expected.value))


def _of_parameters(parameters):
    return {name: (entry.get("value"), entry.get("se")) for name, entry in parameters.items()}


def _recomputed(answer, record):
    pairs = {name: (value, answer.get(name + "_se")) for name, value in answer.items()
             if isinstance(value, (int, float)) and not name.endswith("_se")}
    pairs["second_harmonic_amplitude_arcmin"] = next(
        ((order["amplitude_arcmin"], order.get("amplitude_arcmin_se")) for order in answer.get("orders", [])
         if order["name"] == "wave generator, 2nd harmonic"), (None, None))
    return pairs, record.truth


def _diagnosed(answer, record, wrong):
    for cause in answer["causes"]:
        names = [cause["name"]] + cause.get("indistinguishable_from", [])
        there = [name for name in names if name in record.causes]
        if not there:
            wrong.append(Wrong("cause", cause["name"], 0.0, ", ".join(record.causes) or "nothing"))
        elif there[0] == cause["name"]:
            _compare(_of_parameters(cause["parameters"]), record.causes[cause["name"]], wrong, [])
    if answer["verdict"] == "unnamed_structure":
        wrong.append(Wrong("verdict", "unnamed_structure", 0.0, ", ".join(record.causes) or "nothing"))
    extended = answer.get("extended") or {}
    pairs = _of_parameters(extended.get("parameters") or answer["nominal"]["parameters"])
    asked = {name: truth for name, truth in record.truth.items()
             if not name.startswith(("e_", "lost_motion", "hysteresis_"))}
    return pairs, asked


def warnings_of(answer, errors):
    """From the JSON and from standard error, which has progress and notes as well."""
    said = [str(warning) for warning in answer.get("warnings", [])]
    said += [line.split("warning: ", 1)[1] for line in errors.splitlines() if "warning: " in line]
    return [text for text in dict.fromkeys(said) if not WARNS_OF_NOTHING.search(text)]


def judge(record, exit_code, output, errors):
    if exit_code == 2:
        return Verdict("refused" if ": error: " in errors else "broken", [], errors.splitlines(), [])
    if exit_code not in (0, 1):
        return Verdict("broken", [], errors.splitlines()[-3:] + ["exit code %d" % exit_code], [])
    try:
        answer = json.loads(output, parse_constant=float)
    except ValueError:
        return Verdict("broken", [], ["no JSON: " + output[:80]], [])
    wrong, missing = [], []
    warnings = warnings_of(answer, errors)
    pairs, truth = _diagnosed(answer, record, wrong) if "verdict" in answer else _recomputed(answer, record)
    _compare(pairs, truth, wrong, missing)
    if exit_code == 1:
        checks = list(answer.get("failed_checks", []))
        return Verdict("refused" if checks or warnings else "broken", wrong, checks + warnings, missing)
    status = "right" if not wrong else "warned" if warnings else "silent"
    return Verdict(status, wrong, warnings, missing)
