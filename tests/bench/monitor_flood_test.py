#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""`strainwave monitor` while strangers hold connections at both of its servers: it publishes, answers clients that behave, and
takes neither more memory nor more files than its limits say.

usage: monitor_flood_test.py PROGRAM     exit code 77: skipped, a peer is not there"""
import contextlib
import http.client
import pathlib
import re
import resource
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "peers"))
import flood  # noqa: E402
import needed  # noqa: E402
from waiting import until  # noqa: E402

with needed.peers("/usr/sbin/mosquitto"):
    import monitor_fixture
    from pymodbus.client import ModbusTcpClient
    from pymodbus.exceptions import ConnectionException

MiB = 1 << 20
CONNECTIONS = 32  # of each server, unless the settings say otherwise
FILES = 128  # that a monitor may have, of which a quarter is for what is no client of its servers
TO_THE_BROKER = 4  # that come and go
HALF_A_FRAME = b"\x00\x01\x00\x00\x00\xfe\x01\x10"  # of 254 bytes
HALF_A_REQUEST = b"GET /metrics HTTP/1.1\r\nHost: "


class AFlood(monitor_fixture.MonitorTest):
    def begin(self, keys, environment=None):
        """A monitor on the simulated bench, a host that listens at its broker; `keys` of both servers."""
        self.mosquitto, self.host = self.broker()
        servers = "".join(f"{name}:\n  port: 0\n{keys}" for name in ("modbus", "prometheus"))
        path = self.settings(f"{servers}mqtt:\n  port: {self.mosquitto.port}\n  group: lab\n  node: bench\n  outbox_file: outbox.db\n")
        self.monitor = self.start("--simulate", "--pace", 4, "--duration", "1e6", "--settings", path)

        def port(pattern):
            return int(until(lambda: re.search(pattern, self.monitor.said())).group(1))

        self.modbus, self.http = port(r"modbus: .* port (\d+)"), port(r"prometheus: http://127\.0\.0\.1:(\d+)/")
        self.until_more_data(self.host)
        self.files, self.memory_bytes = flood.open_files(self.monitor), flood.peak_memory_bytes(self.monitor)

    def until_more_data(self, host):
        """Until the broker has two windows that it had not before, and the results as well."""
        shown, got = len(self.monitor.results()), []
        until(lambda: got.extend(self.data_of(host)) or len(got) >= 2)
        until(lambda: len(self.monitor.results()) >= shown + 2)

    def flood(self, *halves):
        """At both servers; `halves` of a request to each."""
        floods = [flood.Flood(port, half) for port, half in zip((self.modbus, self.http), halves or (HALF_A_FRAME, HALF_A_REQUEST))]
        for one in floods:
            self.addCleanup(one.kill)
        return floods

    def reads_version(self):
        """Whether register 0 is 1, over a connection of its own; where hundreds come in a second, it may be displaced before it
        has asked."""
        plc = ModbusTcpClient("127.0.0.1", port=self.modbus, timeout=flood.PATIENCE_s, retries=0)
        with contextlib.closing(plc), contextlib.suppress(ConnectionException):
            return plc.connect() and plc.read_input_registers(0, 1, slave=1).registers == [1]

    def gets_page(self):
        """Likewise."""
        connection = http.client.HTTPConnection("127.0.0.1", self.http, timeout=flood.PATIENCE_s)
        with contextlib.closing(connection), contextlib.suppress(ConnectionError):
            connection.request("GET", "/metrics")
            return "strainwave_windows_total" in connection.getresponse().read().decode()

    def until_clients_are_answered(self):
        until(self.reads_version)
        until(self.gets_page)

    def test_takes_no_connection_from_a_client_that_is_served(self):
        self.begin("")
        plc = ModbusTcpClient("127.0.0.1", port=self.modbus, timeout=flood.PATIENCE_s, retries=0)
        self.addCleanup(plc.close)
        self.assertTrue(plc.connect())
        self.assertEqual(plc.read_input_registers(0, 1, slave=1).registers, [1])
        socket_before = plc.socket
        self.flood()
        for _ in range(5):
            self.assertEqual(plc.read_input_registers(0, 1, slave=1).registers, [1])
            self.until_more_data(self.host)
        self.assertIs(plc.socket, socket_before)

    def test_at_both_servers_holds_up_nobody_and_ends(self):
        self.begin("  idle_after: 2 s\n")
        floods = self.flood()
        for _ in range(5):
            self.until_clients_are_answered()
            self.until_more_data(self.host)
            self.assertLessEqual(flood.open_files(self.monitor), self.files + 2 * CONNECTIONS + TO_THE_BROKER)
        for one in floods:
            one.until_closed()
        for one in floods:
            one.end()
        until(lambda: flood.open_files(self.monitor) <= self.files)
        self.assertLess(flood.peak_memory_bytes(self.monitor), self.memory_bytes + 16 * MiB)
        print(f"open files {self.files}, memory {self.memory_bytes / MiB:.1f} to {flood.peak_memory_bytes(self.monitor) / MiB:.1f} MiB",
              file=sys.stderr)

    def test_that_would_take_all_files_leaves_some_for_the_broker(self):
        before = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (FILES, before[1]))  # of the monitor, which inherits it
        try:
            self.begin("  connections: 500\n")
        finally:
            resource.setrlimit(resource.RLIMIT_NOFILE, before)
        self.mosquitto.kill()
        until(lambda: "windows wait" in self.monitor.said())
        for one in self.flood(b"", b""):  # of idle ones: nothing is freed by itself
            self.assertIsNone(one.process.poll())
        self.until_clients_are_answered()
        self.assertLessEqual(flood.open_files(self.monitor), FILES - FILES // 4 + TO_THE_BROKER)
        self.mosquitto.start()
        self.until_more_data(self.listener(self.mosquitto, self.mosquitto.port))


if __name__ == "__main__":
    monitor_fixture.main()
