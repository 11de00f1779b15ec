#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave life TIMES.csv` as a user calls it: beside survreg of R where that is, and everything that it says of bad
input, whole."""
import json
import math
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()

R = """
suppressMessages(library(survival))
d <- read.csv("r.csv")
fit <- survreg(Surv(lower, upper, type = "interval2") ~ 1, d)
se <- sqrt(diag(fit$var))
drop <- function(l) survreg(Surv(lower, upper, type = "interval2") ~ 1, d, scale = exp(l))$loglik[1] - fit$loglik[2] +
  qchisq(0.9, 1) / 2
at <- log(fit$scale)
ends <- sapply(c(-1, 1), function(s) uniroot(drop, sort(c(at, at + s * 6 * se[2])), tol = 1e-9)$root)
cat(1 / fit$scale, exp(coef(fit)), fit$loglik[2], predict(fit, d[1, ], type = "quantile", p = 0.1), exp(-ends[2]),
    exp(-ends[1]), exp(coef(fit) - qnorm(0.95) * se[1]), sep = " ")
"""


def has_survival():
    return shutil.which("Rscript") and subprocess.run(["Rscript", "-e", "library(survival)"], capture_output=True).returncode == 0


class Life(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def life(self, table, *options):
        (self.folder / "times.csv").write_text(table)
        return subprocess.run([PROGRAM, "life", "times.csv", *options], cwd=self.folder, capture_output=True, text=True)

    def json(self, table, *options):
        ran = self.life(table, *options, "--json")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        return json.loads(ran.stdout)

    def assert_refused(self, table, said, *options):
        ran = self.life(table, *options)
        self.assertEqual((ran.returncode, ran.stdout, ran.stderr), (2, "", said))

    def test_is_survreg_on_the_same_data(self):
        if not has_survival():
            self.skipTest("skipped, because there is no R with survival (apt-get install r-cran-survival)")
        draw = random.Random(5)
        ours, theirs = ["time_h,status,since_h"], ["lower,upper"]
        for i in range(60):
            life, end = draw.weibullvariate(3000, 1.4), draw.uniform(500, 5000)
            if life > end:
                ours.append(f"{end:.4f},suspended,")
                theirs.append(f"{end:.4f},NA")
            elif i % 5 == 0:
                ours.append(f"{1.2 * life:.4f},between,{0.8 * life:.4f}")
                theirs.append(f"{0.8 * life:.4f},{1.2 * life:.4f}")
            elif i % 7 == 0:
                ours.append(f"{1.5 * life:.4f},before,")
                theirs.append(f"NA,{1.5 * life:.4f}")
            else:
                ours.append(f"{life:.4f},failed,")
                theirs.append(f"{life:.4f},{life:.4f}")
        (self.folder / "r.csv").write_text("\n".join(theirs) + "\n")
        r = subprocess.run(["Rscript", "-e", R], cwd=self.folder, capture_output=True, text=True, check=True).stdout
        found = self.json("\n".join(ours) + "\n")["weibull"]
        b10 = found["quantiles"]["B10"]
        for mine, name, value in zip(
                (found["shape"]["value"], found["scale"]["value"], found["log_likelihood"], b10["value"],
                 *found["shape"]["likelihood_ratio"], found["scale"]["fisher"][0]),
                ("shape", "scale", "log-likelihood", "B10", "shape low", "shape high", "Fisher's low scale"), r.split()):
            self.assertAlmostEqual(mine / float(value), 1.0, 4, name)

    def test_tells_weibayes_where_nothing_failed(self):
        found = self.json("time_h,status,count\n1750,suspended,5\n", "--shape", "2")["weibayes"]
        self.assertIsNone(found["B10"]["value"])
        # 5 units: R of 0.05^(1/5) at 1750 h with 95 %.
        expected = 1750 * math.sqrt(math.log(0.9) / (math.log(0.05) / 5))
        self.assertAlmostEqual(found["B10"]["interval"][0], expected, 6)
        self.assertIsNone(found["B10"]["interval"][1])
        self.assertEqual([row["shape"] for row in found["sensitivity"]], [1, 1.5, 2, 3, 4])

    def test_one_failure_is_fitted_with_a_warning(self):
        ran = self.life("time_h,status\n100,failed\n150,suspended\n200,suspended\n250,suspended\n300,suspended\n")
        self.assertEqual(ran.returncode, 0)
        self.assertEqual(ran.stderr, "warning: one failure hardly tells a shape: take --shape, for Weibayes, where it is "
                                     "known from elsewhere\n")

    def test_two_modes_compete(self):
        table = ("time_h,status,mode\n100,failed,fracture\n400,failed,fracture\n900,failed,fracture\n1200,failed,wear\n"
                 "1300,failed,wear\n1500,failed,wear\n1600,suspended,\n")
        found = self.json(table)
        self.assertEqual(list(found["modes"]), ["fracture", "wear"])
        b10 = found["system"]["B10"]
        self.assertLess(b10["value"], found["modes"]["fracture"]["quantiles"]["B10"]["value"])
        self.assertGreater(b10["low"], 0)

    def test_draws_the_weibull_paper_of_the_docs(self):
        """docs/life_weibull.svg is this picture; to renew it, copy what the program draws of the table in docs/life.md."""
        table = "time_h,status\n1200,failed\n1900,failed\n2400,failed\n2600,suspended\n2600,suspended\n"
        ran = self.life(table, "--at", "1000", "--plots", "pictures")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertIn("picture: pictures/weibull.svg (and .png)\n", ran.stdout)
        svg = (self.folder / "pictures/weibull.svg").read_text()
        self.assertIn("failures at median ranks", svg)
        docs = pathlib.Path(__file__).parents[2] / "docs/life_weibull.svg"
        self.assertEqual(svg, docs.read_text(), "docs/life_weibull.svg is another picture")

    def test_no_failure_and_no_shape_is_refused(self):
        self.assert_refused("time_h,status,count\n1750,suspended,5\n",
                            "times.csv: error: none of 5 units has failed: no law can be fitted (expected a shape, for "
                            "Weibayes: --shape; the maker's L10 and L50 have 1.17)\n")

    def test_equal_times_are_refused(self):
        self.assert_refused("time_h,status\n100,failed\n100,failed\n",
                            "times.csv: error: all 2 failures may lie at one time, 100, which no other unit outlived: the "
                            "likelihood grows with the shape without end (expected failures at different times, or a "
                            "shape, for Weibayes: --shape; the maker's L10 and L50 have 1.17)\n")

    def test_everything_wrong_is_told_at_once(self):
        self.assert_refused(
            "unit,time_h,status,since_h,mode\nA,-3,failed,,wear\nB,0,suspended,,\nC,x,failed,,wear\nD,100,between,200,wear\n"
            "E,100,gone,,\nF,100,suspended,,wear\nG,50,failed,,\nH,50\nI,60,failed,,wear\nI,70,failed,,wear\nJ,50,ran,,\n",
            "times.csv:2:3: error: time_h is '-3' (expected a number above zero)\n"
            "times.csv:3:3: error: time_h is '0' (expected a number above zero)\n"
            "times.csv:4:3: error: time_h is 'x' (expected a number above zero)\n"
            "times.csv:5:15: error: since_h = 200 is not before time_h = 100 (expected the interval that the failure lies "
            "in)\n"
            "times.csv:6:7: error: status is 'gone' (expected failed, suspended, before, between or ran)\n"
            "times.csv:7:18: error: a suspended unit has mode 'wear' (expected a mode of failures alone)\n"
            "times.csv:8:14: error: a failure has no mode (expected what failed, in a word, of each failure)\n"
            "times.csv:9:1: error: 2 cells (expected 5, one a column)\n"
            "times.csv:11:1: error: unit 'I' ends twice (expected each unit once, but for steps that it ran on from)\n"
            "times.csv:12:1: error: unit 'J' ran on, and no row says how it ended (expected a row with a later time and "
            "another status)\n")

    def test_a_table_that_is_none_is_refused(self):
        self.assert_refused("unit,status\nA,failed\n", "times.csv:1:1: error: no column says the times (expected one whose name "
                                                       "ends in their unit, such as time_h or time_cycles)\n")
        self.assert_refused("time_h,time_cycles\n1,2\n", "times.csv:1:1: error: 2 columns say times (expected one whose name "
                                                         "ends in their unit, such as time_h or time_cycles)\n")
        self.assert_refused("time_h,status\n", "times.csv: error: has no unit (expected a header such as "
                                               "unit,time_h,status and a row for each)\n")
        self.assert_refused("time_h\n1\n2\n", "--bounds: error: 'wald' are no bounds (expected lr, lr-plain or fisher)\n",
                            "--bounds", "wald")

    def test_steps_of_torque_count_by_the_cube_law(self):
        plain, stepped = ["time_h,status"], ["unit,time_h,status,torque_Nm"]
        for i, life in enumerate((900, 1500, 2000, 2600, 3300)):
            plain.append(f"{life},failed")
            stepped.append(f"U{i},400,ran,34")
            stepped.append(f"U{i},{400 + (life - 400) / 8},failed,68")
        plain, stepped = "\n".join(plain) + "\n", "\n".join(stepped) + "\n"
        expected = self.json(plain)["weibull"]["quantiles"]["B10"]
        found = self.json(stepped, "--use-torque", "34", "--exponents", "catalogue")
        self.assertAlmostEqual(found["quantiles"]["B10"]["value"] / expected["value"], 1.0, 4)
        self.assertAlmostEqual(found["quantiles"]["B10"]["low"] / expected["likelihood_ratio"][0], 1.0, 3)
        self.assertEqual(found["exponents"]["torque"]["value"], 3)
        ran = self.life(stepped)
        self.assertEqual(ran.stderr, "warning: loads count with --use-torque or --use-speed alone: times are taken as they "
                                     "are\n")

    def test_loads_that_tell_nothing_are_refused(self):
        table = "time_h,status,torque_Nm\n100,failed,50\n200,failed,50\n"
        self.assert_refused(table, "times.csv: error: torque is the same in all steps of all units: its exponent cannot be "
                                   "fitted (expected another torque of some units, or the catalogue's exponent)\n",
                            "--use-torque", "34", "--exponents", "fitted")
        self.assert_refused(table, "times.csv: error: has no column speed_rpm (expected the load of each unit, or of each of "
                                   "its steps)\n", "--use-speed", "1000")
        ran = self.life(table, "--use-torque", "34")
        self.assertEqual(ran.stderr, "warning: torque is the same in all steps of all units: its exponent is the "
                                     "catalogue's alone\n")

    def test_a_campaign_plans_the_test_that_shows_a_life(self):
        schedule = pathlib.Path(__file__).resolve().parents[2] / "schedules/paper.yaml"
        ran = subprocess.run([PROGRAM, "validate", schedule, "--show-life", "7000", "--shape", "1", "--json"],
                             capture_output=True, text=True, check=True)
        whole = json.loads(ran.stdout)
        plan = whole["show_life"]
        # The share of L10 = 7000 h; ln 0.1 / (n ln 0.9) lives of each of n.
        self.assertAlmostEqual(plan["campaign_rated_h"], 7000 * whole["bearing_life_share"], 6)
        three = next(row for row in plan["plans"] if row["specimens"] == 3 and row["failures_allowed"] == 0)
        self.assertAlmostEqual(three["rated_h_each"], 7000 * math.log(0.1) / (3 * math.log(0.9)), 6)
        number = plan["specimens_for_one_campaign_each"][0]
        self.assertEqual(number, math.ceil(7000 * math.log(0.1) / (plan["campaign_rated_h"] * math.log(0.9))))

    def test_what_is_not_used_is_told(self):
        ran = self.life("time_h,colour\n100,red\n200,red\n")
        self.assertEqual(ran.stderr, "warning: times.csv: there is no column status: every unit counts as failed\n"
                                     "warning: times.csv: column 'colour' is not used\n")


class Campaigns(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        schedule = pathlib.Path(__file__).resolve().parents[2] / "schedules/quick.yaml"
        (cls.folder / "short.yaml").write_text(schedule.read_text().replace("cycles: 12", "cycles: 2"))
        for source, name in ((schedule, "a"), (schedule, "b"), (cls.folder / "short.yaml", "short")):
            subprocess.run([PROGRAM, "run", source, "--out", cls.folder / name], capture_output=True, check=True)

    def life(self, *arguments):
        return subprocess.run([PROGRAM, "life", *arguments], cwd=self.folder, capture_output=True, text=True)

    def test_a_limit_that_is_not_approached_has_no_forecast(self):
        ran = self.life("a", "--limit", "k2_Nm_per_rad=80", "--json")
        self.assertEqual(ran.returncode, 0, ran.stderr)
        found = json.loads(ran.stdout)
        limit = found["campaigns"][0]["limits"][0]
        self.assertEqual((limit["approached"], limit["met_at_cycle"]), (False, None))
        self.assertAlmostEqual(limit["limit"], 0.8 * limit["first"], 6)
        self.assertNotIn("forecast", limit)
        self.assertIn("k2_Nm_per_rad", [row["name"] for row in found["features"]])
        self.assertEqual(ran.stderr, "warning: k2_Nm_per_rad: no life of others: one specimen tells nothing of how others "
                                     "differ (expected two campaigns at least, of different specimens; its own forecast needs "
                                     "one)\n")
        self.assertIn("not approached: no forecast", self.life("a", "--limit", "k2_Nm_per_rad=80").stdout)

    def test_one_specimen_twice_is_told(self):
        self.assertIn("warning: b: specimen SIM-0001 is in two campaigns: it counts as two\n", self.life("a", "b").stderr)

    def test_what_is_no_trend_is_refused(self):
        for arguments, said in ((("short",), "short: error: has 2 complete cycles (expected 8 at least, for a trend)\n"),
                                (("a", "./a"), "./a: error: is the campaign of a again (expected each campaign once)\n"),
                                (("a", "--limit", "k2=80", "--limit", "k2=70"),
                                 "--limit: error: k2 has two limits (expected one of each quantity)\n"),
                                (("a", "--limit", "k2=inf"), "--limit: error: 'k2=inf' is no limit (expected QUANTITY=PERCENT "
                                                             "of its first value, such as k2_Nm_per_rad=80)\n"),
                                (("a", "--limit", "k9=80"), "a: error: has no results of k9 (expected a quantity of it; "
                                                            "strainwave table lists them)\n"),
                                (("a", "--limit", "k2"), "--limit: error: 'k2' is no limit (expected QUANTITY=PERCENT of its "
                                                         "first value, such as k2_Nm_per_rad=80)\n")):
            ran = self.life(*arguments)
            self.assertEqual((ran.returncode, ran.stdout, ran.stderr), (2, "", said))


if __name__ == "__main__":
    unittest.main()
