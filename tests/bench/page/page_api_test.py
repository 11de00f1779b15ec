#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The live page as programs see it: `strainwave serve` beside a campaign that runs.

usage: page_api_test.py PROGRAM"""
import contextlib
import json
import os
import pathlib
import re
import signal
import socket
import sqlite3
import subprocess
import sys
import unittest

import h5py
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import live_page  # noqa: E402
from waiting import until  # noqa: E402

STREAMS, TABS = 50, 8


class ThePageOfACampaign(unittest.TestCase):
    """One that is over: three cycles."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.folder = live_page.FOLDER / "over"
        subprocess.run([live_page.PROGRAM, "run", live_page.SMALL, "--out", cls.folder], capture_output=True, check=True)
        cls.page = cls.stack.enter_context(live_page.page(live_page.PROGRAM, cls.folder))

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    def test_says_what_status_says(self):
        state, status = self.page.state(), live_page.status_of(self.folder)
        self.assertEqual((state["state"], state["safe"], state["campaign"], state["specimen"]),
                         ("complete", True, "over", "TEST-0001"))
        self.assertEqual((state["cycle"], state["cycles"], state["cycles_complete"], state["share"]), (3, 3, 3, 1.0))
        self.assertEqual(state["life_share"], status["life_share"])
        self.assertEqual(state["bench_time_s"], status["bench_time_s"])
        self.assertEqual((state["values"], state["eta_s"]), ([], 0.0))
        for quantity, result in status["last_results"].items():
            if isinstance(result, dict) and "value" in result:
                self.assertEqual(state["results"][quantity]["value"], result["value"])
        with contextlib.closing(sqlite3.connect(self.folder / "campaign.db")) as journal:
            (credited_s,) = journal.execute("SELECT SUM(credited_load_s) FROM phases").fetchone()
        self.assertAlmostEqual(state["credited_load_s"], credited_s, places=6)

    def test_has_the_cycles_as_the_journal_has_them(self):
        answer = self.page.json("/api/v1/cycles?quantities=k2_Nm_per_rad,e_max_arcmin")
        with contextlib.closing(sqlite3.connect(self.folder / "campaign.db")) as journal:
            for quantity, found in answer["quantities"].items():
                rows = journal.execute("SELECT value, standard_error FROM results WHERE quantity = ? AND repeat = 0 AND "
                                       "cycle > 0 ORDER BY cycle", (quantity,)).fetchall()
                self.assertEqual(len(rows), 3)
                self.assertEqual(list(zip(found["last"], found["last_standard_error"])), rows)
                self.assertEqual((found["min"], found["max"]), (found["last"], found["last"]))
        self.assertEqual((answer["cycle"], answer["bin_cycles"]), ([1, 2, 3], 1))
        whole = self.page.json("/api/v1/cycles?points=1&quantities=k2_Nm_per_rad")["quantities"]["k2_Nm_per_rad"]
        values = answer["quantities"]["k2_Nm_per_rad"]["last"]
        self.assertEqual((whole["min"], whole["max"], whole["last"]), ([min(values)], [max(values)], values[-1:]))

    def test_has_what_a_cycle_measured(self):
        newest, first = self.page.json("/api/v1/measurements"), self.page.json("/api/v1/measurements?cycle=1")
        self.assertEqual((newest["cycle"], first["cycle"]), (3, 1))
        with h5py.File(self.folder / "cycles/000003.h5") as records:
            loop = records["hysteresis/hysteresis_1"]
            vibration = records["measurement_rotation/vibration"]
            rate_Hz, samples = vibration.attrs["sample_rate_hz"], vibration["accel_x_m_per_s2"][:].astype(float)
            torque_Nm = loop["torque_Nm"][:]
        drawn = newest["hysteresis"]
        self.assertEqual(drawn["lock_angle_deg"], 0)
        self.assertAlmostEqual(max(drawn["torque_Nm"]), torque_Nm.max(), places=3)
        self.assertLess(max(drawn["twist_arcmin"]), 30)
        turn = newest["transmission_error"]["cw"]
        e_max = self.page.state()["results"]["e_max_arcmin"]["value"]
        self.assertAlmostEqual(max(turn["error_arcmin"]) - min(turn["error_arcmin"]), e_max, delta=0.2 * e_max)
        spectrum = newest["spectrum"]["accel_x_m_per_s2"]
        # The strongest line, by numpy of the whole record.
        window = numpy.hanning(len(samples))
        whole = 2 * abs(numpy.fft.rfft(window * (samples - samples.mean()))) / window.sum()
        strongest = whole.argmax() * rate_Hz / len(samples)
        at = numpy.argmax(spectrum["amplitude_m_per_s2"])
        self.assertAlmostEqual(spectrum["frequency_Hz"][at], strongest, delta=rate_Hz / 4096)
        self.assertAlmostEqual(spectrum["amplitude_m_per_s2"][at], whole.max(), delta=0.2 * whole.max())
        status, _, body = self.page.get("/api/v1/measurements?cycle=4")
        self.assertEqual((status, json.loads(body)["error"]), (400, "cycle = 4 is not complete (expected 1 to 3, or 0 for the newest)"))

    def test_has_the_extremes_of_every_reading(self):
        answer = self.page.json("/api/v1/live")
        self.assertEqual([channel["quantity"] for channel in answer["quantities"]],
                         ["output torque", "input speed", "gear temperature", "vibration RMS"])
        self.assertLess(answer["age_s"], 3600)
        largest_Nm = 0.0
        for cycle in range(4):
            with h5py.File(self.folder / f"cycles/{cycle:06d}.h5") as records:
                found = []
                records.visititems(lambda name, item: found.append(item[:]) if name.endswith("/torque_Nm") else None)
                largest_Nm = max([largest_Nm, *(torque_Nm.max() for torque_Nm in found)])
        torque, time_s = answer["whole"]["output torque"], answer["whole"]["bench_time_s"]
        # What was recorded is some of what was read, so no more than the largest reading.
        shown_Nm = max(value for value in torque["max"] if value is not None)
        self.assertGreaterEqual(shown_Nm, largest_Nm - 1e-4)
        self.assertLess(shown_Nm, 60)
        self.assertLessEqual(len(time_s), 160)
        self.assertAlmostEqual(time_s[-1] + answer["whole"]["bin_s"], self.page.state()["bench_time_s"],
                               delta=answer["whole"]["bin_s"] + 2)
        for low, high, last in zip(torque["min"], torque["max"], torque["last"]):
            self.assertTrue(low is None or low <= last <= high)

    def test_has_its_sources_and_no_camera(self):
        state = self.page.state()
        self.assertEqual([(source["source"], source["state"], source["samples"]) for source in state["sources"]],
                         [("simulated bench", "not running", None)])
        self.assertIsNone(state["picture"])

    def test_refuses_a_predictor_that_is_none(self):
        for more, sentence in ((["--predictor", "none"], "none/predictor.json: error: cannot be read (expected a predictor"),
                               (["--baseline", "none.json"], "--baseline requires --predictor")):
            done = subprocess.run([live_page.PROGRAM, "serve", self.folder, "--port", "0", *more], capture_output=True, text=True,
                                  check=False)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(sentence, done.stderr)

    def test_is_one_page_of_its_own_files(self):
        status, headers, body = self.page.get("/")
        self.assertEqual((status, headers["Content-Type"]), (200, "text/html; charset=utf-8"))
        for path in re.findall(rb'(?:src|href)="(/[^"]+)"', body):
            self.assertEqual(self.page.get(path.decode())[0], 200, path)
        self.assertIn("default-src 'none'; script-src 'self'; style-src 'self';", headers["Content-Security-Policy"])
        self.assertEqual(headers["X-Content-Type-Options"], "nosniff")

    def test_spends_no_time_on_packing(self):
        for path in "/uplot.mjs", "/api/v1/state":
            status, headers, body = self.page.get(path, {"Accept-Encoding": "gzip, deflate, br"})
            self.assertEqual((status, headers["Content-Encoding"], int(headers["Content-Length"])), (200, None, len(body)))

    def test_answers_what_is_wrong_in_a_sentence(self):
        for path, status, sentence in (
                ("/nothing", 404, "there is no /nothing here (expected / or /api/v1/state, cycles, alarms, measurements, "
                                  "prediction, live, picture, events, actions)"),
                ("/../../etc/passwd", 404, "there is no /../../etc/passwd here"),
                ("/%2e%2e/%2e%2e/etc/passwd", 404, "there is no /../../etc/passwd here"),
                ("/api/v1/cycles?points=0", 400, "points = '0' (expected a whole number from 1 to 5000)"),
                ("/api/v1/cycles?from=a", 400, "from = 'a' (expected a whole number"),
                ("/api/v1/actions", 405, "actions are sent by POST"),
                ("/api/v1/prediction", 404, "the page has no predictor (expected: strainwave serve DIR --predictor)"),
                ("/api/v1/picture", 404, "there is no picture (expected a camera that has given one)"),
        ):
            with self.subTest(path):
                got, headers, body = self.page.get(path)
                self.assertEqual((got, headers["Content-Type"]), (status, "application/json"))
                self.assertIn(sentence, json.loads(body)["error"])

    def test_answers_requests_that_are_none(self):
        host = b"Host: localhost\r\n"
        for name, request, more, status, sentence in (
                ("a method of files", b"DELETE / HTTP/1.1\r\n" + host + b"\r\n", None, 405, "DELETE is not done here"),
                ("another host", b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", None, 403, "not served under this name"),
                ("no host", b"GET / HTTP/1.1\r\n\r\n", None, 403, "not served under this name"),
                ("no HTTP", b"HELO example\r\n\r\n", None, 400, "the request cannot be read (expected HTTP/1.1)"),
                ("a long body", b"POST /api/v1/actions HTTP/1.1\r\n" + host + b"Content-Length: 1000000\r\n\r\n", bytes(1000000),
                 413, "the body has 1000000 bytes (expected at most 4096)"),
                ("no length", b"POST /api/v1/actions HTTP/1.1\r\n" + host + b"Transfer-Encoding: chunked\r\n\r\n", None, 411,
                 "the length of the body is not given"),
                ("two lengths", b"GET / HTTP/1.1\r\n" + host + b"Content-Length: 1\r\nContent-Length: 2\r\n\r\n", None, 400,
                 "Content-Length (expected one whole number)"),
                ("a long head", b"GET / HTTP/1.1\r\n" + host + b"X: " + b"x" * 20000, None, 431,
                 "the head of the request is too long (expected at most 8192 bytes)"),
                ("half a head", b"GET / HTTP/1.1\r\n", None, 408, "the request was not whole in time (expected: within 2 s)"),
                ("half a body", b"POST /api/v1/actions HTTP/1.1\r\n" + host + b"Content-Length: 10\r\n\r\n{", None, 408,
                 "the request was not whole in time"),
        ):
            with self.subTest(name):
                got = self.page.raw(request, more)
                self.assertTrue(got.startswith(f"HTTP/1.1 {status} ".encode()), got[:200])
                self.assertIn(sentence, json.loads(got.split(b"\r\n\r\n", 1)[1])["error"])

    def test_takes_actions_from_itself_alone(self):
        state = self.page.state()
        status, answer = self.page.act("stop_now", state["run"], state["token"], {"Origin": "http://evil.example"})
        self.assertEqual((status, answer["error"]), (403, "actions of another page are not taken (expected this page's own)"))
        status, answer, _ = self.page.post(b"{}", {"Content-Type": "text/plain"})
        self.assertEqual((status, answer["error"]), (400, "the Content-Type is not application/json (expected that of JSON)"))
        status, answer = self.page.act("stop_now", state["run"], state["token"], {"Origin": self.page.root})
        self.assertEqual((status, answer["why"]), (409, "not_running"))


class ThePageOfARunningCampaign(live_page.RunningCampaign):
    def test_is_stopped_at_once_though_many_look_on(self):
        process = self.begin()
        page = self.open_page()
        streams = [page.stream() for _ in range(STREAMS)]
        for stream in streams:
            self.addCleanup(stream.close)
            self.assertEqual(stream.next("state")["data"]["state"], "running")
        # What the tabs of a browser may leave open: silent connections, half a request, a question for cycles.
        for begun in (b"", b"GET /api/v1/st", b"GET /api/v1/cycles HTTP/1.1\r\nHost: localhost\r\n\r\n"):
            for _ in range(TABS):
                tab = socket.create_connection(("127.0.0.1", page.port), live_page.PATIENCE_s)
                self.addCleanup(tab.close)
                tab.sendall(begun)
        state = page.state()
        status, answer = page.act("stop_now", state["run"], state["token"])
        self.assertEqual((status, answer["sentence"]), (200, f"asked process {process.pid} for: quick stop"))
        self.assertEqual(process.wait(live_page.PATIENCE_s), 130)
        for stream in streams:
            while (last := stream.next("state")["data"])["state"] == "running":
                pass
            self.assertEqual((last["state"], last["safe"]), ("stopped", True))
            self.assertIn("torque off, brakes on", last["sentence"])

    def test_is_stopped_though_the_disk_is_full(self):
        disk = self.folder.with_name("disk")
        disk.mkdir()
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=40m", "tmpfs", disk], capture_output=True, check=False).returncode != 0:
            self.skipTest("because this machine lets no test mount a file system")
        self.addCleanup(subprocess.run, ["umount", "--lazy", disk], check=True)
        self.folder = disk / "running"
        process = self.begin()
        page = self.open_page()
        until(lambda: page.state()["values"])
        with contextlib.suppress(OSError), open(disk / "of somebody else", "wb", buffering=0) as other:
            while other.write(bytes(1 << 16)):
                pass
        status, answer = page.do("stop_now")
        self.assertEqual((status, answer["sentence"]), (200, f"asked process {process.pid} for: quick stop"))
        # 3: it stands, and could not write that down.
        self.assertIn(process.wait(live_page.PATIENCE_s), (130, 3))

    def test_acts_once_and_on_the_run_that_was_seen(self):
        process = self.begin()
        page = self.open_page_with_users()
        seen = page.state()
        self.assertEqual(page.act("pause", seen["run"], seen["token"])[0], 200)
        process.wait(live_page.PATIENCE_s)
        status, answer = page.act("stop_now", seen["run"], seen["token"])
        self.assertEqual((status, answer["why"]), (409, "done"))
        self.assertRegex(answer["error"], r"^done already at \d{4}-\d\d-\d\dT[\d:.]+Z: pause$")
        until(lambda: page.state()["state"] != "running")
        another = page.state()["token"]
        again = self.begin("--resume")
        until(lambda: page.state()["state"] == "running")
        self.assertNotEqual(page.state()["run"], seen["run"])
        for token in (another, page.state()["token"]):
            status, answer = page.act("stop_now", seen["run"], token)
            self.assertEqual((status, answer["why"]), (409, "stale"))
        self.assertIsNone(again.poll())

    def test_streams_what_happens_with_the_numbers_of_the_journal(self):
        process = self.begin()
        page = self.open_page()
        first = page.stream()
        self.addCleanup(first.close)
        self.assertEqual(first.answer.headers["Content-Type"], "text/event-stream")
        begun = first.next("journal")
        self.assertEqual(begun["id"], "1")
        self.assertEqual(begun["data"]["id"], 1)
        first.next("alive", "state")
        while not (values := first.next("state")["data"]["values"]):
            pass
        value = values[0]
        self.assertEqual((value["quantity"], value["unit"], value["limit"]), ("output torque", "Nm", 60))
        self.assertGreaterEqual(value["age_s"], 0)
        process.send_signal(signal.SIGINT)
        process.wait(live_page.PATIENCE_s)
        while (line := first.next("journal"))["data"]["code"] != "quick_stop":
            pass
        since = page.stream(last_event_id=str(int(line["id"]) - 1))
        self.addCleanup(since.close)
        self.assertEqual(since.next("journal", "state")["data"]["code"], "quick_stop")
        self.assertEqual(since.next("journal", "state")["event"], "state")

    def test_tells_of_a_folder_that_is_gone_and_of_its_return(self):
        self.begin()
        page = self.open_page()
        away = self.folder.with_name("away")
        self.folder.rename(away)
        state = until(lambda: (now := page.state())["state"] == "unreadable" and now)
        self.assertTrue(state["sentence"].startswith("the campaign's folder cannot be read: "), state["sentence"])
        self.assertEqual((state["safe"], state["values"]), (None, []))
        away.rename(self.folder)
        until(lambda: page.state()["state"] != "unreadable")

    def test_that_is_frozen_or_killed_holds_up_nothing(self):
        process = self.begin()
        page = self.open_page()
        page.process.send_signal(signal.SIGSTOP)
        before = live_page.status_of(self.folder)["bench_time_s"]
        until(lambda: live_page.status_of(self.folder)["bench_time_s"] > before + 20)
        page.process.kill()
        before = live_page.status_of(self.folder)["bench_time_s"]
        until(lambda: live_page.status_of(self.folder)["bench_time_s"] > before + 20)
        self.assertIsNone(process.poll())

    def test_calls_a_killed_run_interrupted_and_not_safe(self):
        process = self.begin()
        page = self.open_page()
        process.kill()
        process.wait()
        state = until(lambda: (now := page.state())["state"] != "running" and now)
        self.assertEqual((state["state"], state["safe"]), ("interrupted", None))


class RunWithItsPage(live_page.RunningCampaign):
    def test_serves_it_beside_and_after_the_run(self):
        process = self.begin("--serve", "--port", "0")
        said = self.folder.with_suffix(".txt")
        line = until(lambda: re.search(r"page: http://127.0.0.1:(\d+)/, in process (\d+)", said.read_text()))
        page = live_page.Page(int(line[1]), None)
        self.addCleanup(os.kill, int(line[2]), signal.SIGKILL)
        until(lambda: page.state()["values"])
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(live_page.PATIENCE_s), 130)
        until(lambda: page.state()["state"] == "stopped")

    def runs_without(self, why, *more):
        """The run says why it has no page, and goes on."""
        process = self.begin("--serve", *more)
        said = self.folder.with_suffix(".txt")
        until(lambda: f"warning: the campaign runs without its page: {why}" in said.read_text())
        self.assertIsNone(process.poll())

    def test_hands_it_the_predictor(self):
        self.runs_without("none/predictor.json: error: cannot be read (expected a predictor", "--port", "0", "--predictor", "none")

    def test_goes_on_without_it(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.runs_without(f"error: port {port} is taken by another program", "--port", str(port))


class TheCommand(unittest.TestCase):
    def said(self, *arguments):
        done = subprocess.run([live_page.PROGRAM, "serve", *map(str, arguments)], capture_output=True, text=True, check=False)
        self.assertEqual(done.stdout, "")
        return done.returncode, done.stderr

    def test_says_what_to_do_next(self):
        missing = live_page.FOLDER / "missing"
        self.assertEqual(self.said(missing), (2, f"{missing}: error: there is no such folder (expected that of a campaign, "
                                                 f"which strainwave run SCHEDULE --out {missing} makes)\n"))
        self.assertEqual(self.said(live_page.FOLDER), (2, f"{live_page.FOLDER}: error: not a campaign (expected a folder with schedule.yaml, "
                                                "bench.yaml and campaign.db)\n"))

    def test_names_a_port_that_is_free_perhaps(self):
        folder = live_page.FOLDER / "taken"
        with live_page.campaign(live_page.PROGRAM, folder), live_page.page(live_page.PROGRAM, folder) as page:
            self.assertEqual(self.said(folder, "--port", page.port),
                             (3, f"error: port {page.port} is taken by another program, perhaps another page (expected a free "
                                 f"one: --port {page.port + 1}, or --port 0 for any)\n"))

    def test_ends_well_when_it_is_asked_to(self):
        folder = live_page.FOLDER / "asked"
        with live_page.campaign(live_page.PROGRAM, folder) as campaign, live_page.page(live_page.PROGRAM, folder) as page:
            with contextlib.closing(page.stream()):
                page.process.send_signal(signal.SIGINT)
                self.assertEqual(page.process.wait(live_page.PATIENCE_s), 0)
            self.assertIsNone(campaign.poll())


if __name__ == "__main__":
    live_page.main()
