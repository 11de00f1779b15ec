# SPDX-License-Identifier: Apache-2.0
"""A campaign and the page of it, each a process, and a client that speaks HTTP by itself."""
import contextlib
import http.client
import json
import pathlib
import re
import socket
import ssl
import subprocess
import sys
import tempfile
import unittest

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
        scheme, host, port = re.search(r": (https?)://([^/]+):(\d+)/ ", line).groups()
        yield Page(int(port), process, scheme, host)
    finally:
        ended(process)
        process.stdout.close()


def user(program, file, name, password, role):
    """Adds a user to a file of users."""
    subprocess.run([program, "users", str(file), "add", name, "--role", role], input=password + "\n", text=True,
                   capture_output=True, check=True)


class Page:
    """One who looks on; whoever logs in keeps the cookie."""

    def __init__(self, port, process, scheme="http", host="127.0.0.1", source=None):
        self.port, self.process, self.scheme, self.host = port, process, scheme, host
        self.source = (source, 0) if source else None
        self.root = f"{scheme}://{host}:{port}"
        self.cookie = {}
        self.tls = None

    def connection(self):
        more = {"timeout": PATIENCE_s, "source_address": self.source}
        if self.scheme == "http":
            return http.client.HTTPConnection(self.host, self.port, **more)
        return http.client.HTTPSConnection(self.host, self.port, context=self.tls, **more)

    def asked(self, method, path, body=None, headers=None):
        """Status, headers, body."""
        with contextlib.closing(self.connection()) as connection:
            connection.request(method, path, body, {**self.cookie, **(headers or {})})
            answer = connection.getresponse()
            return answer.status, answer.headers, answer.read()

    def trust(self, authority):
        """From now on certificates of that one are good."""
        self.tls = ssl.create_default_context(cafile=str(authority))

    def get(self, path, headers=None):
        """Status, headers, body."""
        return self.asked("GET", path, headers=headers)

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
        status, headers, answer = self.asked("POST", path, body, headers)
        return status, json.loads(answer), headers

    def log_in(self, name, password):
        """Status, answer, headers."""
        said = self.post(json.dumps({"name": name, "password": password}).encode(), {"Content-Type": "application/json"},
                         "/api/v1/login")
        if said[0] == 200:
            self.cookie = {"Cookie": said[2]["Set-Cookie"].split(";")[0]}
        return said

    def raw(self, text, more=None):
        """What comes for these bytes, until the server closes; `more` is sent after them, as far as it is taken."""
        with socket.create_connection((self.host, self.port), PATIENCE_s) as client:
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
        return Stream(self.connection(), {**self.cookie, **({"Last-Event-ID": last_event_id} if last_event_id else {})})


class Stream:
    """Server-sent events, one after the other."""

    def __init__(self, connection, headers):
        self.connection = connection
        self.connection.request("GET", "/api/v1/events", headers=headers)
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
