#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Each rule of canopen_rules.py holds for a capture that is as it should be, and is found broken in one that was changed."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import canopen_rules
from canopen_rules import FAULT_RESET, INVALID, Frame, judge, number, parse

NODE = 1
NMT, SYNC, EMCY, STATUS, ANSWER, COMMAND, RESPONSE, REQUEST, BEAT = 0, 0x80, 0x81, 0x181, 0x281, 0x201, 0x581, 0x601, 0x701


def good_capture():
    """A reset, a start and a fault of node 1, in lines of candump -L."""
    lines, now_ms = [], 0.0

    def say(cob_id, data=""):
        lines.append(f"({1e9 + now_ms / 1e3:.6f}) vcan0 {cob_id:03X}#{data}")

    def access(index, sub, value, is_write):
        address = f"{index & 0xFF:02X}{index >> 8:02X}{sub:02X}"
        data = value.to_bytes(4, "little").hex().upper()
        say(REQUEST, f"{'23' if is_write else '40'}{address}{data if is_write else '00000000'}")
        say(RESPONSE, f"{'60' if is_write else '43'}{address}{'00000000' if is_write else data}")

    def write(index, sub, value):
        access(index, sub, value, True)

    say(NMT, "8101")
    say(BEAT, "00")
    say(NMT, "8001")
    access(0x1018, 1, 0x5357, False)
    access(0x1018, 2, 0x0402, False)
    for index, sub, value in ((0x1017, 0, 50), (0x1016, 1, 127 << 16 | 400), (0x60C2, 1, 10), (0x60C2, 2, 0xFD)):
        write(index, sub, value)
    for index, cob_id, entries in ((0x1400, COMMAND, [0x60400010]), (0x1800, STATUS, [0x60410010, 0x603F0010]),
                                   (0x1801, ANSWER, [0x60640020])):
        write(index, 1, INVALID | cob_id)
        write(index, 2, 1)
        write(index + 0x200, 0, 0)
        for sub, entry in enumerate(entries, 1):
            write(index + 0x200, sub, entry)
        write(index + 0x200, 0, len(entries))
        write(index, 1, cob_id)
    say(NMT, "0101")
    # Of 10 ms each: controlword and the statusword after it.
    cycles = [(0x00, 0x40)] * 5 + [(0x06, 0x21)] * 5 + [(0x07, 0x23)] * 5 + [(0x0F, 0x27)] * 120
    cycles += [(0x00, 0x08)] * 5 + [(FAULT_RESET, 0x40)] * 3 + [(0x00, 0x40)] * 5
    for i, (word, status) in enumerate(cycles):
        now_ms += 10.0
        say(COMMAND, f"{word:02X}00")
        say(SYNC)
        say(STATUS, f"{status:02X}020000")
        say(ANSWER, "12345678")
        if i % 5 == 0:
            say(BEAT, "05")
            say(0x77F, "05")
        if i == 135:
            say(EMCY, "1043090000000000")
    say(EMCY, "0000000000000000")
    return lines


def is_write(frame, index, sub):
    return frame.id == REQUEST and frame.data[0] >> 5 == 1 and (number(frame.data[1:3]), frame.data[3]) == (index, sub)


def taken_out(frames, at):
    """A request with its answer, and all the others."""
    answer = next(i for i in range(at, len(frames)) if frames[i].id == RESPONSE)
    return [frames[at], frames[answer]], frames[:at] + frames[at + 1:answer] + frames[answer + 1:]


def without_access(frames, at):
    return taken_out(frames, at)[1]


def find(frames, holds):
    return next(i for i, frame in enumerate(frames) if holds(frame))


def changed(frames, holds, data):
    """data(old) in all frames for which it holds."""
    return [frame._replace(data=data(frame.data)) if holds(frame) else frame for frame in frames]


def without_every(frames, cob_id, of):
    count, left = 0, []
    for frame in frames:
        count += frame.id == cob_id
        if frame.id != cob_id or count % of:
            left.append(frame)
    return left


def no_bootup(frames):
    return [frame for frame in frames if frame != Frame(frame.time_s, BEAT, b"\0")]


def product_not_read(frames):
    asked = lambda frame: frame.id == REQUEST and frame.data[:4] == bytes.fromhex("40181002")
    while any(map(asked, frames)):
        frames = without_access(frames, find(frames, asked))
    return frames


def mapped_while_valid(frames):
    return without_access(frames, find(frames, lambda frame: is_write(frame, 0x1400, 1)))


def entries_not_cleared(frames):
    return without_access(frames, find(frames, lambda frame: is_write(frame, 0x1600, 0)))


def made_valid_too_early(frames):
    count = find(frames, lambda frame: is_write(frame, 0x1600, 0) and frame.data[4] > 0)
    moved = find(frames[count:], lambda frame: is_write(frame, 0x1400, 1)) + count
    access, others = taken_out(frames, moved)
    return others[:count] + access + others[count:]


def started_before_mapping(frames):
    start = find(frames, lambda frame: frame.id == NMT and frame.data == b"\1\1")
    mapping = find(frames, lambda frame: is_write(frame, 0x1400, 1))
    return frames[:mapping] + [frames[start]] + frames[mapping:start] + frames[start + 1:]


def controlword(frame, word):
    return frame.id == COMMAND and frame.data[0] & 0x8F == word


# (the rule, words of what is found, what is done to the capture)
BREAKS = [
    ("boot-up after a reset", "no 701#00 after the reset", no_bootup),
    ("identity before any write", "before 1018h:01 and :02 are read", product_not_read),
    ("PDOs are mapped in the right order", "its mapping is written while its COB-ID is valid", mapped_while_valid),
    ("PDOs are mapped in the right order", "an entry is written before the number of entries is 0",
     entries_not_cleared),
    ("PDOs are mapped in the right order", "made valid before its mapping is complete", made_valid_too_early),
    ("heartbeats as 1017h and 1016h say", "1017h says 50 ms", lambda frames: without_every(frames, BEAT, 2)),
    ("heartbeats as 1017h and 1016h say", "1016h waits", lambda frames: [
        frame._replace(data=frame.data[:4] + b"\x20\0" + frame.data[6:]) if is_write(frame, 0x1016, 1) or
        frame.id == RESPONSE and frame.data[1:4] == b"\x16\x10\1" and frame.data[0] == 0x43 else frame for frame in frames]),
    ("NMT start after the mapping", "is mapped after it was started", started_before_mapping),
    ("SYNC is answered", "answers to", lambda frames: without_every(frames, ANSWER, 3)),
    ("SYNC is answered", "mapped are",
     lambda frames: changed(frames, lambda frame: frame.id == ANSWER, lambda data: data[:-1])),
    ("controlword 06h, 07h, 0Fh", "controlword 06h is followed by 0Fh",
     lambda frames: [frame for frame in frames if not controlword(frame, 0x07)]),
    ("controlword 06h, 07h, 0Fh", "while it is not switched on",
     lambda frames: changed(frames, lambda frame: frame.id == STATUS and frame.data[0] & 0x6F == 0x23,
                            lambda data: bytes([data[0] & ~0x02]) + data[1:])),
    ("fault reset by an edge", "no fault is reset",
     lambda frames: changed(frames, lambda frame: controlword(frame, FAULT_RESET), lambda data: b"\0" + data[1:])),
    ("fault reset by an edge", "where there is none",
     lambda frames: changed(frames, lambda frame: frame.id == STATUS and frame.data[0] & 0x4F == 0x08,
                            lambda data: b"\x40" + data[1:])),
    ("EMCY of 8 bytes", "has 7 bytes", lambda frames: changed(frames, lambda frame: frame.id == EMCY, lambda data: data[:7])),
    ("EMCY of 8 bytes", "says that there is no error",
     lambda frames: changed(frames, lambda frame: frame.id == EMCY, lambda data: data[:2] + b"\0" + data[3:])),
]


def not_found(frames):
    """Which of the breaks are not found in this capture, in words."""
    missed = []
    for rule, words, spoil in BREAKS:
        said = {name: (holds, text) for name, _, holds, text in judge(spoil(frames), [NODE], [NODE])}[rule]
        if said[0] or words not in said[1]:
            missed.append(f"{rule}: '{words}' is to be found, said is {said}")
    return missed


def main():
    frames = parse(good_capture())
    problems = [] if canopen_rules.show(judge(frames, [NODE], [NODE])) else ["the good capture is found bad"]
    problems += not_found(frames)
    never_broken = {*canopen_rules.RULES, *canopen_rules.RULES_OF_A_FAULT} - {rule for rule, *_ in BREAKS}
    problems += [f"nothing breaks '{rule}'" for rule in never_broken]
    for line in ("(1.000000) vcan0 123#R", "(1.000000) vcan0 20000004#0008000000000000", "123#00"):
        try:
            parse([line])
            problems.append(f"{line} is taken for a data frame")
        except ValueError:
            pass
    print("\n".join(problems) or f"{len(BREAKS)} ways of breaking the rules are found")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
