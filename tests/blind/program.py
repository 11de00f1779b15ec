# SPDX-License-Identifier: Apache-2.0
"""Runs the program under test as a user would, with its wall time, its CPU time and its peak memory."""
import dataclasses
import os
import signal
import subprocess
import tempfile
import time


@dataclasses.dataclass
class Answer:
    exit_code: int  # negative: the signal that ended it
    output: str
    errors: str
    wall_s: float
    cpu_s: float  # what a machine that has other things to do, too, does not make longer
    peak_rss_MB: float


def run_program(command, timeout_s):
    # Files, not pipes: nobody has to read while the program runs, so it can be waited for with its resource usage.
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        begun_s = time.monotonic()
        process = subprocess.Popen(command, stdout=output, stderr=errors, stdin=subprocess.DEVNULL)
        while True:
            pid, status, usage = os.wait4(process.pid, os.WNOHANG)
            if pid:
                break
            if time.monotonic() - begun_s > timeout_s:
                os.kill(process.pid, signal.SIGKILL)
                _, status, usage = os.wait4(process.pid, 0)
                break
            time.sleep(0.004)
        wall_s = time.monotonic() - begun_s
        process.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for stream in (output, errors):
            stream.seek(0)
            texts.append(stream.read().decode("utf-8", "replace"))
    return Answer(process.returncode, texts[0], texts[1], wall_s, usage.ru_utime + usage.ru_stime,
                  usage.ru_maxrss / 1024.0)
