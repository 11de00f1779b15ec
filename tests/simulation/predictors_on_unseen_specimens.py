#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What predictors from vibration are worth on reducers that they have not seen, and what noise of the sensors does to it.

  tests/simulation/predictors_on_unseen_specimens.py --specimens 16 --noise 1 4 16 --baseline 5 --out study

Each specimen is one reducer on the embedded bench with another seed: --cycles cycles of 4 h at 55 Nm, a measurement after
each, a third of a life; --hours 11 is nearly the whole. --torque 35 55 has each specimen carry a load of its own between
these, as machines in the field do; --wear-scatter 0.5 has them wear at rates that differ more than the plant's own 12 %
(makers give wave-generator bearings an L50 of five times their L10: lives differ by a standard deviation of ln 5 / 1.28 in
their logarithm). `train` leaves whole specimens out in turn; the table shows what it reports. Noise
multiplies that of the accelerometers. Folders that are there already are not run again.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

CHECKOUT = pathlib.Path(__file__).resolve().parents[2]
SENSOR_NOISE_M_PER_S2 = 0.01  # the plant's own


def torque_of(seed, least_Nm, greatest_Nm):
    """Spread evenly over the range, whatever number of specimens there is."""
    golden_ratio = (5**0.5 - 1) / 2
    return round(least_Nm + (greatest_Nm - least_Nm) * (seed * golden_ratio % 1.0), 1)


def schedule_of(cycles, hours, seed, torque_Nm):
    """schedules/paper.yaml for a specimen of its own, with fewer and harder cycles."""
    text = (CHECKOUT / "schedules/paper.yaml").read_text(encoding="utf-8")
    load = re.search(r"  - kind: load_run\n.*?log_rate: [^\n]*\n", text, re.S).group()
    harder = load
    for old, new in (("30 min", f"{hours:g} h"), ("40 Nm", f"{torque_Nm:g} Nm"), ("1 Hz", "0.1 Hz")):
        assert old in load
        harder = harder.replace(old, new)
    text = re.sub(r"^cycles: .*$", f"cycles: {cycles}", text.replace(load, harder), flags=re.M)
    return text.replace("identity: SIM-0001", f"identity: SIM-{seed:04}")


def bench_of(text, seed, noise, wear_scatter):
    assert text.count("  seed: 1\n") == 1 and text.count("  plant: []") == 1, "not the embedded bench file"
    terms = f"    - {{term: vibration_noise, parameters: {{sensor_m_per_s2: {noise * SENSOR_NOISE_M_PER_S2}}}}}\n"
    if wear_scatter:
        terms += f"    - {{term: specimen_scatter, parameters: {{wear_rate: {wear_scatter}}}}}\n"
    return text.replace("  seed: 1\n", f"  seed: {seed}\n").replace("  plant: []", f"  plant:\n{terms}  # ")


def run(command):
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: exit {result.returncode}\n{result.stderr}")
    return result.stdout


def show_scores(contestants):
    for name, scores in contestants.items():
        own = " ".join(f"{key.split('_')[0] if key[0] == 'k' else key[:5]} {value['mape_percent']:.3f}"
                       for key, value in scores.items() if isinstance(value, dict))
        print(f"    {name:24} mean {scores['mean_mape_percent']:7.3f}   {own}")


def show(report, noise):
    print(f"\nnoise of the accelerometers × {noise}")
    for split in report["splits"]:
        print(f"  {split['split']} ({split['train']} records to train, {split['test']} to test), MAPE in %:")
        show_scores(split["scores"])
    folds = report["folds"]
    print(f"  all {len(folds['error_percent'])} folds of {folds['of']}, each left out in turn, MAPE in %:")
    show_scores(folds["scores"])
    print("  90 % intervals held " + ", ".join(f"{100 * share:.1f}" for share in folds["interval_coverage"]) + " %", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--specimens", type=int, default=16)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--cycles", type=int, default=60)
    parser.add_argument("--noise", type=float, nargs="+", default=[1.0])
    parser.add_argument("--hours", type=float, default=4.0, help="of load in each cycle")
    parser.add_argument("--torque", type=float, nargs=2, default=[55.0, 55.0], metavar=("LEAST", "GREATEST"), help="Nm")
    parser.add_argument("--wear-scatter", type=float, default=0.0, help="of the rates, in their logarithm; 0: the plant's")
    parser.add_argument("--baseline", type=int, default=0, help="of train")
    parser.add_argument("--set", default="wavelet", help="of train")
    parser.add_argument("--folds", type=int, default=8)
    parser.add_argument("--program", type=pathlib.Path, default=CHECKOUT / "build/strainwave")
    parser.add_argument("--out", type=pathlib.Path, required=True)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    first = options.out / "embedded"
    if not first.exists():
        # A campaign freezes the bench that it ran on; the embedded one comes from there.
        run([options.program, "run", CHECKOUT / "tests/simulation/small.yaml", "--out", first])
    embedded = (first / "bench.yaml").read_text(encoding="utf-8")
    for noise in options.noise:
        campaigns = []
        for seed in range(options.first_seed, options.first_seed + options.specimens):
            torque_Nm = torque_of(seed, *options.torque)
            name = f"specimen-{seed}-noise-{noise:g}"
            if options.hours != 4.0:
                name += f"-hours-{options.hours:g}"
            if options.torque != [55.0, 55.0]:
                name += f"-load-{torque_Nm:g}"
            if options.wear_scatter:
                name += f"-wear-{options.wear_scatter:g}"
            bench, schedule = options.out / f"{name}-bench.yaml", options.out / f"{name}.yaml"
            campaign = options.out / name
            if not campaign.exists():
                bench.write_text(bench_of(embedded, seed, noise, options.wear_scatter), encoding="utf-8")
                schedule.write_text(schedule_of(options.cycles, options.hours, seed, torque_Nm), encoding="utf-8")
                run([options.program, "run", schedule, "--bench", bench, "--out", campaign])
                print(f"{name} ran", file=sys.stderr, flush=True)
            campaigns.append(campaign)
        report = json.loads(run([options.program, "train", *campaigns, "--folds", str(options.folds), "--baseline",
                                 str(options.baseline), "--set", options.set, "--json", "--out",
                                 options.out / f"predictor-noise-{noise:g}"]))
        show(report, noise)


if __name__ == "__main__":
    main()
