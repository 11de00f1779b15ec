# SPDX-License-Identifier: Apache-2.0
"""A campaign and the page of it, each a process, and a client that speaks HTTP by itself."""
import contextlib
import http.client
import json
import pathlib
import socket
import ssl
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

from waiting import until

SMALL = pathlib.Path(__file__).resolve().parents[2] / "simulation" / "small.yaml"
PROGRAM = ""  # of `main`
FOLDER = pathlib.Path()  # scratch, likewise
PATIENCE_s = 60  # against hanging: no measure of anything


def ended(process):
    """What is left of a process when a test is over."""
    process.kill()
    process.wait()


@contextlib.contextmanager
def campaign(program, folder, pace="20", *more):
    """A campaign that runs, until the end of the block."""
    with open(folder.with_suffix(".txt"), "w") as said:
        process = subprocess.Popen([program, "run", str(SMALL), "--out", str(folder), "--pace", pace, *more], stdout=said,
                                   stderr=said)
    try:
        # After the signals are listened to and the run has its id.
        until(lambda: (folder / "readings").exists() or process.poll() is not None)
        yield process
    finally:
        ended(process)


@contextlib.contextmanager
def page(program, folder, port=0, *more):
    """The page of a campaign; gives it as a Page."""
    process = subprocess.Popen([program, "serve", str(folder), "--port", str(port), *more], stdout=subprocess.PIPE, text=True)
    try:
        line = process.stdout.readline()
        assert "://127.0.0.1:" in line, line
        scheme, port = line.split(": ")[1].split("://127.0.0.1:")
        yield Page(int(port.split("/")[0]), process, scheme)
    finally:
        ended(process)
        process.stdout.close()


def user(program, file, name, password, role):
    """Adds a user to a file of users."""
    subprocess.run([program, "users", str(file), "add", name, "--role", role], input=password + "\n", text=True,
                   capture_output=True, check=True)


class Page:
    """One who looks on; whoever logs in keeps the cookie."""

    def __init__(self, port, process, scheme="http"):
        self.port, self.process = port, process
        self.root = f"{scheme}://127.0.0.1:{port}"
        self.cookie = {}
        self.tls = None

    def trust(self, authority):
        """From now on certificates of that one are good."""
        self.tls = ssl.create_default_context(cafile=str(authority))

    def get(self, path, headers=None):
        """Status, headers, body."""
        request = urllib.request.Request(self.root + path, headers={**self.cookie, **(headers or {})})
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_s, context=self.tls) as answer:
                return answer.status, answer.headers, answer.read()
        except urllib.error.HTTPError as error:
            with error:
                return error.code, error.headers, error.read()

    def json(self, path):
        return json.loads(self.get(path)[2])

    def state(self):
        return self.json("/api/v1/state")

    def act(self, action, run, token, headers=None, **more):
        """Status and answer."""
        body = json.dumps({"action": action, "run": run, "token": token, **more}).encode()
        return self.post(body, {"Content-Type": "application/json", **(headers or {})})[:2]

    def do(self, action, **more):
        """An action on what the page shows now: status and answer."""
        state = self.state()
        return self.act(action, state["run"], state["token"], **more)

    def post(self, body, headers, path="/api/v1/actions"):
        """Status, answer, headers."""
        request = urllib.request.Request(self.root + path, body, {**self.cookie, **headers}, method="POST")
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_s, context=self.tls) as answer:
                return answer.status, json.load(answer), answer.headers
        except urllib.error.HTTPError as error:
            with error:
                return error.code, json.load(error), error.headers

    def log_in(self, name, password):
        """Status, answer, headers."""
        said = self.post(json.dumps({"name": name, "password": password}).encode(), {"Content-Type": "application/json"},
                         "/api/v1/login")
        if said[0] == 200:
            self.cookie = {"Cookie": said[2]["Set-Cookie"].split(";")[0]}
        return said

    def raw(self, text, more=None):
        """What comes for these bytes, until the server closes; `more` is sent after them, as far as it is taken."""
        with socket.create_connection(("127.0.0.1", self.port), PATIENCE_s) as client:
            client.sendall(text)
            if more:
                with contextlib.suppress(OSError):
                    client.sendall(more)
            got = b""
            with contextlib.suppress(ConnectionError):
                while part := client.recv(65536):
                    got += part
            return got

    def stream(self, last_event_id=None):
        return Stream(self.port, last_event_id)


class Stream:
    """Server-sent events, one after the other."""

    def __init__(self, port, last_event_id=None):
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_s)
        self.connection.request("GET", "/api/v1/events", headers={"Last-Event-ID": last_event_id} if last_event_id else {})
        self.answer = self.connection.getresponse()

    def next(self, *names):
        """The next event of one of these names, as {"event", "id", "data"}."""
        event = {}
        while True:
            line = self.answer.readline().decode()
            assert line, "the stream has ended"
            name, _, value = line.rstrip("\n").partition(": ")
            if name:
                event[name] = value
            elif event.get("event") in names:
                return {**event, "data": json.loads(event["data"])}
            else:
                event = {}

    def close(self):
        self.answer.close()
        self.connection.close()


class RunningCampaign(unittest.TestCase):
    """What tests of a campaign that runs have in common; `main` says by which program."""

    def setUp(self):
        self.stack = contextlib.ExitStack()
        self.addCleanup(self.stack.close)
        self.folder = pathlib.Path(self.stack.enter_context(tempfile.TemporaryDirectory(dir=FOLDER))) / "running"

    def begin(self, *more):
        process = self.stack.enter_context(campaign(PROGRAM, self.folder, "20", *more))
        return process

    def open_page(self, *more):
        return self.stack.enter_context(page(PROGRAM, self.folder, 0, *more))

    def open_page_with_users(self):
        """Somebody who is logged in as an operator."""
        users = self.folder.with_name("users.yaml")
        user(PROGRAM, users, "A. Meier", "correct horse", "operator")
        user(PROGRAM, users, "B. Schulz", "battery staple", "viewer")
        page = self.open_page("--users", str(users))
        self.assertEqual(page.log_in("A. Meier", "correct horse")[0], 200)
        return page

    def status(self):
        return status_of(self.folder)


def status_of(folder):
    return json.loads(subprocess.run([PROGRAM, "status", folder, "--json"], capture_output=True, check=True).stdout)


def main():
    """Runs the tests of a script: its first argument is the program."""
    global PROGRAM, FOLDER
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main(module="__main__")
