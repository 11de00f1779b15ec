# SPDX-License-Identifier: Apache-2.0
"""A short campaign on the simulated bench, the predictor trained on it, and its export: what a monitor needs."""
import pathlib
import re
import subprocess

QUICK = pathlib.Path(__file__).resolve().parents[3] / "schedules" / "quick.yaml"


def make(program, folder, cycles=25):
    """Returns (campaign, exported), both in the folder."""
    text, replaced = re.subn(r"^cycles: \d+", f"cycles: {cycles}", QUICK.read_text(), flags=re.M)
    assert replaced == 1
    schedule, campaign, predictor, exported = (folder / name for name in ("c.yaml", "campaign", "predictor", "exported"))
    schedule.write_text(text)
    for arguments in (["run", schedule, "--out", campaign], ["train", campaign, "--out", predictor, "--epochs", "20"],
                      ["export", predictor, "--out", exported, "--anyway"]):
        subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    return campaign, exported
