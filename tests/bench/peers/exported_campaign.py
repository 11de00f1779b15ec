# SPDX-License-Identifier: Apache-2.0
"""A short campaign on the simulated bench, the predictor trained on it, and its export: what a monitor needs."""
import fcntl
import hashlib
import pathlib
import re
import shutil
import subprocess

QUICK = pathlib.Path(__file__).resolve().parents[3] / "schedules" / "quick.yaml"


def make_in(program, folder, schedule):
    """campaign/, predictor/ and exported/, in the folder."""
    (folder / "c.yaml").write_text(schedule)
    campaign, predictor, exported = (folder / name for name in ("campaign", "predictor", "exported"))
    for arguments in (["run", folder / "c.yaml", "--out", campaign], ["train", campaign, "--out", predictor, "--epochs", "20"],
                      ["export", predictor, "--out", exported, "--anyway"]):
        subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)


def make(program, folder, cycles=25):
    """Returns (campaign, exported), both in the folder: a copy of what the same program has made of the same schedule
    before, which lies beside it; whoever comes first makes it, and the others wait for that."""
    schedule, replaced = re.subn(r"^cycles: \d+", f"cycles: {cycles}", QUICK.read_text(), flags=re.M)
    assert replaced == 1
    key = hashlib.sha256(pathlib.Path(program).read_bytes() + schedule.encode()).hexdigest()[:16]
    kept = pathlib.Path(program).resolve().parent / "tests" / "exported_campaigns"
    kept.mkdir(parents=True, exist_ok=True)
    with open(kept / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (kept / key).exists():
            for other in kept.iterdir():
                if other.is_dir():  # of another program or schedule, or not finished
                    shutil.rmtree(other)
            (kept / "under_way").mkdir()
            make_in(program, kept / "under_way", schedule)
            (kept / "under_way").rename(kept / key)
        shutil.copytree(kept / key, folder, dirs_exist_ok=True)
    return folder / "campaign", folder / "exported"
