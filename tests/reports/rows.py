# SPDX-License-Identifier: Apache-2.0
"""What is expected of each report of users, as its `expected.md` has it."""
import re

from outcome import Near, Outcome, Row, share

SIZE_25 = {"k1_Nm_per_rad": share(31000.0, 0.001), "k2_Nm_per_rad": share(50000.0, 0.001), "k3_Nm_per_rad": share(57000.0, 0.001)}
SIZE_20 = {"k1_Nm_per_rad": share(15501.0, 0.001), "k2_Nm_per_rad": share(24496.0, 0.001), "k3_Nm_per_rad": share(28494.0, 0.001)}
NOMINAL = "nominal.parameters.%s.value"
SIZE_25_FITTED = {NOMINAL % name: near for name, near in SIZE_25.items()}
AXIS = {NOMINAL % "inertia_kgm2": share(0.06, 0.03), NOMINAL % "coulomb_Nm": share(1.2, 0.03)}
KINDS_OF_JUMP = r"(?i)\bjump|unwrap|\bwrap"
QUIET = {"verdict": "no_effect"}
NO_CHECK_FAILED = {"failed_checks": []}


def reports(report, command, file, *outcomes, never=()):
    return Row(report, (*command, "{reports}/%s/%s" % (report, file), "--json"), outcomes, never)


def made(report, command, file, *outcomes, never=(), json=True):
    return Row(report, (*command, "{made}/%s/%s" % (report, file), *(("--json",) if json else ())), outcomes, never)


def misspelt_knees():
    rows = [reports("01-metadata-keys", ("recompute",), "control_size25.csv", Outcome((0,), SIZE_25, NO_CHECK_FAILED)),
            reports("01-metadata-keys", ("diagnose",), "control_size25.csv", Outcome((0,), SIZE_25_FITTED, QUIET))]
    told_default = Outcome((0, 1), words=(r"\b7\b", r"\b25\b", r"\b34\b"))
    for file, key in (("size25_capitals.csv", "t1_Nm"), ("size25_without_unit.csv", "t1_Nm"), ("size25_none.csv", None)):
        refused = (Outcome((2,), words=(r"%s:\d+:\d+: error: .*%s" % (file, key),)),) if key else ()
        rows += [reports("01-metadata-keys", ("recompute",), file, Outcome((0,), SIZE_25), told_default, *refused),
                 reports("01-metadata-keys", ("diagnose",), file, Outcome((0,), SIZE_25_FITTED), told_default, *refused)]
    return rows


def separators():
    never = ("column 'time_s' is missing", "metadata 'kind' is missing", "is not metadata")
    causes = {"control_comma_point.csv": None, "excel_sep_line.csv": "sep=", "german_excel.csv": "semicolon|decimal comma",
              "savetxt_header.csv": "#", "semicolon_point.csv": "semicolon", "tabs.csv": "tab"}
    return [reports("02-csv-separators", ("recompute",), file, Outcome((0,), SIZE_20),
                    *((Outcome((2,), words=(cause,)),) if cause else ()), never=never) for file, cause in causes.items()]


def standstill():
    unweighted = Outcome((1,))
    return [reports("03-sweep-with-standstill", ("recompute",), file,
                    Outcome((0,), {"e_avg_arcmin": Near(0.0, 0.01), "e_max_arcmin": Near(1.539, 0.05)}), unweighted)
            for file in ("control.csv", "standstill_first.csv")]


def held():
    told = Outcome((0,), AXIS, QUIET, words=(r"position.*(held|repeat)",))
    return [reports("04-held-samples", ("diagnose",), "control.csv", Outcome((0,), AXIS, QUIET)),
            reports("04-held-samples", ("diagnose",), "position_held_2.csv", told, Outcome((2,), words=(r"position.*(held|repeat)",)),
                    never=(r'"effect_found"', "unnamed_structure"))]


def wrapped():
    never = ("ratio looks like", "sign is swapped", "look at the units", "-?nan\\b", "other direction")
    refused = Outcome((2,), words=(KINDS_OF_JUMP, r":\d+:"))
    te = {"e_max_arcmin": Near(1.61, 0.1), "lost_motion_arcmin": Near(-0.2, 0.02)}
    loop = {"k1_Nm_per_rad": share(15500.0, 0.002), "k2_Nm_per_rad": share(24500.0, 0.002), "k3_Nm_per_rad": share(28500.0, 0.002)}
    rows = [reports("05-wrapped-angle", ("recompute",), "control_te.csv", Outcome((0,), te))]
    for file, numbers in (("te_output_single_turn.csv", te), ("te_output_plus_minus_180.csv", te), ("hysteresis_0_360.csv", loop)):
        rows.append(reports("05-wrapped-angle", ("recompute",), file, Outcome((0,), numbers, words=(KINDS_OF_JUMP,)), refused,
                            never=never))
    fitted = {NOMINAL % name: near for name, near in loop.items()}
    lost = Outcome((0,), {"quantities.e_max_arcmin.measured": Near(1.61, 0.1)}, words=(KINDS_OF_JUMP, "backlash", "output_eccentricity"))
    for file, outcome in (("hysteresis_0_360.csv", Outcome((0,), fitted, QUIET, words=(KINDS_OF_JUMP,))),
                          ("te_output_single_turn.csv", lost), ("te_output_plus_minus_180.csv", lost),
                          ("control_motion.csv", Outcome((0,), AXIS, QUIET)),
                          ("motion_plus_minus_pi.csv", Outcome((0,), AXIS, QUIET, words=(KINDS_OF_JUMP,)))):
        rows.append(reports("05-wrapped-angle", ("diagnose",), file, outcome, refused, never=never))
    return rows


def data_sheets():
    odd = {"a_int8_limits_as_bytes": (r"drive\.eds:\d+:\d+:",), "e_no_product_number": (r"drive\.eds.*(?i:product)",), "m_control": ()}
    rows = [made("06-eds-of-makers", ("bench", "check"), name + "/bench.yaml", Outcome((0,), words=words), json=False)
            for name, words in odd.items()]
    return rows + [made("06-eds-of-makers", ("bench", "check"), "without_605D/bench.yaml",
                        Outcome((1, 2), words=("(?i)605D", "absent_objects")), json=False)]


def one_direction():
    """Apart they are not known: no value, or an error that holds the truth."""
    def not_apart(answer):
        for name, truth_Nm in (("coulomb_Nm", 1.2), ("offset_Nm", 0.4)):
            found = answer.number("nominal.parameters." + name) or {}
            value, se = found.get("value"), found.get("se")
            if value is not None and (se is None or se < 0.4 or abs(value - truth_Nm) > 4.0 * se):
                return "%s is %s ± %s (the truth is %g)" % (name, value, se, truth_Nm)
        return None
    return [reports("07-one-direction", ("diagnose",), "forward_only.csv",
                    Outcome((0,), {NOMINAL % "inertia_kgm2": share(0.05, 0.03), NOMINAL % "viscous_Nms_per_rad": share(0.3, 0.03)},
                            words=(r"(?i)one (direction|way)",), also=not_apart))]


def speed_unit():
    return [reports("08-speed-unit-guess", ("diagnose",), file, Outcome((0,))) for file in
            ("gear_60_teeth.csv", "control_gear_37_teeth.csv")]


def rated_torque():
    return [made("09-rated-torque-unit", ("bench", "check"), "micro/bench.yaml",
                 Outcome((1, 2, 3), words=(r"\b2390\b", r"\b1000\b", "µNm|uNm", r"rated_torque|6076")),
                 never=("00000956h",), json=False),
            made("09-rated-torque-unit", ("bench", "check"), "left_out/bench.yaml", Outcome((0,)), json=False)]


def quiet_encoder():
    return [reports("10-encoder-steps", ("diagnose",), file, Outcome((0,), texts=QUIET)) for file in
            ("control.csv", "encoder_17_bit.csv", "encoder_20_bit.csv")]


MOST_BY_CHANCE_PERCENT = 70.0  # of few specimens, each of several windows that are alike


def by_chance(answer):
    """Each specimen is left out once; a split of few specimens says little. Below half is chance as well."""
    scores = answer.number("folds.scores")
    far = {name: score["accuracy_percent"] for name, score in scores.items() if score["accuracy_percent"] > MOST_BY_CHANCE_PERCENT}
    return "unseen specimens: %s %%" % far if far else None


def four_specimens(answer):
    names = {campaign["specimen"] for campaign in answer.number("campaigns")}
    return "%d specimens" % len(names) if len(names) != 4 else by_chance(answer)


def train(report, folder, *outcomes):
    return Row(report, ("train", "{made}/%s/%s" % (report, folder), "--out", "{made}/predictor_of_" + folder, "--json"), outcomes)


def time_column():
    left_out = r"(?i)column '?%s\b.*(left out|no channel|refused|expected)"
    return [train("11-time-column", name, Outcome((0,), words=words, also=by_chance), Outcome((2,), words=words)) for name, words in
            (("Time", (left_out % "Time",)), ("Timestamp_s", (left_out % "Timestamp_s",)), ("control", ()))]


def file_as_specimen():
    told = Outcome((0,), words=(r"\b48\b.*\b4 folders.*48 specimens", "specimen:|'specimen'"), also=by_chance)
    return [train("12-file-as-specimen", "as_found", Outcome((0,), also=four_specimens), told),
            train("12-file-as-specimen", "specimen_named", Outcome((0,), also=four_specimens))]


EACH_COMMAND = (("features", "--set", "orders"), ("diagnose",))


def stamps():
    refused = Outcome((2,), words=("sample_rate_hz", "repeat"))
    files = (("control", ()), ("rounded_4_decimals", ("(?i)stamps?|time_s",)), ("rounded_4_decimals_with_rate", ()))
    return [reports("13-time-stamps", command, file + ".csv", Outcome((0,), words=words), refused)
            for command in EACH_COMMAND for file, words in files] + [
        train("13-time-stamps", file, Outcome((0,), words=words), refused) for file, words in files]


def two_rates():
    rates = (r"\b25600\b", r"\b12800\b")
    either = (Outcome((2,), words=rates), Outcome((0,), words=rates))
    return [reports("14-rate-contradiction", command, "rate_25600_time_12800.csv", *either) for command in EACH_COMMAND] + [
        train("14-rate-contradiction", "rate_25600_time_12800", *either)]


def old_host():
    """A network that has something to learn is trained and exported first. The host is served, or told of what is waited for."""
    def no_window_lost(answer):
        return "windows are lost" if re.search(r"windows? .*lost", answer.words()) else None
    script = "{program} train {made}/REPORT/loud --out {made}/REPORT/p --json && {program} export {made}/REPORT/p --out " \
        "{made}/REPORT/e && bash {reports}/REPORT/run.sh {program} {made}/REPORT/e {made}/REPORT/loud/r0.csv"
    return [Row("16-sparkplug-old-host", ("bash", "-c", script.replace("REPORT", "16-sparkplug-old-host")),
                (Outcome((0,), words=(r"heard by the host: .*spBv1\.0/g/",), also=no_window_lost),
                 Outcome((0,), words=("spBv1.0/STATE/scada", r"(?<!spBv1\.0/)STATE/scada"))))]


def frozen():
    return [reports("15-frozen-sensor", ("diagnose",), "control.csv", Outcome((0,), AXIS, QUIET)),
            reports("15-frozen-sensor", ("diagnose",), "torque_stands_still.csv",
                    Outcome((0,), AXIS, QUIET, words=(r"torque.*repeat|repeat.*torque|torque.*stood still", "80 ")),
                    never=(r'"causes": \[\s*\{',))]


def hdf5_filters():
    never = ("plugins", "column 'time_s' is missing")
    causes = {"lzf.h5": ("LZF", "gzip|GZIP"), "compound.h5": ("'table'", "several values")}
    slopes = (16000.0, 25000.0, 29000.0)
    read = Outcome((0,), {"k%d_Nm_per_rad" % (k + 1): share(slope, 0.01) for k, slope in enumerate(slopes)})
    return [made("17-hdf5-filters", ("recompute",), file, read, Outcome((2,), words=words), never=never)
            for file, words in causes.items()] + [made("17-hdf5-filters", ("recompute",), "control_gzip.h5", read)]


def no_break_space():
    return [made("18-nbsp-unit", ("validate",), "nbsp.yaml", Outcome((0,)), Outcome((2,), words=(r"U\+00A0",)), json=False)]


def huge_values():
    return [reports("20-bench", ("features",), "vibration_1e200.csv", Outcome((0, 2))),
            reports("20-bench", ("diagnose",), "hysteresis_1e200.csv", Outcome((0, 2))),
            reports("20-bench", ("recompute",), "hysteresis_1e200.csv", Outcome((0, 1, 2)))]


ROWS = sum((make() for make in (
    misspelt_knees, separators, standstill, held, wrapped, data_sheets, one_direction, speed_unit, rated_torque, quiet_encoder,
    time_column, file_as_specimen, stamps, two_rates, frozen, old_host, hdf5_filters, no_break_space, huge_values)), [])
