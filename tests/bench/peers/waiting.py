# SPDX-License-Identifier: Apache-2.0
"""A test waits for an event and never for a time."""
import time


def until(condition, seconds=60.0):
    """What the condition gives once it is true; AssertionError if that does not happen."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if value := condition():
            return value
        time.sleep(0.01)
    raise AssertionError("it did not happen")
