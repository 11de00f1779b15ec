#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A Weibull fit of 10 000 units, a third of them suspended, with likelihood-ratio bounds: life_benchmark beside
survreg of R (Debian's r-cran-survival), the same times, in turn. R fits and finds the bounds of the shape alone, where
survreg itself holds it fixed; life_benchmark has those of shape, scale and B10.
  tests/benchmarks/life_survreg.py build/benchmarks/life_benchmark"""
import pathlib
import random
import subprocess
import sys
import tempfile

UNITS = 10_000
TURNS = 3
R = """
suppressMessages(library(survival))
d <- read.table(commandArgs(TRUE)[1]); y <- Surv(d$V1, d$V2)
begun <- proc.time()[["elapsed"]]
fit <- survreg(y ~ 1)
drop <- function(l) survreg(y ~ 1, scale = exp(l))$loglik[1] - fit$loglik[2] + qchisq(0.9, 1) / 2
at <- log(fit$scale); se <- sqrt(fit$var[2, 2])
ends <- sapply(c(-1, 1), function(s) uniroot(drop, sort(c(at, at + s * 3 * se)), tol = 1e-7)$root)
cat(proc.time()[["elapsed"]] - begun, 1 / fit$scale, exp(coef(fit)), exp(-ends[2]), exp(-ends[1]), "\\n")
"""


def main():
    draw = random.Random(1)
    with tempfile.TemporaryDirectory() as folder:
        times = pathlib.Path(folder) / "times.txt"
        script = pathlib.Path(folder) / "fit.R"
        script.write_text(R)
        lines = []
        for _ in range(UNITS):
            life, end = draw.weibullvariate(1000, 2), draw.uniform(500, 3000)
            lines.append(f"{min(life, end):.6f} {int(life <= end)}\n")
        times.write_text("".join(lines))
        print(f"{UNITS} units; seconds, shape, scale, 90 % bounds of the shape (ours: and of B10)")
        for _ in range(TURNS):
            r = subprocess.run(["Rscript", script, times], check=True, capture_output=True, text=True).stdout.split()
            ours = subprocess.run([sys.argv[1], "fit", times], check=True, capture_output=True, text=True).stdout.split()
            ours.remove("s")
            print(f"survreg        {' '.join(r)}\nlife_benchmark {' '.join(ours)}   {float(r[0]) / float(ours[0]):.0f} times faster")


if __name__ == "__main__":
    main()
