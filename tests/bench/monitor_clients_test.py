#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Clients of `strainwave monitor` that are silent, slow or many, beside one that behaves: pymodbus and an HTTP client.

usage: monitor_clients_test.py PROGRAM     exit code 77: skipped, a peer is not there"""
import http.client
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import exported_campaign  # noqa: E402
import needed  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers():
    from pymodbus.client import ModbusTcpClient

PROGRAM, FOLDER = "", pathlib.Path()
PATIENCE_s = 30  # of a client that behaves: no measure of anything
READ_ONE = b"\x00\x01\x00\x00\x00\x06\x01\x04\x00\x00\x00\x01"  # transaction 1, unit 1, input register 0


def is_open(client):
    """Whether the server has not closed this connection, which has sent nothing that is answered."""
    client.setblocking(False)
    try:
        return client.recv(1) != b""
    except BlockingIOError:
        return True
    except ConnectionError:
        return False


def is_closed_in_time(client):
    client.settimeout(PATIENCE_s)
    try:
        return client.recv(1000) == b""
    except ConnectionError:
        return True


class Clients(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        _, cls.exported = exported_campaign.make(PROGRAM, FOLDER)

    def start(self, keys=""):
        settings, errors = FOLDER / "clients.yaml", FOLDER / "errors.txt"
        settings.write_text("monitor: 1\n" + "".join(f"{name}:\n  port: 0\n{keys}" for name in ("modbus", "prometheus")))
        with open(errors, "w") as said, open(FOLDER / "results.txt", "w") as results:
            monitor = subprocess.Popen([PROGRAM, "monitor", str(self.exported), "--simulate", "--pace", "1",
                                        "--duration", "1e6", "--settings", str(settings)], stdout=results, stderr=said)
        self.addCleanup(monitor.wait)
        self.addCleanup(monitor.kill)

        def port(pattern):
            return int(until(lambda: re.search(pattern, errors.read_text())).group(1))

        self.modbus, self.http = port(r"modbus: .* port (\d+)"), port(r"prometheus: http://127\.0\.0\.1:(\d+)/")

    def connect(self, port, count=1):
        clients = [socket.create_connection(("127.0.0.1", port), PATIENCE_s) for _ in range(count)]
        for client in clients:
            self.addCleanup(client.close)
        return clients

    def version(self):
        """Register 0, which a PLC reads over a connection of its own."""
        plc = ModbusTcpClient("127.0.0.1", port=self.modbus, timeout=PATIENCE_s, retries=0)
        try:
            self.assertTrue(plc.connect())
            answer = plc.read_input_registers(0, 1, slave=1)
            return None if answer.isError() else answer.registers[0]
        finally:
            plc.close()

    def page(self, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.http, timeout=PATIENCE_s)
        try:
            connection.request("GET", "/metrics", headers=headers or {})
            answer = connection.getresponse()
            return answer.status, answer.read().decode()
        finally:
            connection.close()

    def test_a_ninth_client_is_answered_beside_eight_silent_ones(self):
        self.start()
        silent = self.connect(self.modbus, 8)
        self.assertEqual(self.version(), 1)
        self.assertTrue(all(map(is_open, silent)))

    def test_of_a_hundred_silent_clients_the_longest_idle_make_room(self):
        self.start()  # with room for 32
        silent = self.connect(self.modbus, 100)
        for _ in range(3):
            self.assertEqual(self.version(), 1)
        self.assertTrue(all(map(is_closed_in_time, silent[:68])))
        self.assertTrue(all(map(is_open, silent[80:])))

    def test_a_client_that_asks_again_and_again_is_not_the_longest_idle(self):
        self.start("  connections: 3\n")
        (plc,) = self.connect(self.modbus)
        for _ in range(10):
            self.connect(self.modbus)
            plc.sendall(READ_ONE)
            self.assertEqual(plc.recv(100), b"\x00\x01\x00\x00\x00\x05\x01\x04\x02\x00\x01")

    def test_a_client_that_drips_is_dropped_and_holds_up_nobody(self):
        self.start()
        (dripping,) = self.connect(self.modbus)
        dripping.sendall(b"\x00\x01\x00\x00\x00\xfe\x01\x10")  # a request of 254 bytes
        over = threading.Event()

        def drip():
            try:
                for _ in range(400):  # the whole request, if it is waited for
                    if over.wait(0.05):
                        return
                    dripping.sendall(b"\0")
            except OSError:
                pass

        thread = threading.Thread(target=drip)
        thread.start()
        try:
            self.assertEqual([self.version() for _ in range(5)], [1] * 5)
            self.assertTrue(is_closed_in_time(dripping))
        finally:
            over.set()
            thread.join()

    def test_metrics_answer_beside_five_hundred_idle_connections(self):
        self.start()
        idle = self.connect(self.http, 500)
        status, page = self.page()
        self.assertEqual(status, 200)
        self.assertIn("strainwave_windows_total", page)
        self.assertTrue(any(map(is_open, idle[490:])))

    def test_a_page_that_is_asked_for_byte_by_byte_holds_up_no_other(self):
        self.start()
        slow = self.connect(self.http, 4)
        for client in slow:
            client.sendall(b"GET /metrics HTTP/1.1\r\nHost:")
        self.assertEqual(self.page()[0], 200)
        self.assertTrue(all(map(is_closed_in_time, slow)))

    def test_who_says_nothing_for_idle_after_is_dropped(self):
        self.start("  idle_after: 300 ms\n")
        silent = self.connect(self.modbus, 2) + self.connect(self.http, 2)
        self.assertTrue(all(map(is_closed_in_time, silent)))
        self.assertEqual((self.version(), self.page()[0]), (1, 200))

    def test_what_is_no_request_ends_its_own_connection_alone(self):
        self.start()
        for port, words in ((self.modbus, b"GET / HTTP/1.1\r\n\r\n"), (self.modbus, READ_ONE[:5] + b"\xff" * 3),
                            (self.http, b"x" * 5000), (self.http, READ_ONE * 500)):
            (stranger,) = self.connect(port)
            stranger.sendall(words)
            self.assertTrue(is_closed_in_time(stranger), words[:20])
        ranges = "bytes=" + ",".join("0-0" for _ in range(900))
        self.assertIn(self.page({"Range": ranges})[0], (200, 206, 416))
        self.assertEqual((self.version(), self.page()[0]), (1, 200))

    def test_requests_that_come_together_or_in_pieces_are_each_answered(self):
        self.start()
        (plc,) = self.connect(self.modbus)
        plc.sendall(READ_ONE * 50 + READ_ONE[:7])
        plc.sendall(READ_ONE[7:])
        answer = b"\x00\x01\x00\x00\x00\x05\x01\x04\x02\x00\x01"
        said = b""
        while len(said) < 51 * len(answer):
            said += plc.recv(10000)
        self.assertEqual(said, answer * 51)
        for request, exception in ((b"\x01\x03\x00\x00\x00\x01", b"\x83\x01"), (b"\x01\x04\xff\xff\x00\x01", b"\x84\x02"),
                                   (b"\x01\x04\x00\x00\x00\x7e", b"\x84\x03"), (b"\x01\x04\x00", b"\x84\x03")):
            plc.sendall(b"\x00\x02\x00\x00\x00" + bytes([len(request)]) + request)
            self.assertEqual(plc.recv(100), b"\x00\x02\x00\x00\x00\x03\x01" + exception)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    with tempfile.TemporaryDirectory() as scratch:
        FOLDER = pathlib.Path(scratch)
        unittest.main()
