# SPDX-License-Identifier: Apache-2.0
"""A bench that lives outside of the program: strainwave-devices, a pendant made of the kernel's uhid, and the person
who mounts the blank and presses the keys."""
import contextlib
import os
import pathlib
import select
import sqlite3
import struct
import subprocess
import threading
import time

HERE = pathlib.Path(__file__).resolve().parent
BENCH = HERE / "campaign" / "bench.yaml"
SCHEDULE = HERE / "campaign" / "pendant.yaml"  # one load run of 20 s
PENDANT = (0x1209, 0x5701)  # of bench/devices/profiles/hid_pendant.yaml
CONTACT = (0x1209, 0x5703)  # hid_sto_contact.yaml
THERMOMETER = (0x0C45, 0x7401)  # hid_thermometer.yaml
QUICK_STOP, RESET, START = 1, 2, 4
STARTED = time.monotonic()
UHID_CREATE2, UHID_INPUT2 = 11, 12
UHID_EVENT_BYTES = 4380


def check(holds, what):
    print(("ok: " if holds else "FAILED: ") + what, flush=True)
    if not holds:
        raise SystemExit(1)


def from_journal(folder, query):
    journal = sqlite3.connect(f"file:{folder / 'campaign.db'}?mode=ro", uri=True)
    return journal.execute(query).fetchall()


def load_served(folder):
    return from_journal(folder, "SELECT SUM(credited_load_s) FROM phases")[0][0]


def wait_for_load(folder, devices, what):
    """Until a phase is under way and the shafts turn in it: before it, the load check turns them, too."""
    end = time.monotonic() + 120
    while time.monotonic() < end:
        try:
            if from_journal(folder, "SELECT 1 FROM phases WHERE outcome = 'running'"):
                break
        except sqlite3.Error:  # there is no journal yet
            pass
        time.sleep(0.2)
    check(devices.wait_until(safe=False, seconds=120), f"{what}: the shafts turn")


def send(frame):
    """On vcan0, as cansend takes it."""
    subprocess.run(["cansend", "vcan0", frame], check=True)


@contextlib.contextmanager
def listening_to(log):
    """What is said on vcan0 meanwhile goes to this file, as `candump -L` prints it."""
    with open(log, "w", encoding="utf-8") as file, \
            subprocess.Popen(["candump", "-L", "vcan0"], stdout=file) as candump:
        try:
            while log.stat().st_size == 0:
                send("7FE#")  # of nobody: candump listens
            yield
        finally:
            candump.terminate()


class HidDevice:
    """Made of the kernel's uhid, plugged in as long as it is not closed; says its report when that changes, when it is
    asked for, and four times a second."""

    def __init__(self, name, identity, serial, report):
        self.file = os.open("/dev/uhid", os.O_RDWR | os.O_CLOEXEC)
        # So many bytes in, of the maker's own page.
        descriptor = bytes.fromhex(f"0600FF 0901 A101 1500 26FF00 7508 95{len(report):02X} 0901 8102 C0")
        os.write(self.file, struct.pack("<I128s64s64s", UHID_CREATE2, name, b"", serial) +
                 struct.pack("<HHIIII", len(descriptor), 3, *identity, 0, 0) + descriptor.ljust(4096, b"\0"))
        self.report = report
        self.lock = threading.Lock()
        self.ending = threading.Event()
        self.thread = threading.Thread(target=self._repeat, daemon=True)
        self.thread.start()

    def _repeat(self):
        while not self.ending.is_set():
            told = select.select([self.file], [], [], 0.25)[0]
            with self.lock:
                if not self.ending.is_set():
                    if told:
                        os.read(self.file, UHID_EVENT_BYTES)
                    self._say()

    def _say(self):
        os.write(self.file, struct.pack("<IH", UHID_INPUT2, len(self.report)) + self.report)

    def say(self, report):
        """This report from now on. The time at which it was first said, as the kernel's monotonic clock has it."""
        with self.lock:
            self.report = report
            said = time.monotonic()
            if not self.ending.is_set():
                self._say()
        return said

    def unplug(self):
        """The time at which it was done."""
        with self.lock:
            self.ending.set()
            said = time.monotonic()
            os.close(self.file)
        return said


class Pendant(HidDevice):
    def __init__(self):
        super().__init__(b"strainwave pendant", PENDANT, b"P1", bytes(1))

    def press(self, keys):
        """These keys are down and no others; when that was said."""
        return self.say(bytes([keys]))

    def release_bench(self):
        """The two deliberate acts that let the bench go again, each key long enough for a slow machine to see it."""
        for keys in (0, RESET, 0, START, 0):
            self.press(keys)
            time.sleep(0.3)


def into_memory(*programs):
    """Reads programs and their libraries. While a machine of counted time waits for the host's disk, its time runs off:
    nothing that is watched may have to wait for it."""
    files = set(map(str, programs))
    for program in programs:
        for line in subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout.splitlines():
            files.update(word for word in line.split() if word.startswith("/"))
    for file in files:
        with open(file, "rb") as content:
            while content.read(1 << 20):
                pass


class Lines:
    """What a process says, line by line, each with the time at which it came; kept in a file, too."""

    def __init__(self, stream, log, answer=None):
        self.stream, self.log, self.answer = stream, log, answer
        self.said = []
        self.news = threading.Condition()
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self):
        for line in self.stream:
            with self.news:
                self.said.append((time.monotonic(), line.rstrip()))
                self.news.notify_all()
            self.log.write(f"{time.monotonic() - STARTED:8.2f} s  {line}")
            self.log.flush()
            if self.answer:
                self.answer(line)

    def wait_for(self, words, seconds, after=0):
        """The first line with these words, from line number `after` on, and when it came; None where it does not."""
        give_up = time.monotonic() + seconds
        with self.news:
            while True:
                for said in self.said[after:]:
                    if words in said[1]:
                        return said
                if not self.news.wait(give_up - time.monotonic()) and time.monotonic() >= give_up:
                    return None


class Devices:
    """strainwave-devices, ready; the programs are in memory."""

    def __init__(self, build, bench, log, period_ms=8):
        into_memory(build / "strainwave", build / "strainwave-devices")
        command = [str(build / "strainwave-devices"), str(bench), "--period", str(period_ms)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True)
        self.lines = Lines(self.process.stdout, log)
        if not self.lines.wait_for("ready", 60):
            raise SystemExit("strainwave-devices did not become ready")

    def do(self, command):
        """Orders this of the devices and waits until it is done."""
        before = len(self.lines.said)
        self.process.stdin.write(command + "\n")
        self.process.stdin.flush()
        if not self.lines.wait_for("done", 30, before):
            raise SystemExit(f"strainwave-devices did not do '{command}'")

    def safe_since(self):
        """Since when torque is off and both brakes are on, as time.monotonic() has it; None while it is not so."""
        before = len(self.lines.said)
        self.process.stdin.write("state\n")
        self.process.stdin.flush()
        said = self.lines.wait_for("state: ", 30, before)
        if said is None:
            raise SystemExit("strainwave-devices does not say its state")
        return float(said[1].split("since ")[1].split()[0]) if "since" in said[1] else None

    def wait_until(self, safe, seconds):
        """Whether the shafts come to be safe, or not safe, within the time."""
        give_up = time.monotonic() + seconds
        while time.monotonic() < give_up:
            if (self.safe_since() is not None) == safe:
                return True
            time.sleep(0.5)
        return False

    def quit(self):
        self.process.stdin.write("quit\n")
        self.process.stdin.close()
        self.process.wait(60)


class Campaign:
    """`strainwave run`, with a person who does what it asks for."""

    def __init__(self, build, schedule, bench, out, devices, pendant, log, resume=False):
        command = [str(build / "strainwave"), "run", str(schedule), "--bench", str(bench), "--out", str(out)]
        self.devices, self.pendant = devices, pendant
        self.process = subprocess.Popen(command + (["--resume"] if resume else []), stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.lines = Lines(self.process.stdout, log, self._answer)

    def _answer(self, line):
        if "mount the rigid blank" in line or "put the gear back" in line:
            self.devices.do("blank on" if "mount" in line else "blank off")
            self.process.stdin.write("\n")
            self.process.stdin.flush()
        elif "press reset" in line:
            # Not from the thread that listens, and of the pendant that is plugged in by then.
            threading.Timer(0.3, lambda: self.pendant.release_bench()).start()

    def wait(self, seconds):
        """Its exit code; None where it is not over by then."""
        try:
            code = self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        self.lines.thread.join(30)
        return code


def thread_times(process):
    """CPU seconds of each thread, [(name, seconds)]."""
    times = []
    for task in pathlib.Path(f"/proc/{process.pid}/task").iterdir():
        fields = (task / "stat").read_text().rsplit(")", 1)[1].split()
        times.append(((task / "comm").read_text().strip() + " " + task.name,
                      (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")))
    return sorted(times, key=lambda entry: -entry[1])
