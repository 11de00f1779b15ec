#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""People on the live page: who logs in, what they may do, what the journal says of it.

usage: page_people_test.py PROGRAM"""
import contextlib
import pathlib
import signal
import sqlite3
import ssl
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "peers"))
import live_page  # noqa: E402
import test_certificates  # noqa: E402
from waiting import until  # noqa: E402


class PeopleWhoLogIn(live_page.RunningCampaign):
    def events(self):
        with contextlib.closing(sqlite3.connect(self.folder / "campaign.db")) as journal:
            return journal.execute("SELECT severity, code, text FROM events ORDER BY id").fetchall()

    def test_act_and_the_journal_says_who_and_why(self):
        process = self.begin()
        page = self.open_page_with_users()
        self.assertEqual(page.state()["user"], {"name": "A. Meier", "role": "operator"})
        self.assertEqual(page.do("note", text="<b>grease</b>\nchanged")[0], 200)
        note = until(lambda: page.state()["notes"])[0]
        self.assertEqual((note["author"], note["text"]), ("A. Meier", "<b>grease</b>\nchanged"))
        self.assertEqual(page.do("pause", text="lunch")[0], 200)
        self.assertEqual(process.wait(live_page.PATIENCE_s), 130)
        action = ("action", "page_pause", "pause asked for on the page by A. Meier: lunch")
        until(lambda: action in self.events())
        self.assertEqual(until(lambda: (now := page.state())["process"] == 0 and now)["state"], "stopped")

    def test_go_on_with_a_campaign(self):
        process = self.begin()
        page = self.open_page_with_users()
        self.assertEqual(page.do("resume")[1]["error"], "the campaign runs already")
        page.do("stop_now")
        self.assertEqual(process.wait(live_page.PATIENCE_s), 130)
        until(lambda: page.state()["state"] == "stopped")
        status, answer = page.do("resume")
        self.assertEqual(status, 200, answer)
        self.assertRegex(answer["sentence"], r"^process \d+ goes on with the campaign$")
        state = until(lambda: (now := page.state())["state"] == "running" and now)
        self.assertIn(f"process {state['process']} ", answer["sentence"])
        page.process.send_signal(signal.SIGINT)
        self.assertEqual(page.process.wait(live_page.PATIENCE_s), 0)
        self.assertEqual(self.status()["process"], state["process"])
        subprocess.run([live_page.PROGRAM, "stop", self.folder, "quick-stop"], capture_output=True, check=True)
        until(lambda: self.status()["process"] == 0)

    def test_hear_why_a_campaign_does_not_go_on(self):
        process = self.begin()
        page = self.open_page_with_users()
        until(lambda: page.state()["values"])
        process.kill()
        process.wait()
        until(lambda: page.state()["state"] == "interrupted")
        status, answer = page.do("resume")
        self.assertEqual((status, answer["why"]), (400, "request"))
        self.assertIn("'text' must say what was looked at and mended", answer["error"])
        (self.folder / "schedule.yaml").write_text("schedule: 1\n")
        status, answer = page.do("resume", text="looked at the bench")
        self.assertEqual((status, answer["why"]), (409, "process"))
        self.assertIn("the campaign was not gone on with: ", answer["error"])

    def test_are_slowed_when_they_guess(self):
        self.begin()
        page = self.open_page_with_users()
        other = live_page.Page(page.port, page.process)
        wrong = "no user of that name has that password"
        status, answer, _ = other.log_in("A. Meier", "wrong")
        self.assertEqual((status, answer["error"]), (401, wrong))
        # Until it waits for long enough that the right password comes too early.
        until(lambda: (now := other.log_in("A. Meier", "wrong"))[0] == 429 and int(now[2]["Retry-After"]) > 4)
        status, answer, headers = other.log_in("A. Meier", "correct horse")
        self.assertEqual((status, answer["why"]), (429, "wait"))
        self.assertEqual(answer["error"], f"after a wrong password the next try waits: again in {headers['Retry-After']} s")
        self.assertEqual(other.log_in("nobody", "wrong")[1]["error"], wrong)
        until(lambda: other.log_in("A. Meier", "correct horse")[0] == 200)
        self.assertEqual(other.do("stop_now")[0], 200)

    def test_do_no_more_than_they_may(self):
        self.begin()
        page = self.open_page_with_users()
        viewer = live_page.Page(page.port, page.process)
        status, _, headers = viewer.log_in("B. Schulz", "battery staple")
        self.assertEqual(status, 200)
        self.assertRegex(headers["Set-Cookie"],
                         r"^strainwave_[0-9a-f]{16}=[0-9a-f]{64}; Path=/; HttpOnly; SameSite=Strict; Max-Age=43200$")
        status, answer = viewer.do("pause")
        self.assertEqual((status, answer["why"]), (403, "role"))
        nobody = live_page.Page(page.port, page.process)
        for action in "pause", "note", "resume":
            self.assertEqual(nobody.do(action, text="x")[1]["why"], "login", action)
        nobody.cookie = {"Cookie": viewer.cookie["Cookie"][:-1]}
        self.assertIsNone(nobody.state()["user"])
        seen = viewer.state()
        self.assertEqual(page.act("pause", seen["run"], seen["token"])[1]["why"], "token")

    def test_are_logged_out_with_their_entry_in_the_file(self):
        self.begin()
        page = self.open_page_with_users()
        users = str(self.folder.with_name("users.yaml"))
        subprocess.run([live_page.PROGRAM, "users", users, "remove", "A. Meier"], capture_output=True, check=True)
        self.assertEqual(page.do("pause")[1]["why"], "login")
        self.assertEqual(page.log_in("A. Meier", "correct horse")[0], 401)

    def test_come_by_tls_with_a_cookie_for_it(self):
        self.begin()
        certificates = test_certificates.make(self.folder.with_name("certificates"))
        users = self.folder.with_name("users.yaml")
        live_page.user(live_page.PROGRAM, users, "A. Meier", "correct horse", "operator")
        page = self.open_page("--users", str(users), "--tls", str(certificates / "broker.pem"), str(certificates / "broker.key"))
        page.trust(certificates / "ca.pem")
        self.assertEqual(page.state()["state"], "running")
        self.assertTrue(page.log_in("A. Meier", "correct horse")[2]["Set-Cookie"].endswith("; Secure"))
        self.assertEqual(page.do("pause")[0], 200)
        # What is not TLS, or is not trusted, gets nothing and holds nobody up.
        for no_tls in b"GET / HTTP/1.1\r\nHost: localhost\r\n\r\n", b"\x16\x03\x01":
            self.assertNotIn(b"HTTP/1.1 200", page.raw(no_tls))
        with self.assertRaises(ssl.SSLError):
            live_page.Page(page.port, page.process, "https").state()
        self.assertEqual(page.get("/uplot.mjs")[0], 200)

    def test_log_out(self):
        self.begin()
        page = self.open_page_with_users()
        cookie = page.cookie
        said = page.post(b"{}", {"Content-Type": "application/json"}, "/api/v1/logout")
        self.assertEqual((said[0], said[1]), (200, {"user": None}))
        self.assertIn("Max-Age=0", said[2]["Set-Cookie"])
        page.cookie = cookie
        self.assertIsNone(page.state()["user"])


if __name__ == "__main__":
    live_page.main()
