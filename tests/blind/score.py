# SPDX-License-Identifier: Apache-2.0
"""Judges one answer of `strainwave diagnose --json` against the sealed truth."""
import json
import re

from parameters import coverage, to_truth_unit

NUMBER = re.compile(r"(?<![A-Za-z_\d.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
REGRESSOR_WORDS = {"velocity": ("speed", "velocity")}


def parse_answer(text):
    """The JSON object, or None where the output is not what docs/contract.md#diagnose says."""
    try:
        answer = json.loads(text)
    except ValueError:
        return None
    if isinstance(answer, list) and len(answer) == 1:
        answer = answer[0]
    if not isinstance(answer, dict) or answer.get("verdict") not in ("effect_found", "no_effect", "unnamed_structure"):
        return None
    causes = answer.get("causes")
    if not isinstance(causes, list) or not all(isinstance(cause, dict) and "name" in cause for cause in causes):
        return None
    return answer


def _rivals(cause):
    rivals = cause.get("indistinguishable_from") or []
    return {rival if isinstance(rival, str) else str(rival.get("name")) for rival in rivals}


def _found(name, causes):
    """named | indistinguishable | missing: how the answer holds the true cause."""
    if any(cause["name"] == name for cause in causes):
        return "named"
    return "indistinguishable" if any(name in _rivals(cause) for cause in causes) else "missing"


def _excess(true_names, causes):
    """Named causes that are not in the record, and do not admit that they may be one that is."""
    return [cause["name"] for cause in causes
            if cause["name"] not in true_names and not _rivals(cause) & set(true_names)]


def _overlap(first, second):
    """Intersection over union of two intervals."""
    common = min(first[1], second[1]) - max(first[0], second[0])
    span = max(first[1], second[1]) - min(first[0], second[0])
    return max(common, 0.0) / span if span > 0.0 else 0.0


def signature_is_right(signature, text):
    """Whether the words of `unexplained.signature` hold the right order, window or regressor."""
    lowered = text.lower()
    numbers = [float(word) for word in NUMBER.findall(re.sub(r"(?<=\d)\s*[-–…]+\s*(?=\d)", " ", lowered))]
    if signature["what"] == "regressor":
        return any(word in lowered for word in REGRESSOR_WORDS[signature["regressor"]])
    if signature["what"] == "window":
        pairs = [sorted(pair) for pair in zip(numbers, numbers[1:])]
        if any(_overlap(pair, signature["window"]) > 0.3 for pair in pairs):
            return True
    for value in signature["values"]:
        room = signature["tolerance"] * (abs(value) if signature.get("relative") else 1.0)
        if any(abs(abs(number) - abs(value)) <= room for number in numbers):
            return True
    return False


def _judge_none(answer):
    return "right" if answer["verdict"] == "no_effect" and not answer["causes"] else "false_alarm"


def _judge_one(true_name, answer):
    causes = answer["causes"]
    if not causes:
        return "missed"
    found = _found(true_name, causes)
    if found == "missing":
        return "wrong"
    if _excess([true_name], causes):
        return "false_alarm"
    return "right" if found == "named" else "indistinguishable"


def _judge_two(true_names, answer):
    named = sum(_found(name, answer["causes"]) == "named" for name in true_names)
    return {0: "none", 1: "one", 2: "both"}[named]


def _judge_outside(answer):
    if answer["verdict"] == "unnamed_structure" and not answer["causes"]:
        return "right"
    return "missed" if answer["verdict"] == "no_effect" and not answer["causes"] else "wrong"


def _heldout_ratio(truth, answer):
    extended = answer.get("extended") or {}
    value = extended.get("heldout_rmse")
    if not isinstance(value, (int, float)):
        return None
    unit = (answer.get("nominal") or {}).get("unit", truth["unit"])
    converted = to_truth_unit(value, unit, truth["unit"])
    return converted / truth["noise_sd"] if converted is not None else None


def judge(truth, exit_code, output):
    """One line of results for the report; everything in it is plain JSON."""
    answer = parse_answer(output) if exit_code == 0 else None
    true_names = [cause["name"] for cause in truth["causes"]]
    outside = truth.get("outside")
    result = {"case": truth["case"], "kind": truth["kind"], "situation": truth["situation"], "true": true_names,
              "sigma": [cause["sigma"] for cause in truth["causes"]] or ([outside["sigma"]] if outside else []),
              "nuisances": truth["nuisances"], "samples": truth["samples"], "verdict": None, "named": [], "excess": [],
              "outside": outside["name"] if outside else None, "parameters": [], "heldout_ratio": None,
              "nearest_rival": truth.get("nearest_rival")}
    if answer is None:
        return dict(result, status="error")
    result["verdict"] = answer["verdict"]
    result["named"] = [cause["name"] for cause in answer["causes"]]
    result["rivals"] = sorted(set().union(*map(_rivals, answer["causes"])) if answer["causes"] else ())
    result["excess"] = _excess(true_names, answer["causes"])
    result["heldout_ratio"] = _heldout_ratio(truth, answer)
    for cause in truth["causes"]:
        for given in answer["causes"]:
            if given["name"] == cause["name"]:
                result["parameters"] += coverage(cause, given.get("parameters") or {})
    if truth["situation"] in ("null", "wrong_number"):
        return dict(result, status=_judge_none(answer))
    if truth["situation"] == "one":
        return dict(result, status=_judge_one(true_names[0], answer))
    if truth["situation"] == "two":
        return dict(result, status=_judge_two(true_names, answer))
    unexplained = answer.get("unexplained") or {}
    text = unexplained.get("signature") or ""
    text = text if isinstance(text, str) else json.dumps(text)
    return dict(result, status=_judge_outside(answer), signature=text,
                signature_right=signature_is_right(outside["signature"], text))
