# SPDX-License-Identifier: Apache-2.0
"""Where a test's own server listens."""
import contextlib
import random
import socket


def free_port():
    """A port that nobody listens on. It lies below those that the kernel gives to connections (32768 on, Linux), so that
    none takes it before its server does."""
    while True:
        port = random.randrange(20000, 32768)
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port
