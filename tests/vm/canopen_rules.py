#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What CiA 301 and CiA 402 ask of a master and its drives, looked for in frames as `candump -L` prints them.

  canopen_rules.py CAPTURE NODE...     prints what holds and what does not; exit code 1 where something does not

A capture begins before the nodes are reset and is of one interface.
"""
import collections
import re
import statistics
import sys

Frame = collections.namedtuple("Frame", "time_s id data")
# An access to an object by SDO: `at` and `until` are the positions of its first and last frame.
Access = collections.namedtuple("Access", "at until is_write index sub value aborted")
Mapped = collections.namedtuple("Mapped", "number to_drive transmission entries")  # entries: [(index, sub, bits)]
# One start of one node: from its first SDO on, `operational` is where NMT start was said, `end` where that was over.
Start = collections.namedtuple("Start", "at operational end accesses")

MASTER_NODE = 127
NMT_START, NMT_STOPS, NMT_PRE_OPERATIONAL, NMT_RESETS = 0x01, 0x02, 0x80, (0x81, 0x82)
INVALID = 1 << 31
FAULT_RESET = 0x80
# The device side looks at its bus this often.
LOOK_S = 0.008


def parse(lines):
    frames = []
    for at, line in enumerate(lines, 1):
        match = re.fullmatch(r"\((\d+\.\d{6})\) \S+ ([0-9A-F]{3})#((?:[0-9A-F]{2}){0,8})", line.strip())
        if not match:
            raise ValueError(f"line {at}: {line.strip()} (expected a data frame with an 11-bit identifier of candump -L)")
        frames.append(Frame(float(match[1]), int(match[2], 16), bytes.fromhex(match[3])))
    return frames


def number(data):
    return int.from_bytes(data, "little")


class Broken(Exception):
    """A rule does not hold; says where."""


def expect(holds, words):
    if not holds:
        raise Broken(words)


def nmt(frames, node, commands):
    """Where one of these commands goes to the node."""
    return [i for i, frame in enumerate(frames)
            if frame.id == 0 and frame.data[0] in commands and frame.data[1] in (0, node)]


def accesses(frames, node, begin, end):
    """All are of at most 4 bytes here, so one frame each way."""
    found, asked = [], None
    for i in range(begin, end):
        frame = frames[i]
        if frame.id == 0x600 + node:
            expect(len(frame.data) == 8, f"an SDO request of {len(frame.data)} bytes to node {node}")
            expect(asked is None, f"node {node}: {frame.data.hex()} asked before the last request was answered")
            asked = i
        elif frame.id == 0x580 + node:
            expect(asked is not None, f"node {node}: {frame.data.hex()} answers no request")
            request = frames[asked].data
            expect(frame.data[1:4] == request[1:4], f"node {node}: {request.hex()} is answered by {frame.data.hex()}")
            is_write = request[0] >> 5 == 1
            said = request if is_write else frame.data
            expect(said[0] & 2 or frame.data[0] == 0x80, f"node {node}: {said.hex()} is not expedited")
            size = 4 - (said[0] >> 2 & 3) if said[0] & 1 else 4
            found.append(Access(asked, i, is_write, number(request[1:3]), request[3], number(said[4:4 + size]),
                                frame.data[0] == 0x80))
            asked = None
    return found


def left_operational(frames, node, begin, end):
    """Where the node says that it has left operational by itself, as when its master is gone."""
    was_operational = False
    for i in range(begin, end):
        if frames[i].id == 0x700 + node:
            if was_operational and frames[i].data != b"\5":
                return i
            was_operational = was_operational or frames[i].data == b"\5"
    return end


def starts(frames, node):
    found = []
    stops = nmt(frames, node, (NMT_STOPS, NMT_PRE_OPERATIONAL, *NMT_RESETS)) + [len(frames)]
    for begin in nmt(frames, node, (NMT_PRE_OPERATIONAL,)):
        end = next(stop for stop in stops if stop > begin)
        operational = next((i for i in nmt(frames, node, (NMT_START,)) if begin < i < end), None)
        if operational is not None:
            done = accesses(frames, node, begin, operational)
            expect(done, f"node {node} is started with nothing read or written before")
            found.append(Start(done[0].at, operational, left_operational(frames, node, operational, end), done))
    expect(found, f"node {node} is never set up and started")
    return found


def mapped_pdos(start):
    """As written: the PDOs of a start, by (to_drive, number)."""
    pdos = {}
    for access in start.accesses:
        kind = access.index & 0xFE00
        if not access.is_write or access.aborted or kind not in (0x1400, 0x1600, 0x1800, 0x1A00):
            continue
        pdos.setdefault((kind < 0x1800, access.index & 0x1FF), []).append(access)
    return pdos


def settled(start):
    """{COB-ID: what it holds} once the PDOs are mapped."""
    found = {}
    for (to_drive, pdo), writes in mapped_pdos(start).items():
        last = {(access.index & 0xFE00 in (0x1600, 0x1A00), access.sub): access.value for access in writes}
        expect({(False, 1), (True, 0)} <= set(last), f"{'R' if to_drive else 'T'}PDO {pdo + 1} is mapped in part")
        if last[False, 1] & INVALID:
            continue
        entries = [last[True, i + 1] for i in range(last[True, 0])]
        found[last[False, 1] & 0x7FF] = Mapped(pdo + 1, to_drive, last.get((False, 2)),
                                               [(entry >> 16, entry >> 8 & 0xFF, entry & 0xFF) for entry in entries])
    return found


def last_value(start, index, sub):
    values = [access.value for access in start.accesses if (access.index, access.sub) == (index, sub)]
    expect(values, f"{index:04X}h:{sub:02X} is neither written nor read")
    return values[-1]


def bootup(frames, node):
    resets = nmt(frames, node, NMT_RESETS)
    expect(resets, f"node {node} is not reset in this capture")
    for reset in resets:
        answer = next((frame for frame in frames[reset + 1:] if frame.id == 0x700 + node and frame.data == b"\0"), None)
        expect(answer, f"no 7{node:02X}#00 after the reset of node {node}")
        between = [frame for frame in frames[reset + 1:frames.index(answer)] if frame.id == 0x580 + node]
        expect(not between, f"node {node} answers SDO between its reset and its boot-up")
    return f"{len(resets)} resets"


def identity_first(frames, node):
    for start in starts(frames, node):
        first_write = next((i for i, access in enumerate(start.accesses) if access.is_write), len(start.accesses))
        read = {access.sub for access in start.accesses[:first_write] if access.index == 0x1018 and not access.aborted}
        expect({1, 2} <= read, f"node {node} is written to before 1018h:01 and :02 are read (read: {sorted(read)})")
    return f"{len(starts(frames, node))} starts"


def remapping_order(frames, node):
    count = 0
    for start in starts(frames, node):
        for (to_drive, pdo), writes in mapped_pdos(start).items():
            name = f"node {node}, {'R' if to_drive else 'T'}PDO {pdo + 1}"
            valid, entries, mapped = True, None, None  # as the drive may have been left
            for access in writes:
                of_mapping = access.index & 0xFE00 in (0x1600, 0x1A00)
                if not of_mapping:
                    if access.sub == 1:
                        valid = not access.value & INVALID
                        expect(not valid or mapped is not None,
                               f"{name}: its COB-ID is made valid before its mapping is complete")
                    continue
                expect(not valid, f"{name}: its mapping is written while its COB-ID is valid")
                if access.sub == 0 and access.value == 0:
                    entries, mapped = [], None
                elif access.sub == 0:
                    written = len(entries or [])
                    expect(access.value == written, f"{name}: {access.value} entries are said to be, {written} were written")
                    bits = sum(entry & 0xFF for entry in entries)
                    expect(bits <= 64, f"{name}: {bits} bits are mapped")
                    mapped = entries
                else:
                    expect(entries is not None, f"{name}: an entry is written before the number of entries is 0")
                    expect(access.sub == len(entries) + 1, f"{name}: entry {access.sub} is written after {len(entries)}")
                    entries.append(access.value)
            count += valid
        expect({flow for flow, _ in mapped_pdos(start)} == {True, False},
               f"node {node}: not PDOs of both directions are mapped")
    return f"{count} PDOs in use"


def heartbeats(frames, node):
    def median_period_s(beats):
        expect(len(beats) > 10, f"only {len(beats)} heartbeats in operational")
        return statistics.median(after - before for before, after in zip(beats, beats[1:]))

    start = max(starts(frames, node), key=lambda each: each.end - each.operational)
    asked_s = 1e-3 * last_value(start, 0x1017, 0)
    shown = frames[start.operational:start.end]
    beats = [frame for frame in shown if frame.id == 0x700 + node]
    expect(all(len(beat.data) == 1 for beat in beats), f"a heartbeat of node {node} is not of one byte")
    period_s = median_period_s([beat.time_s for beat in beats if beat.data == b"\5"])
    expect(abs(period_s - asked_s) <= LOOK_S,
           f"node {node}: 1017h says {1e3 * asked_s:.0f} ms, heartbeats are {1e3 * period_s:.1f} ms apart")
    watched = last_value(start, 0x1016, 1)
    expect(watched >> 16 & 0x7F == MASTER_NODE, f"node {node} watches node {watched >> 16} (1016h)")
    master_s = median_period_s([frame.time_s for frame in shown if frame.id == 0x700 + MASTER_NODE])
    expect(2 * master_s <= 1e-3 * (watched & 0xFFFF),
           f"node {node}: the master's heartbeat comes every {1e3 * master_s:.0f} ms, 1016h waits {watched & 0xFFFF} ms")
    return f"{1e3 * period_s:.1f} ms apart, {1e3 * asked_s:.0f} ms asked for; the master's {1e3 * master_s:.1f} ms"


def started_last(frames, node):
    for start in starts(frames, node):
        late = next((access for access in accesses(frames, node, start.operational, start.end)
                     if access.is_write and 0x1400 <= access.index < 0x1C00), None)
        expect(late is None, f"node {node} is mapped after it was started")
        # What was on its way when pre-operational was said may follow.
        sent = {frame.id for frame in frames[start.at + 2:start.operational]}
        early = sent & {kind + node for kind in (0x180, 0x280, 0x380, 0x480)}
        expect(not early, f"node {node} sends PDOs while it is set up, before NMT start")
    return f"{len(starts(frames, node))} starts"


def sync_answers(frames, node):
    words = []
    for start in starts(frames, node):
        shown = frames[start.operational:start.end]
        syncs = [frame for frame in shown if frame.id == 0x80]
        expect(all(len(frame.data) in (0, 1) for frame in syncs), "a SYNC has more than a counter")
        expect(len(syncs) > 10, f"only {len(syncs)} SYNCs while node {node} is operational")
        period_s = statistics.median(after.time_s - before.time_s for before, after in zip(syncs, syncs[1:]))
        exponent = last_value(start, 0x60C2, 2)
        asked_s = last_value(start, 0x60C2, 1) * 10.0 ** (exponent - 256 if exponent > 127 else exponent)
        expect(abs(period_s - asked_s) < 0.1 * asked_s,
               f"SYNCs are {1e3 * period_s:.2f} ms apart, 60C2h of node {node} says {1e3 * asked_s:.2f} ms")
        for cob_id, pdo in settled(start).items():
            size = (sum(bits for *_, bits in pdo.entries) + 7) // 8
            sent = [frame for frame in shown if frame.id == cob_id]
            wrong = {len(frame.data) for frame in sent} - {size}
            expect(not wrong, f"{cob_id:03X}: {wrong} bytes, mapped are {size}")
            if pdo.to_drive or not 1 <= pdo.transmission <= 240:
                continue
            due = len(syncs) / pdo.transmission
            expect(abs(len(sent) - due) <= 3,
                   f"{cob_id:03X}: {len(sent)} answers to {len(syncs)} SYNCs, of which one in {pdo.transmission} has one")
            words.append(f"{len(sent)} of {cob_id:03X} to {len(syncs)}")
    expect(words, f"node {node} has no PDO that answers SYNC")
    return ", ".join(words)


def place(pdos, index):
    """(COB-ID, first byte) where an object is mapped."""
    for cob_id, pdo in pdos.items():
        bits = 0
        for entry, _, size in pdo.entries:
            if entry == index:
                return cob_id, bits // 8
            bits += size
    raise Broken(f"{index:04X}h is in no PDO")


def controlwords(frames, node):
    """Each new controlword with the statusword that was the newest then, while operational: [[(word, status)]]."""
    found = []
    for start in starts(frames, node):
        pdos = settled(start)
        (command, command_at), (state, state_at) = place(pdos, 0x6040), place(pdos, 0x6041)
        words, status = [], None
        for frame in frames[start.operational:start.end]:
            if frame.id == state:
                status = number(frame.data[state_at:state_at + 2])
            elif frame.id == command:
                word = number(frame.data[command_at:command_at + 2]) & 0x8F
                if not words or words[-1][0] != word:
                    words.append((word, status))
        found.append(words)
    return found


def enabled_in_steps(frames, node):
    steps = {0x07: (0x06, 0x21, "ready to switch on"), 0x0F: (0x07, 0x23, "switched on")}
    raised = 0
    for words in controlwords(frames, node):
        for (before, _), (word, status) in zip(words, words[1:]):
            if word not in steps or (before, word) == (0x0F, 0x07):  # down again is as good
                continue
            expected, state, name = steps[word]
            expect(before == expected, f"node {node}: controlword {before:02X}h is followed by {word:02X}h")
            expect(status is not None and status & 0x6F == state,
                   f"node {node}: controlword {word:02X}h while it is not {name}")
            raised += word == 0x0F
    expect(raised, f"node {node} is never enabled by 06h, 07h, 0Fh")
    return f"{raised} times"


def fault_reset_edge(frames, node):
    edges = 0
    for words in controlwords(frames, node):
        for i, (word, status) in enumerate(words):
            if not word & FAULT_RESET:
                continue
            expect(i > 0, f"node {node}: bit 7 of the controlword is set from the first one on: no edge")
            expect(status is not None and status & 0x4F == 0x08, f"node {node}: a fault is reset where there is none")
            expect(i + 1 < len(words), f"node {node}: bit 7 of the controlword stays set")
            edges += 1
    expect(edges, f"node {node}: no fault is reset in this capture")
    return f"{edges} edges"


def emergencies(frames, node):
    sent = [frame for frame in frames if frame.id == 0x80 + node]
    codes = []
    for frame in sent:
        expect(len(frame.data) == 8, f"an EMCY of node {node} has {len(frame.data)} bytes")
        code, register = number(frame.data[:2]), frame.data[2]
        expect(code == 0 or register & 1,
               f"node {node}: EMCY {code:04X}h with the error register {register:02X}h says that there is no error")
        codes.append(f"{code:04X}h")
    expect(any(code != "0000h" for code in codes), f"node {node} sends no EMCY in this capture")
    return ", ".join(codes)


# What is asked of every node, and of the one that had a fault.
RULES = {
    "boot-up after a reset": bootup,
    "identity before any write": identity_first,
    "PDOs are mapped in the right order": remapping_order,
    "heartbeats as 1017h and 1016h say": heartbeats,
    "NMT start after the mapping": started_last,
    "SYNC is answered": sync_answers,
    "controlword 06h, 07h, 0Fh": enabled_in_steps,
}
RULES_OF_A_FAULT = {
    "fault reset by an edge": fault_reset_edge,
    "EMCY of 8 bytes": emergencies,
}


def judge(frames, nodes, faulty_nodes):
    """[(rule, node, whether it holds, words)]."""
    verdicts = []
    for node in nodes:
        for name, rule in (RULES | (RULES_OF_A_FAULT if node in faulty_nodes else {})).items():
            try:
                verdicts.append((name, node, True, rule(frames, node)))
            except Broken as broken:
                verdicts.append((name, node, False, str(broken)))
    return verdicts


def show(verdicts):
    """Prints them; whether all rules hold."""
    for name, node, holds, words in verdicts:
        print(f"{'ok' if holds else 'FAILED'}: node {node}, {name}: {words}")
    return all(holds for _, _, holds, _ in verdicts)


def main():
    with open(sys.argv[1], encoding="utf-8") as capture:
        frames = parse(capture)
    nodes = [int(node) for node in sys.argv[2:]]
    faulty = [node for node in nodes if any(frame.id == 0x80 + node for frame in frames)]
    return 0 if show(judge(frames, nodes, faulty)) else 1


if __name__ == "__main__":
    sys.exit(main())
