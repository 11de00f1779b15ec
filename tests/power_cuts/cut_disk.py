# SPDX-License-Identifier: Apache-2.0
"""Runs a program on power_cut_disk.cc."""
import contextlib
import dataclasses
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile

SKIPPED = 77  # SKIP_RETURN_CODE of ctest
LONGEST_RUN_S = 120  # against hanging; a run takes less than one


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What a program on the disk came to."""
    code: int  # of the program that ran last; below zero: killed
    text: str  # what it said
    cut: bool
    operations: int
    last_operation: str
    syncs: int
    failed_sync: str
    met: int  # operations that a fault may be in
    failed: str  # the first that failed by the plan of faults


def ended(server):
    """What it has to say at its end. A signal between two of libfuse's looks is not seen until the next one."""
    while True:
        server.terminate()
        try:
            return server.communicate(timeout=1)[0]
        except subprocess.TimeoutExpired:
            continue


class CutDisk:
    """A folder: `disk` is what the file system holds while nothing is mounted; `seen` and `synced` are of the last cut."""

    def __init__(self, server, folder):
        self.server = server
        self.folder = folder
        folder.mkdir()
        for name in ("disk", "mounted"):
            (folder / name).mkdir()

    def side(self, name):
        return self.folder / name / "campaign"

    def mend(self):
        """A fault that lasts is over."""
        self.serving.send_signal(signal.SIGUSR1)

    def change_pace(self):
        """Writes become slow, or quick again."""
        self.serving.send_signal(signal.SIGUSR2)

    @contextlib.contextmanager
    def mounted(self, **options):
        """Yields where it is mounted, and what comes to hold what the server has to say at the end."""
        for name in ("seen", "synced"):
            shutil.rmtree(self.folder / name, ignore_errors=True)
        words = [f"{name.replace('_', '-')}={value}" for name, value in options.items() if value is not None]
        command = [self.server, self.folder, self.folder / "mounted", *words]
        server = self.serving = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        report = {}
        try:
            assert server.stdout.readline() == "mounted\n", "the file system of the test could not be mounted"
            yield self.folder / "mounted", report
        finally:
            report.update(json.loads(ended(server) or "{}"))

    def run(self, *commands, environment, **options):
        """Runs each command, which gets the folder of the campaign, one after the other; until the power is cut."""
        with self.mounted(**options) as (place, report), tempfile.TemporaryFile() as output:
            for command in commands:
                code = subprocess.run(command(place / "campaign"), stdout=output, stderr=subprocess.STDOUT, check=False,
                                      env={**os.environ, **environment}, timeout=LONGEST_RUN_S).returncode
                if code < 0:
                    break
            output.seek(0)
            text = output.read().decode(errors="replace")
        return Outcome(code=code, text=text, **report)


def begin_in_own_mounts():
    """Starts the script anew where what it mounts is seen by nobody else, and goes with it."""
    if os.environ.get("STRAINWAVE_OWN_MOUNTS") or os.geteuid() != 0:
        return
    own = ["unshare", "--mount", "--", sys.executable, "-B", *sys.orig_argv[sys.orig_argv.index(sys.argv[0]):]]
    os.execvpe(own[0], own, {**os.environ, "STRAINWAVE_OWN_MOUNTS": "1"})


def is_possible(server):
    """Why it is not, or nothing."""
    if not server.exists():
        return "libfuse3-dev was not installed when the tests were built"
    if not pathlib.Path("/dev/fuse").exists():
        return "there is no /dev/fuse"
    with tempfile.TemporaryDirectory() as folder:
        try:
            with CutDisk(server, pathlib.Path(folder) / "try").mounted():
                return ""
        except AssertionError as why:
            return str(why)
