# SPDX-License-Identifier: Apache-2.0
"""What soak.py runs on: bench files and a schedule for each kind of drives, and the faults that it puts in."""
import dataclasses
import pathlib
import re

HERE = pathlib.Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
MODBUS_DRIVE = CHECKOUT / "tests" / "simulation" / "field" / "modbus_drive.yaml"
KINDS = ("canopen", "tcp", "rtu")

# Longest times by campaign/bench.yaml, campaign/drive.yaml, MODBUS_DRIVE and the schedule below.
STALE_S = 0.3  # stale_after
HEARTBEAT_S = 0.4  # drive_timeout
POLL_S = 0.2  # of the thermometers
GOOD_FOR_S = 2.0
BAD_SENSOR_S = 2.0
BLOCK_S = 0.15  # of accelerometers, and the window of their RMS
FOUND_S = 2.0  # a sensor that tells nothing new
WATCHDOG_S = 0.8  # of a drive on Modbus, which ends what an order no longer reaches
STATE_S = 0.04  # two polls of a drive's state
CONNECTED_AGAIN_S = 0.26  # first pause, setting up, state
COUNT_S = 0.22  # four numbers on their way, two polls of them, two of the state
DWELL_S = 3.0  # of a set point that is not reached, and a reversal in which nothing counts
LIMIT_S = 2.5  # 100 Nm at 40 Nm a second
ORDER_S = 0.2  # five times two periods of 10 ms, SYNC or write
RAMP_S = 0.05  # 2400 rpm at 5000 rad/s2


@dataclasses.dataclass(frozen=True)
class Fault:
    command: str
    mend: str  # takes it away again; empty: it is over by itself
    noticed_s: float
    suspends: bool = False  # the campaign goes on by itself when it is mended
    waits: bool = False  # until more is asked for than the drive gives

    @property
    def stated_s(self):
        return self.noticed_s + ORDER_S + RAMP_S


SENSORS = (
    Fault("stream encoders silent on", "stream encoders silent off", STALE_S),
    Fault("stream encoders drop 3000", "", STALE_S),
    Fault("sensor freeze 3", "sensor freeze off", FOUND_S),
    Fault("sensor drift 3 40", "sensor drift off", LIMIT_S),
    Fault("modbus thermometers silence", "modbus thermometers ok", GOOD_FOR_S + BAD_SENSOR_S, True),
    Fault("modbus thermometers exception 4", "modbus thermometers ok", POLL_S + BAD_SENSOR_S, True),
    Fault("sensor dead 7", "sensor dead off", BLOCK_S + BAD_SENSOR_S, True),
)
CANOPEN = (
    Fault("drive 1 heartbeat off", "drive 1 heartbeat on", HEARTBEAT_S),
    Fault("drive 2 silent on", "drive 2 silent off", HEARTBEAT_S),
    Fault("drive 1 reboot", "", 0.0),
    Fault("drive 2 emergency 0x4310", "", 0.0),
    Fault("drive 1 sto on", "drive 1 sto off", 0.0),
    Fault("drive 2 statusword 0x4440", "drive 2 statusword off", 0.0),
    Fault("drive 1 bus-off on", "drive 1 bus-off off", 0.0),
    Fault("drive 2 torque-limit 8", "drive 2 torque-limit off", DWELL_S, waits=True),
)


def modbus(drive, is_line):
    to, ok = f"modbus {drive}", f"modbus {drive} ok"
    at = f"drive {drive}"
    silent_s = max(STALE_S, WATCHDOG_S)
    faults = [Fault(f"{to} {how}", ok, silent_s) for how in ("silence", "unplugged", "half", "unit", "delay 1500", "exception 4")]
    if not is_line:
        faults += [Fault(f"{to} transaction", ok, silent_s), Fault(f"{to} reset", "", CONNECTED_AGAIN_S)]
    return faults + [
        Fault(f"{at} reboot", "", CONNECTED_AGAIN_S),
        Fault(f"{at} sto on", f"{at} sto off", STATE_S),
        Fault(f"{at} fault", "", STATE_S),
        Fault(f"{at} statusword 15", f"{at} statusword off", STATE_S),
        Fault(f"{at} count-stuck on", f"{at} count-stuck off", COUNT_S),
    ]


def faults_of(kind):
    if kind == "canopen":
        return [*SENSORS, *CANOPEN]
    is_line = kind == "rtu"
    return [*SENSORS, *modbus("driving", is_line), *modbus("load", is_line),
            Fault("drive load torque-limit 8", "drive load torque-limit off", DWELL_S, waits=True),
            Fault("drive driving speed-limit 608", "drive driving speed-limit off", DWELL_S, waits=True)]


def with_text(text, old, new):
    assert old in text, f"no '{old}' to replace"
    return text.replace(old, new, 1)


def bench_text(kind):
    """Without a pendant: nobody is there."""
    text = (HERE / "campaign" / "bench.yaml").read_text(encoding="utf-8")
    text = re.sub(r"^.*kind: pendant.*\n", "", text, flags=re.M)
    text = text.replace("../../../", f"{CHECKOUT}/").replace("drive.yaml}", f"{HERE / 'campaign' / 'drive.yaml'}}}")
    if kind == "canopen":
        return text
    for node, name in ((1, "driving"), (2, "load")):
        text = with_text(text, f"{{device: can, node: {node}, profile: {HERE / 'campaign' / 'drive.yaml'}}}", f"{{device: {name}}}")
    address = {"driving": "tcp:127.0.0.1:1510", "load": "tcp:127.0.0.1:1511"} if kind == "tcp" else \
        {"driving": "rtu:driving", "load": "rtu:load"}
    drives = "".join(f'  - {{name: {name}, kind: modbus, address: "{at}", registers: {MODBUS_DRIVE}}}\n' for name, at in address.items())
    return with_text(text, "  - {name: can, kind: canopen, interface: vcan0}\n", drives)


def with_lines(text, said):
    """The lines of the drives as strainwave-devices has opened them ("load: rtu:/dev/pts/3:19200:8E1")."""
    for line in said:
        name, _, address = line.partition(": ")
        if address.startswith("rtu:/"):
            text = with_text(text, f'"rtu:{name}"', f'"{address}"')
    return text


def schedule_text(kind, cycles):
    """Short cycles; only a load run turns under load, so that what is served can be told. A driving servo on Modbus
    does not move to positions."""
    text = (HERE / "campaign" / "short.yaml").read_text(encoding="utf-8")
    for old, new in (("dwell: 1 min", "dwell: 1 s"), ("cycles: 1", f"cycles: {cycles}"), ("duration: 3 s", "duration: 20 s"),
                     ("vibration_rate: 25.6 kHz", "vibration_rate: 12.8 kHz"), ("step: 5 deg\n    steps: 72", "step: 10 deg\n    steps: 36"),
                     ("torque_rate: 8 Nm/s", "torque_rate: 20 Nm/s"), ("operator_acknowledges: true", "operator_acknowledges: false"),
                     ("direction: cw\n    output_torque: 40 Nm", "direction: cw\n    output_torque: 0 Nm")):
        text = with_text(text, old, new)
    if kind == "canopen":
        return text
    return text[:text.index("  - kind: transmission_error")] + text[text.index("measurements:"):]
