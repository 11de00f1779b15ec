# SPDX-License-Identifier: Apache-2.0
"""Strangers at a port, all at once: idle ones, ones that send a byte at a time and come back when they are closed, ones that
send what is no request, and ones that stop in the middle of one. And what a process has of memory and files meanwhile.

usage: flood.py PORT HALF     HALF: the beginning of a request, in hexadecimal digits; '': idle ones alone. Says `begun`; for
a line of input waits until the server has closed all but the slow ones, and says `closed`. Lasts until the end of its
input."""
import contextlib
import os
import pathlib
import selectors
import socket
import subprocess
import sys
import threading

PATIENCE_s = 60  # against hanging: no measure of anything
IDLE, SLOW = 500, 20


class Strangers:
    def __init__(self, port, half):
        self.port, self.half = port, half
        self.idle = [self.connect() for _ in range(IDLE)]
        self.slow, self.wrong = [], []
        if not half:
            return
        self.slow = [self.connect() for _ in range(SLOW)]
        self.wrong = [self.connect(text) for text in (half, b"\xff\0garbage\r\n\r\n", os.urandom(2000)) for _ in range(SLOW)]
        threading.Thread(target=self.drip, daemon=True).start()

    def connect(self, text=b""):
        client = socket.create_connection(("127.0.0.1", self.port), PATIENCE_s)
        with contextlib.suppress(ConnectionError):
            client.sendall(text)
        return client

    def drip(self):
        """One byte of the half request to each slow one, again and again."""
        at = 0
        while not threading.Event().wait(0.05):
            for place, client in enumerate(self.slow):
                try:
                    client.sendall(self.half[at % len(self.half):][:1])
                except OSError:
                    client.close()
                    with contextlib.suppress(OSError):  # the server may have ended
                        self.slow[place] = self.connect()
            at += 1

    def until_closed(self):
        """Whatever the server sends them before."""
        with selectors.DefaultSelector() as waiting:
            for client in self.idle + self.wrong:
                waiting.register(client, selectors.EVENT_READ)
            while waiting.get_map():
                ready = waiting.select(PATIENCE_s)
                assert ready, f"{len(waiting.get_map())} are still open"
                for key, _ in ready:
                    with contextlib.suppress(ConnectionError):
                        if key.fileobj.recv(65536):
                            continue
                    waiting.unregister(key.fileobj)


class Flood:
    """Strangers in a process of their own, which has files for so many; from now on until `end`."""

    def __init__(self, port, half):
        self.process = subprocess.Popen([sys.executable, "-B", __file__, str(port), half.hex()], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True)
        assert self.process.stdout.readline() == "begun\n"

    def until_closed(self):
        """Until the server has closed all but the slow ones."""
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        assert self.process.stdout.readline() == "closed\n"

    def end(self):
        self.process.communicate()

    def kill(self):
        self.process.kill()
        self.process.communicate()


def open_files(process):
    return len(list(pathlib.Path(f"/proc/{process.pid}/fd").iterdir()))


def peak_memory_bytes(process):
    """The most that it has had resident."""
    status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    return 1024 * int(next(line for line in status.splitlines() if line.startswith("VmHWM")).split()[1])


def main():
    strangers = Strangers(int(sys.argv[1]), bytes.fromhex(sys.argv[2]))
    print("begun", flush=True)
    for _ in sys.stdin:
        strangers.until_closed()
        print("closed", flush=True)


if __name__ == "__main__":
    main()
