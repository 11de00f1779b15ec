#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Hours of stream through `strainwave monitor` to a broker that is killed, frozen and started again at random.

usage: broker_kills.py --program PROGRAM [--hours 24] [--every 10] [--pace 500] [--seed 1]

A host application that knows MQTT and Sparkplug from their specifications takes every message and holds it against
what the monitor printed: each window arrives with its values and its time; within a birth the sequence numbers run on
without a gap or a repetition; every connection has a birth–death number of its own; nothing is historical that did not
wait. A window whose acknowledgement died with the broker comes once more: identical, historical, and counted here.
Then the same with an outbox that is too small: what is lost is the oldest, and as much as the monitor says.

exit code 0: all of that held; 1: it did not; 77: skipped, a peer is not there"""
import argparse
import calendar
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "bench" / "peers"))
import exported_campaign  # noqa: E402
import needed  # noqa: E402

with needed.peers("/usr/sbin/mosquitto"):
    import mqtt_peer


class Ledger:
    """What arrived at the host, and what was wrong with how it arrived."""

    def __init__(self):
        self.wrong, self.windows = [], {}
        self.births = self.deaths = self.historical = self.doubled = self.messages = self.dropped = 0
        self.sequence, self.birth_death, self.birth_ms = None, None, 0

    def expect(self, held, text):
        if not held:
            self.wrong.append(f"message {self.messages}: {text}")

    def take(self, kind, payload):
        self.messages += 1
        if kind == "LOST":
            self.sequence = None
        elif kind == "NBIRTH":
            self.birth(payload)
        elif kind == "NDATA":
            self.data(payload)
        elif kind == "NDEATH":
            self.deaths += 1
            self.sequence = None
            self.expect(payload["seq"] is None, "a death has a sequence number")
            self.expect(payload["metrics"]["bdSeq"]["value"] == self.birth_death, "the death of another birth")

    def birth(self, payload):
        number = payload["metrics"]["bdSeq"]["value"]
        self.expect(payload["seq"] == 0, f"a birth with sequence number {payload['seq']}")
        if self.birth_death is not None:
            self.expect(0 < (number - self.birth_death) % 256 < 128, f"bdSeq {number} after {self.birth_death}")
        self.births += 1
        self.sequence, self.birth_death, self.birth_ms = 0, number, payload["time"]

    def data(self, payload):
        if self.sequence is None:
            self.expect(False, "data without a birth")
            return
        self.sequence = (self.sequence + 1) % 256
        self.expect(payload["seq"] == self.sequence, f"seq {payload['seq']} where {self.sequence} follows")
        metrics = payload["metrics"]
        number = metrics["Window"]["value"]
        historical = {metric["historical"] for metric in metrics.values()}
        self.expect(len(historical) == 1, "metrics of one window historical and not")
        waited = metrics["Window"]["time"] <= self.birth_ms
        self.expect(waited or True not in historical, f"window {number} historical though it came after the birth")
        self.historical += True in historical
        self.dropped = metrics["Dropped windows"]["value"]
        content = {name: metric["value"] for name, metric in metrics.items() if name.endswith("/Value")}
        arrived = (metrics["Window"]["time"], content)
        if number in self.windows:
            self.doubled += 1
            self.expect(self.windows[number] == arrived, f"window {number} twice with other content")
            self.expect(True in historical, f"window {number} twice and not historical")
        self.windows[number] = arrived

    def compare(self, results):
        """Against what the monitor printed."""
        lost = [result["window"] for result in results if result["window"] not in self.windows]
        for result in results:
            arrived = self.windows.get(result["window"])
            if arrived is None:
                continue
            stamp, fraction = result["end_utc"][:-1].split(".")
            time_ms = calendar.timegm(time.strptime(stamp, "%Y-%m-%dT%H:%M:%S")) * 1000 + int(fraction)
            values = {f"{name}/Value": value["value"] for name, value in result["values"].items()}
            self.expect(arrived == (time_ms, values), f"window {result['window']} is not what was printed")
        return lost


def start(arguments, exported, campaign, folder, broker, hours, keep):
    settings = folder / "settings.yaml"
    settings.write_text(f"monitor: 1\nstale_after: 100 h\nmqtt:\n  port: {broker.port}\n  node: bench\n  primary_host: scada\n"
                        f"  keep_windows: {keep}\n  outbox_file: outbox-{keep}.db\n")
    record = campaign / "cycles" / "000010.h5"
    other = campaign / "cycles" / "000011.h5"
    rounds = max(1, round(hours * 3600 / arguments.every / 2))
    results = open(folder / "results.txt", "w")
    errors = open(folder / "errors.txt", "w")
    return subprocess.Popen([arguments.program, "monitor", str(exported), "--replay", str(record), str(other),
                             "--rounds", str(rounds), "--every", str(arguments.every), "--pace", str(arguments.pace),
                             "--settings", str(settings), "--linger", "30", "--json"], stdout=results, stderr=errors)


def printed(folder):
    return [json.loads(line) for line in (folder / "results.txt").read_text().splitlines()]


def drain(host, ledger, seconds):
    deadline = time.monotonic() + seconds
    while (left := deadline - time.monotonic()) > 0:
        for kind, payload in host.poll(min(left, 0.02)):
            ledger.take(kind, payload)


def until_over(process, host, ledger):
    while process.poll() is None:
        drain(host, ledger, 0.1)
    drain(host, ledger, 0.5)


def kills(arguments, exported, campaign, folder):
    chance = random.Random(arguments.seed)
    broker, ledger, killed, frozen = mqtt_peer.Broker(), Ledger(), 0, 0
    broker.start()
    host = mqtt_peer.Host(broker.port)
    process = start(arguments, exported, campaign, folder, broker, arguments.hours, 100000)
    try:
        while process.poll() is None:
            drain(host, ledger, chance.uniform(0.2, 2.0))
            if process.poll() is not None:
                break
            if chance.random() < 0.2:
                frozen += 1
                os.kill(broker.process.pid, signal.SIGSTOP)
                drain(host, ledger, chance.uniform(0.05, 0.5))
                os.kill(broker.process.pid, signal.SIGCONT)
            else:
                killed += 1
                if chance.random() < 0.5:  # what was sent to it meanwhile is under way, and dies with it
                    os.kill(broker.process.pid, signal.SIGSTOP)
                    drain(host, ledger, chance.uniform(0.1, 0.3))
                broker.kill()
                drain(host, ledger, chance.uniform(0.0, 1.0))
                broker.start()
                time.sleep(chance.uniform(0.0, 0.6))  # a host that is slower to come back than the monitor
        until_over(process, host, ledger)
    finally:
        process.kill()
        process.wait()
        broker.close()
    results = printed(folder)
    lost = ledger.compare(results)
    ledger.expect(not lost, f"{len(lost)} windows lost: {lost[:10]}")
    ledger.expect(ledger.dropped == 0, "the monitor dropped windows")
    ledger.expect(killed > 0 and ledger.births > 1, "no broker was killed: the test looks at nothing")
    print(f"{len(results)} windows, {len(results) * arguments.every / 3600:.1f} h of stream; broker killed {killed} times, "
          f"frozen {frozen} times; {ledger.births} births, {ledger.messages} messages, {ledger.historical} historical; "
          f"{len(lost)} lost, {ledger.doubled} came again after an acknowledgement died")
    return ledger.wrong


def overflow(arguments, exported, campaign, folder):
    broker, ledger, keep = mqtt_peer.Broker(), Ledger(), 20
    process = start(arguments, exported, campaign, folder, broker, 0.25, keep)  # nobody listens on that port yet
    host = mqtt_peer.Host(broker.port)
    try:
        while len((folder / "results.txt").read_text().splitlines()) < 2 * keep:
            time.sleep(0.01)
        broker.start()
        until_over(process, host, ledger)
    finally:
        process.kill()
        process.wait()
        broker.close()
    results = printed(folder)
    lost = ledger.compare(results)
    ledger.expect(lost == list(range(1, len(lost) + 1)), f"lost {lost[:10]}, not the oldest")
    ledger.expect(len(lost) >= keep, f"only {len(lost)} lost: the outbox has no bound")
    # A window knows of those dropped before it was put in; the last word is the monitor's at its end.
    told = re.search(r"error: (\d+) windows found no room", (folder / "errors.txt").read_text())
    told = int(told.group(1)) if told else 0
    ledger.expect(told == len(lost), f"{told} dropped by its own count, {len(lost)} lost")
    ledger.expect(0 < ledger.dropped <= told, f"{ledger.dropped} dropped by the last window's count, {told} in the end")
    print(f"an outbox of {keep} windows: {len(results)} windows, the oldest {len(lost)} lost, {told} by its count")
    return ledger.wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", required=True)
    parser.add_argument("--hours", type=float, default=24.0)
    parser.add_argument("--every", type=float, default=10.0)
    parser.add_argument("--pace", type=float, default=500.0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        campaign, exported = exported_campaign.make(arguments.program, folder)
        wrong = kills(arguments, exported, campaign, folder) + overflow(arguments, exported, campaign, folder)
    for text in wrong[:20]:
        print(f"wrong: {text}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
