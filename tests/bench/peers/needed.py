# SPDX-License-Identifier: Apache-2.0
"""What a test has to have of others."""
import contextlib
import pathlib
import sys

SKIPPED = 77  # SKIP_RETURN_CODE of ctest


@contextlib.contextmanager
def peers(*programs):
    """Imports of others stand within. Ends the test as skipped, in words, where one of them or a program is not there."""
    try:
        yield
        missing = [f"there is no {program}" for program in programs if not pathlib.Path(program).exists()]
    except ImportError as error:
        missing = [f"/usr/bin/python3 has no {error.name}"]
    if missing:
        print(f"skipped, because {missing[0]}")
        sys.exit(SKIPPED)
