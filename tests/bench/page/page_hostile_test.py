#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The live page under attack: what a stranger, a viewer or a damaged folder may send it does nothing to the campaign, holds nobody
up, and is answered in a sentence.

usage: page_hostile_test.py PROGRAM"""
import gzip
import json
import os
import pathlib
import shutil
import socket
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import flood  # noqa: E402
import live_page  # noqa: E402
from waiting import until  # noqa: E402

HOST = b"Host: localhost\r\n"
MiB = 1 << 20
CONNECTIONS = 300


def head(line, *lines):
    return b"\r\n".join((line + b" HTTP/1.1", b"Host: localhost", *lines, b"", b""))


class Attack(live_page.RunningCampaign):
    def setUp(self):
        super().setUp()
        self.process = self.begin()

    def tearDown(self):
        """Whatever was done, the campaign runs, and the page knows it and stops it."""
        page = getattr(self, "page", None)
        if page is None:
            return
        self.assertIsNone(self.process.poll())
        self.assertIsNone(page.process.poll())
        self.assertEqual(page.do("stop_now")[0], 200)
        self.assertEqual(self.process.wait(live_page.PATIENCE_s), 130)

    def memory_bytes(self):
        return flood.peak_memory_bytes(self.page.process)


class ByRequests(Attack):
    def setUp(self):
        super().setUp()
        self.page = self.open_page()

    def test_that_ask_for_many_parts_of_a_file(self):
        whole = self.page.get("/uplot.mjs")[2]
        before = self.memory_bytes()
        for parts in b"0-," * 2600 + b"0-", b"-," * 3900 + b"-", b"0-0", b"5-1", b"99999999999999999999-":
            for name in b"Range: ", b"RANGE:", b"X: a\nRange: ", b" Range : ", b"Range\t: ":
                got = self.page.raw(head(b"GET /uplot.mjs", name + b"bytes=" + parts))
                self.assertTrue(got.startswith(b"HTTP/1.1 200 OK\r\n") or got.startswith(b"HTTP/1.1 400 "), got[:100])
                self.assertLess(len(got), len(whole) + 2000)
        self.assertLess(self.memory_bytes(), before + 32 * MiB)

    def test_that_are_packed(self):
        bomb = gzip.compress(bytes(3 * MiB))[:4096]
        before = self.memory_bytes()
        for packing in b"gzip", b"br", b"deflate", b"nonsense":
            for path in b"/api/v1/actions", b"/api/v1/login", b"/api/v1/logout":
                got = self.page.raw(head(b"POST " + path, b"Content-Type: application/json", b"Content-Encoding: " + packing,
                                         b"Content-Length: %d" % len(bomb)) + bomb)
                self.assertTrue(got.startswith(b"HTTP/1.1 415 Unsupported Media Type\r\n"), got[:200])
                self.assertIn(b"the body is packed (expected plain JSON, without Content-Encoding)", got)
        self.assertLess(self.memory_bytes(), before + 32 * MiB)

    def test_that_want_another_protocol(self):
        upgrade = (b"Connection: Upgrade", b"Sec-WebSocket-Version: 13", b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==")
        for name in b"websocket", b"h2c":
            got = self.page.raw(head(b"GET /api/v1/state", b"Upgrade: " + name, *upgrade))
            self.assertTrue(got.startswith(b"HTTP/1.1 200 "), got[:100])
            self.assertNotIn(b"101 Switching", got)
        self.assertNotIn(b"HTTP/1.1 200", self.page.raw(b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"))
        self.assertNotIn(b"HTTP/1.1 200", self.page.raw(b"CONNECT localhost:22 HTTP/1.1\r\n" + HOST + b"\r\n"))
        self.assertNotIn(b"\r\n\r\n{", self.page.raw(b"TRACE / HTTP/1.1\r\n" + HOST + b"Cookie: secret\r\n\r\n").replace(b"\r\n\r\n{\"error", b""))

    def test_that_lead_out_of_the_page(self):
        for path in (b"/../../etc/passwd", b"/%2e%2e/%2e%2e/etc/passwd", b"/..%2f..%2fetc%2fpasswd", b"/%2e%2e%5c..%5cetc", b"//etc/passwd",
                     b"/page.mjs/../../../etc/passwd", b"/page.mjs%00.html", b"/%c0%ae%c0%ae/etc/passwd", b"/.%252e/etc/passwd",
                     b"http://evil.example/api/v1/state", b"/api/v1/../../etc/passwd", b"*", b"/" + b"a" * 7000):
            got = self.page.raw(head(b"GET " + path))
            self.assertRegex(got, rb"^HTTP/1\.1 40[04] ", path)
            self.assertNotIn(b"root:", got)
            json.loads(got.split(b"\r\n\r\n", 1)[1])

    def test_that_are_no_requests(self):
        for text in (b"\0" * 4000, os.urandom(4000), b"\r\n" * 2000, b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n" + HOST + b"\r\n",
                     head(b"GET /", b":" * 3000), head(b"GET /", *(b"A%d: b" % i for i in range(900))), head(b"GET /?" + b"&=" * 3000),
                     head(b"GET /?" + b"%" * 3000), head(b"POST /api/v1/actions", b"Content-Type: multipart/form-data; boundary=" + b"a" * 3000,
                                                         b"Content-Length: 4") + b"aaaa",
                     head(b"POST /api/v1/login", b"Content-Type: application/x-www-form-urlencoded", b"Content-Length: 4") + b"a=b&",
                     head(b"POST /api/v1/actions", b"Content-Type: application/json", b"Expect: 100-continue", b"Content-Length: 2") + b"{}"):
            got = self.page.raw(text)
            self.assertNotIn(b"HTTP/1.1 5", got, text[:60])
            self.assertEqual(self.page.get("/")[0], 200)

    def test_that_hold_connections_open(self):
        held = []
        for begun in (b"", b"G", b"GET / HTTP/1.1\r\nHost: loc", head(b"POST /api/v1/actions", b"Content-Length: 4000")) * 100:
            client = socket.create_connection(("127.0.0.1", self.page.port), live_page.PATIENCE_s)
            held.append(client)
            self.addCleanup(client.close)
            client.sendall(begun)
        # One that asks and takes nothing of the answer.
        for _ in range(50):
            client = socket.socket()
            client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1)
            self.addCleanup(client.close)
            client.connect(("127.0.0.1", self.page.port))
            client.sendall(head(b"GET /uplot.mjs"))
        self.assertEqual(self.page.state()["state"], "running")


    def test_of_hundreds_who_are_idle_or_slow_or_send_no_request(self):
        stream, files, before = self.page.stream(), flood.open_files(self.page.process), self.memory_bytes()
        self.addCleanup(stream.close)
        strangers = flood.Flood(self.page.port, head(b"POST /api/v1/actions", b"Content-Length: 4000")[:-2])
        self.addCleanup(strangers.kill)
        for _ in range(5):
            stream.next("alive", "state")
            self.assertEqual(self.page.state()["state"], "running")
            self.assertLess(flood.open_files(self.page.process), files + CONNECTIONS + 20)
        strangers.until_closed()
        stream.next("alive", "state")
        self.assertLess(self.memory_bytes(), before + 32 * MiB)
        print(f"memory {before / MiB:.1f} to {self.memory_bytes() / MiB:.1f} MiB", file=sys.stderr)


class ByActions(Attack):
    def setUp(self):
        super().setUp()
        self.page = self.open_page_with_users()

    def post(self, body):
        return self.page.post(body, {"Content-Type": "application/json"})[:2]

    def test_that_are_forged_or_replayed(self):
        seen = self.page.state()
        for token in "", "1", "1.", ".", seen["token"][:-1], seen["token"] + "0", "0" + seen["token"], "1." + "0" * 32, "\0", "9" * 4000:
            status, answer = self.page.act("stop_now", seen["run"], token[:3000])
            self.assertEqual((status, answer["why"]), (409, "token"), token[:40])
        for run in "", seen["run"][:-1], seen["run"] + "x", "0" * 16 + "-0":
            self.assertEqual(self.page.act("stop_now", run, seen["token"])[1]["why"], "stale")
        self.assertEqual(self.page.act("note", seen["run"], seen["token"], text="once")[0], 200)
        for action in "note", "pause", "stop_now":
            self.assertEqual(self.page.act(action, seen["run"], seen["token"], text="twice")[1]["why"], "done", action)
        other = live_page.Page(self.page.port, self.page.process)
        other.log_in("B. Schulz", "battery staple")
        self.assertEqual(other.act("stop_now", seen["run"], self.page.state()["token"])[1]["why"], "token")

    def test_that_are_no_json(self):
        fresh = {"run": self.page.state()["run"], "token": self.page.state()["token"]}
        for body in (b"", b"\0", b"[" * 4096, b'{"a":' * 800, b"null", b"[]", b'"stop_now"', b"{}", b'{"action":"stop_now"}', b"\xff\xfe",
                     b'{"action":"stop_now","run":1,"token":2}', json.dumps({**fresh, "action": ["stop_now"]}).encode(),
                     json.dumps({**fresh, "action": "../stop_now"}).encode(), json.dumps({**fresh, "action": "stop_now\0"}).encode(),
                     json.dumps({**fresh, "action": "acknowledge"})[:-1].encode() + b',"alarm":1e999}',
                     json.dumps({**fresh, "action": "acknowledge", "alarm": -1}).encode(),
                     json.dumps({**fresh, "action": "shelve", "alarm": 1}).encode()[:-1] + b',"for_s":NaN}',
                     json.dumps({**fresh, "action": "note", "text": "x"})[:-1].encode() + b',"text":"\\ud800"}'):
            status, answer = self.post(body)
            self.assertEqual((status, answer["why"]), (400, "request"), body[:60])
        self.assertEqual(self.page.state()["notes"], [])

    def test_with_words_that_act_on_whoever_reads_them(self):
        words = "<script>alert(1)</script>\x1b[2J\x1b]0;owned\x07\u202e\u0000\u0085'; DROP TABLE events;--"
        status, answer = self.page.do("note", text=words)
        self.assertEqual(status, 200, answer)
        note = until(lambda: self.page.state()["notes"])[0]
        self.assertEqual(note["author"], "A. Meier")
        self.assertIn("<script>alert(1)</script>", note["text"])
        shown = subprocess.run([live_page.PROGRAM, "status", self.folder], capture_output=True, check=True).stdout
        self.assertIn(b"<script>", shown)
        for byte in b"\x1b", b"\x07", b"\0", "\u202e".encode(), "\u0085".encode():
            self.assertNotIn(byte, shown)
        self.assertEqual(self.page.do("note", text="x" * 2001)[0], 400)

    def test_by_many_who_log_in_at_once(self):
        page = self.page
        body = json.dumps({"name": "A. Meier", "password": "wrong"}).encode()
        request = head(b"POST /api/v1/login", b"Content-Type: application/json", b"Content-Length: %d" % len(body)) + body
        clients = [socket.create_connection(("127.0.0.1", page.port), live_page.PATIENCE_s) for _ in range(200)]
        for client in clients:
            self.addCleanup(client.close)
            client.sendall(request)
        # In the middle of it.
        self.assertEqual(page.state()["state"], "running")
        said = [client.recv(65536) for client in clients]
        codes = [int(one.split()[1]) for one in said]
        self.assertEqual(codes.count(401), 1, "one password was looked at")
        self.assertEqual(codes.count(429), 199)
        self.assertEqual(page.state()["user"]["name"], "A. Meier", "who is logged in stays so")

    def test_by_one_who_logs_in_again_and_again(self):
        viewer = live_page.Page(self.page.port, self.page.process)
        first = None
        for _ in range(21):
            self.assertEqual(until(lambda: (now := viewer.log_in("B. Schulz", "battery staple"))[0] != 429 and now)[0], 200)
            first = first or viewer.cookie
        self.assertEqual(self.page.state()["user"]["name"], "A. Meier")
        viewer.cookie = first
        self.assertIsNone(viewer.state()["user"])


class ByTheFolder(live_page.RunningCampaign):
    def test_that_is_deleted_while_it_is_shown(self):
        process = self.begin()
        page = self.open_page_with_users()
        until(lambda: page.state()["values"])
        process.kill()
        process.wait()
        shutil.rmtree(self.folder)
        state = until(lambda: (now := page.state())["state"] == "unreadable" and now)
        self.assertTrue(state["sentence"].startswith("the campaign's folder cannot be read: "), state["sentence"])
        for path in "cycles", "alarms", "measurements":
            status, _, body = page.get(f"/api/v1/{path}")
            self.assertEqual(status, 503, path)
            self.assertIn("error", json.loads(body))
        for action, status, why in (("stop_now", 409, "not_running"), ("pause", 409, "not_running"), ("resume", 409, "unreadable"),
                                    ("note", 503, "journal")):
            got, answer = page.do(action, text="x")
            self.assertEqual((got, answer["why"]), (status, why), action)
        self.assertFalse(self.folder.exists(), "and nothing is made in its place")

    def test_whose_place_something_else_has_taken(self):
        process = self.begin()
        page = self.open_page()
        process.kill()
        process.wait()
        shutil.rmtree(self.folder)
        for what in (lambda: self.folder.write_bytes(b"a file"), lambda: self.folder.symlink_to(self.folder),
                     lambda: (self.folder.mkdir(), (self.folder / "campaign.db").write_bytes(os.urandom(100_000))),
                     lambda: (self.folder.mkdir(), os.mkfifo(self.folder / "campaign.db"))):
            what()
            until(lambda: page.state()["state"] == "unreadable")
            self.assertEqual(page.get("/")[0], 200)
            shutil.rmtree(self.folder) if self.folder.is_dir() and not self.folder.is_symlink() else self.folder.unlink()


if __name__ == "__main__":
    live_page.main()
