# SPDX-License-Identifier: Apache-2.0
"""Sums up the results: the issue's numbers, per kind, per cause, what failed, and the tables behind the pictures."""
import collections
import json
import statistics

import plots

SIGMA_EDGES = (3.0, 4.0, 5.0, 7.0, 10.0, 20.0, 60.0)
GOOD = {"one": ("right",), "two": ("both",), "null": ("right",), "outside": ("right",), "wrong_number": ("right",)}


def _share(results, good):
    hits = sum(map(bool, map(good, results)))
    return {"count": hits, "of": len(results), "share": hits / len(results) if results else None}


def _clear(result):
    return bool(result["sigma"]) and min(result["sigma"]) >= 5.0 * 0.99


def _status(*names):
    return lambda result: result["status"] in names


def _wrong_name(result):
    return bool(result["excess"])


def _had_a_close_rival(result):
    rival = result["nearest_rival"]
    return result["status"] != "right" and rival is not None and rival["apart_sigma"] < 3.0


def _issue_numbers(results):
    by = collections.defaultdict(list)
    for result in results:
        by[result["situation"]].append(result)
    one, clear_one = by["one"], [r for r in by["one"] if _clear(r)]
    two, clear_two = by["two"], [r for r in by["two"] if _clear(r)]
    outside, clear_outside = by["outside"], [r for r in by["outside"] if _clear(r)]
    parameters = [p for r in results for p in r["parameters"]]
    ratios = [r["heldout_ratio"] for r in results if r["heldout_ratio"] is not None]
    lines = collections.OrderedDict()
    for label, group in (("5 sigma and up", clear_one), ("all sizes", one)):
        lines["one effect, %s: right name" % label] = _share(group, _status("right"))
        lines["one effect, %s: wrong name or a name too many" % label] = _share(group, _wrong_name)
        lines["one effect, %s: declared indistinguishable" % label] = _share(group, _status("indistinguishable"))
        lines["one effect, %s: not right, a rival within 3 sigma" % label] = _share(group, _had_a_close_rival)
        lines["one effect, %s: missed" % label] = _share(group, _status("missed"))
    lines["nothing hidden: no_effect"] = _share(by["null"], _status("right"))
    lines["wrong nominal numbers: no_effect"] = _share(by["wrong_number"], _status("right"))
    for label, group in (("both 5 sigma and up", clear_two), ("all sizes", two)):
        lines["two effects, %s: both named" % label] = _share(group, _status("both"))
        lines["two effects, %s: at least one named" % label] = _share(group, _status("both", "one"))
        lines["two effects, %s: a wrong name" % label] = _share(group, _wrong_name)
    for label, group in (("5 sigma and up", clear_outside), ("all sizes", outside)):
        lines["outside the list, %s: unnamed_structure" % label] = _share(group, _status("right"))
        lines["outside the list, %s: with the right order or window" % label] = _share(
            group, lambda r: r["status"] == "right" and r.get("signature_right"))
    lines["parameters inside their 95 % interval"] = _share(parameters, lambda p: p["inside"])
    lines["errors"] = _share(results, _status("error"))
    return lines, statistics.median(ratios) if ratios else None


def _times(results, name):
    times = sorted(r[name] for r in results)
    small = [r[name] for r in results if r["samples"] <= 10000]
    large = [r[name] for r in results if r["kind"] == "motion" and r["samples"] > 50000]
    return {"median_s": statistics.median(times), "max_s": times[-1],
            "max_s_up_to_10000_samples": max(small) if small else None,
            "max_s_motion_above_50000_samples": max(large) if large else None}


def summarise(results, arguments):
    lines, ratio = _issue_numbers(results)
    kinds = {}
    for kind in sorted({r["kind"] for r in results}):
        kinds[kind] = {}
        for situation, good in GOOD.items():
            group = [r for r in results if r["kind"] == kind and r["situation"] == situation]
            group = [r for r in group if not r["sigma"] or _clear(r)]
            kinds[kind][situation] = _share(group, _status(*good))
    causes = {}
    for cause in sorted({(r["kind"], r["true"][0]) for r in results if r["situation"] == "one"}):
        group = [r for r in results if r["situation"] == "one" and (r["kind"], r["true"][0]) == cause]
        causes["/".join(cause)] = {"right_5_sigma": _share([r for r in group if _clear(r)], _status("right")),
                                   "wrong_name": _share(group, _wrong_name)}
    names = ("seed", "cases", "only", "kind", "cause", "mode", "clear", "program", "out")
    kept = {name: arguments[name] for name in names}
    return {"arguments": kept, "cases": len(results), "with_excess_names": sum(map(_wrong_name, results)),
            "numbers": lines, "heldout_rmse_over_noise_median": ratio,
            "kinds_5_sigma": kinds, "causes": causes, "wall": _times(results, "wall_s"), "cpu": _times(results, "cpu_s"),
            "peak_rss_MB": max(r["peak_rss_MB"] for r in results),
            "failed": [failure_line(r) for r in results if r["status"] not in GOOD[r["situation"]] or r["excess"]]}


def failure_line(result):
    true = " + ".join("%s %.1f sigma" % pair for pair in zip(result["true"] or [result["outside"]], result["sigma"]))
    true = true or "nothing"
    named = " + ".join(result["named"]) or result["verdict"] or "exit code %s" % result.get("exit_code")
    rivals = " (or %s)" % ", ".join(result["rivals"]) if result.get("rivals") else ""
    nuisances = " [%s]" % ", ".join(result["nuisances"]) if result["nuisances"] else ""
    if result["nearest_rival"]:
        nuisances += " nearest rival %(name)s, %(apart_sigma).1f sigma apart" % result["nearest_rival"]
    return "%4d %s %s, %s: %s -> %s%s%s" % (result["case"], result["status"], result["kind"], result["situation"], true,
                                            named, rivals, nuisances)


def _words(share):
    return "%d of %d" % (share["count"], share["of"]) + (", %.1f %%" % (100.0 * share["share"]) if share["of"] else "")


def text(summary, results):
    out = ["", "%d cases, seed %d" % (summary["cases"], summary["arguments"]["seed"])]
    out += ["  %-58s %s" % (name, _words(share)) for name, share in summary["numbers"].items() if share["of"]]
    if summary["heldout_rmse_over_noise_median"] is not None:
        out.append("  %-58s %.3f" % ("held-out RMSE over true noise, median", summary["heldout_rmse_over_noise_median"]))
    wall, cpu = summary["wall"], summary["cpu"]
    for name, label in (("median_s", "time a record, on the clock and of the processor: median"), ("max_s", "the longest"),
                        ("max_s_up_to_10000_samples", "of up to 10 000 samples"),
                        ("max_s_motion_above_50000_samples", "of motion above 50 000 samples")):
        if wall[name] is not None:
            out.append("  %-58s %.2f s, %.2f s" % (label, wall[name], cpu[name]))
    out.append("  %-58s %.0f MB" % ("peak memory", summary["peak_rss_MB"]))
    out += ["", "right, at 5 sigma and up where there is an effect:"]
    out.append("  %-20s" % "" + "".join("%-22s" % situation for situation in GOOD))
    for kind, row in summary["kinds_5_sigma"].items():
        cells = (_words(row[situation]) if row[situation]["of"] else "" for situation in GOOD)
        out.append("  %-20s" % kind + "".join("%-22s" % cell for cell in cells))
    out += ["", "one effect, by cause: right at 5 sigma and up; a wrong name at any size:"]
    for cause, row in summary["causes"].items():
        out.append("  %-52s%-22s%s" % (cause, _words(row["right_5_sigma"]), _words(row["wrong_name"])))
    if summary["failed"]:
        out += ["", "not right (run again: --only NUMBER with the same other options):"]
        out += ["  " + line for line in summary["failed"]]
    return "\n".join(out + ["", "all of it: %s" % summary["arguments"]["out"]])


def write(folder, results, summary):
    (folder / "summary.json").write_text(json.dumps(summary, indent=1) + "\n", encoding="utf-8")
    (folder / "summary.txt").write_text(text(summary, results) + "\n", encoding="utf-8")
    (folder / "results.jsonl").write_text("".join(json.dumps(result) + "\n" for result in results), encoding="utf-8")
    plots.detection_curve(folder, results, SIGMA_EDGES)
    plots.confusion(folder, results)


def missed_gates(summary, least_right, most_wrong):
    """In words: gates of `run` that this set does not pass. None: no such gate. Right counts at 5 sigma and up."""
    right = sum(share["count"] for row in summary["kinds_5_sigma"].values() for share in row.values())
    wrong = summary["with_excess_names"]
    missed = []
    if least_right is not None and right < least_right:
        missed.append("%d of %d cases are right (expected at least %d)" % (right, summary["cases"], least_right))
    if most_wrong is not None and wrong > most_wrong:
        missed.append("%d cases have a name that is not in them (expected at most %d)" % (wrong, most_wrong))
    return missed
