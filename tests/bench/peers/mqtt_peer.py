# SPDX-License-Identifier: Apache-2.0
"""The other end of MQTT and Sparkplug B, from their specifications alone: a client (MQTT 3.1.1), a decoder of
payloads by the wire format of protocol buffers, and a broker process (mosquitto) that can be killed."""
import contextlib
import json
import pathlib
import select
import socket
import struct
import subprocess
import tempfile
import time

from free_port import free_port


class Broker:
    """mosquitto on a port of its own; nothing of it outlives the process."""

    def __init__(self, more=""):
        """more: lines of its settings, of the listener first."""
        self.port = free_port()
        self.folder = tempfile.TemporaryDirectory()
        self.settings = pathlib.Path(self.folder.name) / "mosquitto.conf"
        self.settings.write_text(f"listener {self.port} 127.0.0.1\n{more}\npersistence false\nmax_queued_messages 0\n"
                                 + ("" if "allow_anonymous" in more else "allow_anonymous true\n"))
        self.log = self.settings.with_name("mosquitto.log")
        self.process = None

    def start(self):
        with open(self.log, "w", encoding="utf-8") as log:
            self.process = subprocess.Popen(["/usr/sbin/mosquitto", "-c", str(self.settings)], stdout=log, stderr=log)
        self.connected(lambda: socket.create_connection(("127.0.0.1", self.port), timeout=1)).close()

    def connected(self, connect):
        """What `connect` gives once the broker takes connections: it opens its listeners one after the other."""
        while True:
            try:
                return connect()
            except (ConnectionRefusedError, ConnectionResetError):
                assert self.process.poll() is None, f"mosquitto ended: {self.log.read_text()}"
                select.select([], [], [], 0.005)

    def kill(self):
        self.process.kill()
        self.process.wait()

    def close(self):
        if self.process and self.process.poll() is None:
            self.kill()
        self.folder.cleanup()


def _text(value):
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack(">H", len(data)) + data


def _packet(kind, body):
    length, size = b"", len(body)
    while True:
        size, low = divmod(size, 128)
        length += bytes([low | (128 if size else 0)])
        if not size:
            return bytes([kind]) + length + body


class Client:
    """One connection. `poll` gives the messages that came in, and raises ConnectionError when it is lost."""

    def __init__(self, port, name, will=None, timeout=5.0):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=timeout)
        self.buffer = b""
        self.retained = {}
        flags = 0x02 | (0x04 | 0x08 | 0x20 if will else 0)  # clean session; will of QoS 1, retained
        body = _text("MQTT") + bytes([4, flags]) + struct.pack(">H", 60) + _text(name)
        if will:
            body += _text(will[0]) + _text(will[1])
        self.socket.sendall(_packet(0x10, body))
        kind, answer = self._read_one(time.monotonic() + timeout)
        if kind != 0x20 or answer[1] != 0:
            raise ConnectionError("not accepted")

    def subscribe(self, topic):
        self.socket.sendall(_packet(0x82, b"\0\1" + _text(topic) + b"\0"))
        deadline = time.monotonic() + 5
        self.early = []
        while True:
            kind, body = self._read_one(deadline)
            if kind & 0xF0 == 0x90:
                return
            if kind & 0xF0 == 0x30:
                self.early.append(self._message(kind, body))

    def publish(self, topic, payload, retain=False):
        self.socket.sendall(_packet(0x31 if retain else 0x30, _text(topic) + payload))

    def poll(self, seconds):
        """Messages (topic, payload, retained) that came within the time; at least one round of reading."""
        messages, self.early = getattr(self, "early", []), []
        while True:
            packet = self._take()
            if packet:
                if packet[0] & 0xF0 == 0x30:
                    messages.append(self._message(*packet))
                continue
            if messages or not select.select([self.socket], [], [], seconds)[0]:
                return messages
            self._fill()

    def close(self):
        self.socket.close()

    def _fill(self):
        data = self.socket.recv(1 << 16)
        if not data:
            raise ConnectionError("closed")
        self.buffer += data

    def _read_one(self, deadline):
        while True:
            packet = self._take()
            if packet:
                return packet
            if not select.select([self.socket], [], [], max(0.0, deadline - time.monotonic()))[0]:
                raise ConnectionError("no answer")
            self._fill()

    def _take(self):
        size, shift, at = 0, 0, 1
        while True:
            if at >= len(self.buffer):
                return None
            byte = self.buffer[at]
            size |= (byte & 127) << shift
            shift, at = shift + 7, at + 1
            if byte < 128:
                break
        if len(self.buffer) < at + size:
            return None
        kind, body = self.buffer[0], self.buffer[at:at + size]
        self.buffer = self.buffer[at + size:]
        return kind, body

    @staticmethod
    def _message(kind, body):
        length, = struct.unpack(">H", body[:2])
        start = 2 + length + (2 if kind & 0x06 else 0)
        return body[2:2 + length].decode(), body[start:], bool(kind & 1)


def _fields(data):
    at = 0

    def varint():
        nonlocal at
        value, shift = 0, 0
        while True:
            byte = data[at]
            value |= (byte & 127) << shift
            shift, at = shift + 7, at + 1
            if byte < 128:
                return value

    while at < len(data):
        number, kind = divmod(varint(), 8)
        if kind == 0:
            yield number, varint()
        else:
            size = {1: 8, 5: 4}.get(kind) or varint()
            yield number, data[at:at + size]
            at += size


def decode(data):
    """A Sparkplug payload: time, seq and metrics {name: {...}}; names and types as the specification has them."""
    payload = {"time": None, "seq": None, "metrics": {}}
    for number, value in _fields(data):
        if number == 1:
            payload["time"] = value
        elif number == 3:
            payload["seq"] = value
        elif number == 2:
            metric = {"historical": False, "null": False, "value": None, "quality": None, "time": None}
            name = None
            for field, content in _fields(value):
                if field == 1:
                    name = content.decode()
                elif field == 3:
                    metric["time"] = content
                elif field == 5:
                    metric["historical"] = bool(content)
                elif field == 7:
                    metric["null"] = bool(content)
                elif field == 9:
                    keys = [key.decode() for n, key in _fields(content) if n == 1]
                    values = [dict(_fields(entry)).get(3) for n, entry in _fields(content) if n == 2]
                    metric["quality"] = dict(zip(keys, values)).get("Quality")
                elif field == 13:
                    metric["value"], = struct.unpack("<d", content)
                elif field == 14:
                    metric["value"] = bool(content)
                elif field == 15:
                    metric["value"] = content.decode()
                elif field in (10, 11):
                    metric["value"] = content
            payload["metrics"][name] = metric
    return payload


class Host:
    """A primary host application: connects for as long as it is asked to, says that it listens, and hands every
    message of the nodes on. What a broker took with it into its death is not asked for again."""

    def __init__(self, port, name="scada"):
        self.port, self.topic, self.client = port, f"spBv1.0/STATE/{name}", None

    def _state(self, online):
        return json.dumps({"online": online, "timestamp": time.time_ns() // 1_000_000}).encode()

    def poll(self, seconds):
        """[(type, payload)] of nodes: ("NBIRTH", {...}), …; ("LOST", None) where the connection ended."""
        try:
            if self.client is None:
                self.client = Client(self.port, "host", will=(self.topic, self._state(False)))
                self.client.subscribe("spBv1.0/+/+/+")
                self.client.publish(self.topic, self._state(True), retain=True)
            return [(topic.split("/")[2], decode(payload)) for topic, payload, _ in self.client.poll(seconds)
                    if not topic.startswith("spBv1.0/STATE/")]
        except (ConnectionError, socket.timeout):
            was_connected = self.client is not None
            if was_connected:
                self.client.close()
            self.client = None
            if not was_connected:
                select.select([], [], [], min(seconds, 0.02))
            return [("LOST", None)] if was_connected else []
