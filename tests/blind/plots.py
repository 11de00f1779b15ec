# SPDX-License-Identifier: Apache-2.0
"""The detection curve and the confusion matrix, as CSV and through gnuplot as pictures."""
import collections
import shutil
import subprocess


def _draw(folder, name, width, height, commands):
    """The same commands for both formats; no gnuplot, no picture: the CSV holds all of it."""
    if not shutil.which("gnuplot"):
        return
    for terminal, ending in (("svg size %d,%d dynamic font 'Sans,11'" % (width, height), "svg"),
                             ("pngcairo size %d,%d font 'Sans,10'" % (width, height), "png")):
        script = ("set terminal %s\nset output '%s.%s'\nset datafile separator ','\n%s\n"
                  % (terminal, name, ending, commands))
        subprocess.run(["gnuplot", "/dev/stdin"], input=script, text=True, cwd=folder, check=False, stderr=subprocess.DEVNULL)


def _binomial_error(hits, of):
    """Half of the 68 % Wilson interval's ends, so that 0 and 1 have an error too."""
    centre, half = (hits + 0.5) / (of + 1.0), ((hits * (of - hits) / of + 0.25) ** 0.5) / (of + 1.0)
    return max(centre - half, 0.0), min(centre + half, 1.0)


def detection_curve(folder, results, edges):
    """Probability of the right name over the size of the effect, one effect hidden."""
    one = [r for r in results if r["situation"] == "one"]
    kinds = sorted({r["kind"] for r in one}) + ["all"]
    lines = ["kind,sigma_from,sigma_to,sigma_mean,cases,right,share,low,high"]
    for kind in kinds:
        for low, high in zip(edges[:-1], edges[1:]):
            # Sizes are met within half a percent, so the outer edges get that much room.
            inside = (low if low > edges[0] else 0.99 * low), (high if high < edges[-1] else 1.01 * high)
            group = [r for r in one if kind in (r["kind"], "all") and inside[0] <= r["sigma"][0] < inside[1]]
            if not group:
                continue
            right = sum(r["status"] == "right" for r in group)
            mean = sum(r["sigma"][0] for r in group) / len(group)
            bottom, top = _binomial_error(right, len(group))
            lines.append("%s,%g,%g,%.3f,%d,%d,%.4f,%.4f,%.4f"
                         % (kind, low, high, mean, len(group), right, right / len(group), bottom, top))
    (folder / "detection_curve.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    present = [kind for kind in kinds if any(line.startswith(kind + ",") for line in lines)]
    if not one:
        return
    curves = ", ".join("'detection_curve.csv' using (stringcolumn(1) eq '%s' ? $4 : NaN):7:8:9 "
                       "with yerrorlines lw %d pt 7 ps 0.6 title '%s'" % (kind, 3 if kind == "all" else 1, kind.replace("_", " "))
                       for kind in present)
    _draw(folder, "detection_curve", 900, 520, "set logscale x\nset xrange [2.8:62]\nset yrange [0:1.05]\nset grid\n"
          "set xtics (3,4,5,7,10,20,60)\nset datafile missing NaN\nset key bottom right\n"
          "set xlabel 'size of the hidden effect / sigma (matched filter)'\n"
          "set ylabel 'probability of the right name'\nplot " + curves)


def confusion(folder, results):
    """Rows: what was hidden; columns: what was named first, or the verdict without a name."""
    counts = collections.Counter()
    for result in results:
        if result["situation"] == "two":
            continue
        prefix = result["kind"] + "/"
        row = prefix + (result["true"][0] if result["true"] else "outside" if result["outside"] else "nothing")
        named = result["named"] or [result["verdict"] or "error"]
        # A right name counts as right here even if another one stands before it: the excess has its own number.
        first = result["true"][0] if result["true"] and result["true"][0] in named else named[0]
        counts[row, first] += 1
    rows = sorted({row for row, _ in counts})
    columns = sorted({column for _, column in counts})
    lines = ["hidden," + ",".join(columns)]
    lines += [row + "," + ",".join(str(counts[row, column]) for column in columns) for row in rows]
    (folder / "confusion.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    if not rows:
        return
    totals = {row: sum(counts[row, column] for column in columns) for row in rows}
    shares = ["%d,%d,%.4f,%d" % (i, j, counts[row, column] / totals[row], counts[row, column])
              for j, row in enumerate(rows) for i, column in enumerate(columns)]
    (folder / "confusion_shares.csv").write_text("\n".join(shares) + "\n", encoding="utf-8")

    def tics(names):
        return "(" + ", ".join("'%s' %d" % (name.replace("_", " "), index) for index, name in enumerate(names)) + ")"
    _draw(folder, "confusion", 420 + 32 * len(columns), 300 + 22 * len(rows),
          "set xtics %s rotate by 55 right\nset ytics %s\nset yrange [%g:-0.5]\nset xrange [-0.5:%g]\nunset key\n"
          "set cblabel 'share of the row'\nset cbrange [0:1]\nset palette defined (0 'white', 1 'steelblue')\n"
          "plot 'confusion_shares.csv' using 1:2:3 with image, '' using 1:2:($4 > 0 ? sprintf('%%d', $4) : '') with labels"
          % (tics(columns), tics(rows), len(rows) - 0.5, len(columns) - 0.5))
