# SPDX-License-Identifier: Apache-2.0
"""Figures of each generator side by side; the worst one leads."""
import report

from .registry import FIGURES_ONLY, GENERATORS

COLUMNS = ("right of what is clear", "clean: accused", "clean: no_effect", "one effect: right", "wrong or too many", "two: both",
           "outside: unnamed", "95 % intervals")


def _share(group, good):
    return {"count": sum(map(bool, map(good, group))), "of": len(group)}


def row(results):
    """Of one generator; an effect counts from 5 sigma on. `clean` is nothing hidden, wrong nominal numbers included."""
    def clear(situation):
        return [r for r in results if r["situation"] == situation and r["sigma"] and min(r["sigma"]) >= 5.0 * 0.99]
    clean = [r for r in results if r["situation"] in ("null", "wrong_number")]
    one, two, outside = clear("one"), clear("two"), clear("outside")
    counted = clean + one + two + outside
    shares = (_share(counted, lambda r: r["status"] in report.GOOD[r["situation"]]), _share(clean, lambda r: r["named"]),
              _share(clean, lambda r: r["status"] == "right"), _share(one, lambda r: r["status"] == "right"),
              _share(one, lambda r: r["excess"]), _share(two, lambda r: r["status"] == "both"),
              _share(outside, lambda r: r["status"] == "right"),
              _share([p for r in results for p in r["parameters"]], lambda p: p["inside"]))
    return dict(zip(COLUMNS, shares))


def _badness(item):
    leading = item[1][COLUMNS[0]]
    return leading["count"] / leading["of"] if leading["of"] else 2.0


def summarise(results):
    """[(generator, row)], the worst first."""
    names = {r["generator"] for r in results}
    rows = [(name, row([r for r in results if r["generator"] == name])) for name in sorted(names)]
    return sorted(rows, key=_badness)


def text(rows, results, seed):
    out = ["", "seed %d, effects of 5 sigma and up, the worst generator first" % seed, ""]
    out.append("%-24s%-14s" % ("generator", "role") + "".join("%-24s" % column for column in COLUMNS))
    for name, shares in rows:
        cells = ("%d of %d" % (share["count"], share["of"]) if share["of"] else "-" for share in shares.values())
        out.append("%-24s%-14s" % (name, GENERATORS[name].role) + "".join("%-24s" % cell for cell in cells))
    errors = sum(r["status"] == "error" for r in results)
    out += ["", "%d cases, %d without an answer" % (len(results), errors)]
    for name, _ in rows:
        if GENERATORS[name].role == FIGURES_ONLY:
            continue
        wrong = [r for r in results if r["generator"] == name and (r["status"] not in report.GOOD[r["situation"]] or r["excess"])]
        if wrong:
            out += ["", "%s, not right (again: --generator %s --only NUMBER):" % (name, name)]
            out += ["  " + report.failure_line(r) for r in wrong]
    return "\n".join(out)
