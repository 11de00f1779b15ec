#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The live page looked at from another machine: what it takes to serve it so, and that nothing is seen without a login.
Other machines are other addresses of the loopback, to which a page that is served at all addresses answers, too.

usage: page_elsewhere_test.py PROGRAM"""
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import live_page  # noqa: E402
import test_certificates  # noqa: E402
from waiting import until  # noqa: E402

BENCH, DESK, INTRUDER = "127.0.0.2", "127.0.0.3", "127.0.0.4"
LOGIN = "from other machines the page is for who is logged in, and nobody is, or the login is over (expected: log in)"
ON_THE_WAY = "--tls CERT KEY, so that nobody reads passwords on the way"
WHO = ("--users FILE, so that only people whom you know look on (strainwave users FILE add NAME --role operator makes "
       "one)")


def setUpModule():
    global CERTIFICATES, USERS
    CERTIFICATES = test_certificates.make(live_page.FOLDER / "certificates", bench=f"IP:{BENCH},DNS:localhost")
    USERS = live_page.FOLDER / "users.yaml"
    live_page.user(live_page.PROGRAM, USERS, "A. Meier", "correct horse", "operator")
    live_page.user(live_page.PROGRAM, USERS, "B. Schulz", "battery staple", "viewer")


def guards():
    return ["--users", str(USERS), "--tls", str(CERTIFICATES / "bench.pem"), str(CERTIFICATES / "bench.key")]


class WhoIsElsewhere(live_page.RunningCampaign):
    def open_to_all(self, *more):
        """The page at every address of this machine, as nobody who is logged in sees it at the desk."""
        page = self.open_page("--listen", "0.0.0.0", *guards(), *more)
        return self.at(DESK, page)

    def at(self, source, page):
        elsewhere = live_page.Page(page.port, page.process, "https", BENCH, source)
        elsewhere.trust(CERTIFICATES / "ca.pem")
        return elsewhere

    def test_sees_nothing_without_a_login(self):
        self.begin()
        page = self.open_to_all()
        for path in "state", "cycles", "alarms", "measurements", "events", "nothing":
            status, headers, body = page.get(f"/api/v1/{path}")
            self.assertEqual((status, json.loads(body)), (401, {"error": LOGIN, "why": "login"}), path)
            self.assertIsNone(headers["Set-Cookie"])
        self.assertEqual(page.get("/%61pi/v1/state")[0], 401)
        status, answer = page.act("stop_now", "run", "1.00")
        self.assertEqual((status, answer), (401, {"error": LOGIN, "why": "login"}))
        for file in "/", "/page.mjs", "/page.css":
            self.assertEqual(page.get(file)[0], 200, file)
        self.assertNotIn(b"TEST-0001", page.get("/")[2])
        page.cookie = {"Cookie": "strainwave_" + 16 * "0" + "=" + 64 * "0"}
        self.assertEqual(page.get("/api/v1/state")[0], 401)

    def test_sees_all_and_stops_with_one(self):
        process = self.begin()
        page = self.open_to_all()
        self.assertEqual(page.log_in("B. Schulz", "battery staple")[0], 200)
        self.assertEqual(page.state()["user"], {"name": "B. Schulz", "role": "viewer"})
        stream = page.stream()
        self.addCleanup(stream.close)
        self.assertEqual(stream.next("state")["data"]["state"], "running")
        self.assertEqual(page.do("pause")[1]["why"], "role")
        status, answer = page.do("stop_now")
        self.assertEqual((status, answer["sentence"]), (200, f"asked process {process.pid} for: quick stop"))
        self.assertEqual(process.wait(live_page.PATIENCE_s), 130)

    def test_is_not_told_more_once_the_login_is_over(self):
        self.begin()
        page = self.open_to_all()
        page.log_in("A. Meier", "correct horse")
        stream = page.stream()
        self.addCleanup(stream.close)
        stream.next("state")
        page.post(b"{}", {"Content-Type": "application/json"}, "/api/v1/logout")
        self.assertEqual(stream.next("over")["data"], {"error": LOGIN, "why": "login"})
        self.assertEqual(stream.answer.read(), b"")
        self.assertEqual(page.get("/api/v1/state")[0], 401)

    def test_is_asked_for_its_name(self):
        self.begin()
        page = self.open_to_all("--host", "bench.example", "--host", "Bench")
        wrong = "the page is not served under this name (expected this machine's address, or a name of it that --host allows)"
        for host, status in (("bench.example", 200), ("BENCH:8443", 200), (BENCH, 200), (f"{BENCH}:1", 200), ("localhost", 200),
                             ("evil.example", 403), ("bench.example.evil.example", 403), (DESK, 403), ("0.0.0.0", 403), ("", 403)):
            got, _, body = page.get("/", {"Host": host})
            self.assertEqual(got, status, host)
            if status == 403:
                self.assertEqual(json.loads(body)["error"], wrong)
        login = json.dumps({"name": "A. Meier", "password": "correct horse"}).encode()
        said = page.post(login, {"Content-Type": "application/json", "Origin": "https://evil.example"}, "/api/v1/login")
        self.assertEqual((said[0], said[1]["error"]), (403, "actions of another page are not taken (expected this page's own)"))

    def test_keeps_nobody_out_by_guessing(self):
        self.begin()
        desk = self.open_to_all()
        self.assertEqual(desk.log_in("A. Meier", "correct horse")[0], 200)
        intruder = self.at(INTRUDER, desk)
        said = until(lambda: (now := intruder.log_in("A. Meier", "wrong"))[0] == 429 and now)
        self.assertRegex(said[1]["error"], r"^after a wrong password the next try waits: again in \d+ s$")
        # One who tries many names is slowed for all of them, and for a right password, too.
        until(lambda: any(intruder.log_in(f"name {i}", "wrong")[0] == 429 for i in range(20)))
        self.assertEqual(intruder.log_in("B. Schulz", "battery staple")[0], 429)
        self.assertEqual(self.at(DESK, desk).log_in("A. Meier", "correct horse")[0], 200)
        self.assertEqual(self.at(DESK, desk).log_in("B. Schulz", "battery staple")[0], 200)

    def test_comes_by_tls_alone(self):
        self.begin()
        page = self.open_to_all()
        self.assertNotIn(b"HTTP/1.1", page.raw(b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n"))
        self.assertEqual(page.get("/")[0], 200)


class RunWithItsPageForOthers(live_page.RunningCampaign):
    def test_serves_it_beside(self):
        process = self.begin("--serve", "--port", "0", "--listen", "0.0.0.0", "--host", "localhost", *guards())
        line = until(lambda: re.search(r"page: https://localhost:(\d+)/, in process (\d+)", self.folder.with_suffix(".txt").read_text()))
        self.addCleanup(os.kill, int(line[2]), signal.SIGKILL)
        page = live_page.Page(int(line[1]), None, "https", BENCH, DESK)
        page.trust(CERTIFICATES / "ca.pem")
        self.assertEqual(page.log_in("A. Meier", "correct horse")[0], 200)
        self.assertEqual(page.do("stop_now")[0], 200)
        self.assertEqual(process.wait(live_page.PATIENCE_s), 130)


class WhatIsMissing(unittest.TestCase):
    """Before anything is served, or run."""

    @classmethod
    def setUpClass(cls):
        cls.folder = live_page.FOLDER / "over"
        subprocess.run([live_page.PROGRAM, "run", live_page.SMALL, "--out", cls.folder], capture_output=True, check=True)

    def refused(self, *arguments, code=2):
        fresh = live_page.FOLDER / "fresh"
        said = [subprocess.run([live_page.PROGRAM, *map(str, command), *map(str, arguments)], capture_output=True, text=True, check=False)
                for command in (["serve", self.folder], ["run", live_page.SMALL, "--out", fresh, "--serve"])[: 2 if code == 2 else 1]]
        for one in said:
            self.assertEqual((one.returncode, one.stdout, one.stderr), (code, "", said[0].stderr))
        self.assertFalse(fresh.exists())
        return said[0].stderr

    def test_is_said_before_other_machines_reach_the_page(self):
        ssh = "or no --listen, and from the other machine: ssh -L 8080:127.0.0.1:8080 HOST"
        tls = guards()[2:]
        for address in "0.0.0.0", "192.0.2.7", "::", "2001:db8::1":
            self.assertEqual(self.refused("--listen", address),
                             f"--listen: error: other machines reach {address} (expected too: {WHO}; {ON_THE_WAY}; {ssh})\n")
        self.assertEqual(self.refused("--listen", "0.0.0.0", *tls),
                         f"--listen: error: other machines reach 0.0.0.0 (expected too: {WHO}; {ssh})\n")
        self.assertEqual(self.refused("--listen", "0.0.0.0", "--users", USERS, "--port", "9000"),
                         f"--listen: error: other machines reach 0.0.0.0 (expected too: {ON_THE_WAY}; {ssh.replace('8080', '9000')})\n")

    def test_is_somebody_who_may_log_in(self):
        nobody = live_page.FOLDER / "nobody.yaml"
        nobody.write_text("users: 1\naccounts: []\n")
        nobody.chmod(0o600)
        self.assertEqual(self.refused("--listen", "0.0.0.0", *guards()[2:], "--users", nobody),
                         f"{nobody}: error: nobody could look at the page, for the file has no users (expected one: strainwave users "
                         f"{nobody} add NAME --role operator)\n")

    def test_is_an_address_of_this_machine(self):
        for text in "bench", "127.0.0.1:8080", "256.0.0.1", "":
            self.assertEqual(self.refused("--listen", text),
                             f"--listen: error: '{text}' is no IP address (expected one of this machine, as 192.0.2.7, or 0.0.0.0 for "
                             "all of them)\n")
        self.assertEqual(self.refused("--listen", "192.0.2.7", *guards(), code=3),
                         "error: 192.0.2.7 is no address of this machine (expected one that ip address lists, or 0.0.0.0 for all of "
                         "them)\n")

    def test_is_a_name(self):
        for name in "bench:8443", "a b", "-bench", "https://bench":
            self.assertEqual(self.refused("--listen", "0.0.0.0", f"--host={name}"),
                             f"--host: error: '{name}' is no name of a machine (expected letters, digits, hyphens and dots, without a "
                             "port)\n")


class ThePageOnAnotherAddressOfTheLoopback(live_page.RunningCampaign):
    def test_is_open_as_on_the_usual_one(self):
        self.begin()
        page = self.open_page("--listen", BENCH)
        self.assertEqual(page.get("/api/v1/state", {"Host": "localhost"})[0], 200)
        self.assertEqual(page.get("/api/v1/state", {"Host": "evil.example"})[0], 403)


if __name__ == "__main__":
    live_page.main()
