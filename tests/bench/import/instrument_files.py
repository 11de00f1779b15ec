# SPDX-License-Identifier: Apache-2.0
"""Files as instruments write them, made from the formats' descriptions by another route than the program's: MAT 5,
UFF 58 and 58b, TDMS. Sources: docs/sources.md#mat-file, #uff, #tdms."""
import ctypes
import ctypes.util
import struct
import zlib

import numpy

_CLASS = {"f8": 6, "f4": 7, "i1": 8, "u1": 9, "i2": 10, "u2": 11, "i4": 12, "u4": 13, "i8": 14, "u8": 15}
_TYPE = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 9, "i8": 12, "u8": 13}


def _element(kind, payload):
    return struct.pack("<II", kind, len(payload)) + payload + b"\0" * (-len(payload) % 8)


def _array(name, cls, dims, *parts, flags=0):
    head = _element(6, struct.pack("<II", cls | flags << 8, 0))
    head += _element(5, struct.pack(f"<{len(dims)}i", *dims)) + _element(1, name.encode())
    return _element(14, head + b"".join(parts))


def mat_variable(name, value):
    """Text, an array of numbers (rows × columns), a dict (struct) or a list (cell array)."""
    if isinstance(value, str):
        return _array(name, 4, (1, len(value)), _element(4, value.encode("utf-16-le")))
    if isinstance(value, dict):
        width = 1 + max(map(len, value))
        names = b"".join(key.encode().ljust(width, b"\0") for key in value)
        return _array(name, 2, (1, 1), struct.pack("<HHI", 5, 4, width), _element(1, names),
                      *(mat_variable("", entry) for entry in value.values()))
    if isinstance(value, list):
        return _array(name, 1, (1, len(value)), *(mat_variable("", entry) for entry in value))
    value = numpy.atleast_2d(value)
    if value.dtype.kind == "c":
        parts = (_element(9, part.astype("<f8").tobytes("F")) for part in (value.real, value.imag))
        return _array(name, 6, value.shape, *parts, flags=8)
    code = value.dtype.str[1:]
    return _array(name, _CLASS[code], value.shape, _element(_TYPE[code], value.astype("<" + code).tobytes("F")))


def mat5(path, variables, compressed=False):
    text = b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + struct.pack("<H2s", 0x0100, b"IM")
    for name, value in variables.items():
        one = mat_variable(name, value)
        if compressed:
            packed = zlib.compress(one)
            one = struct.pack("<II", 15, len(packed)) + packed
        text += one
    path.write_bytes(text)
    return path


def uff_set(name, values, step=None, times=None, unit="m/s^2", binary=None, exponent="E", end="\n", before_border="",
            said_bytes=None, function=1, double=True):
    """binary: None, or '<' or '>'."""
    even = times is None
    if binary:
        wide = {True: "f8", False: "f4"}[double]
        raw = b""
        for i, value in enumerate(values):
            if not even:
                raw += struct.pack(binary + "f", times[i])
            raw += numpy.array(value, binary + wide).tobytes()
        size = len(raw) if said_bytes is None else said_bytes
        kind = f"    58b{1 if binary == '<' else 2:6d}{2:6d}{11:12d}{size:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
    else:
        kind = "    58"
    number = {True: lambda v: f"{v:20.11E}", False: lambda v: f"{v:13.5E}"}[double]
    lines = ["    -1", kind, f"{name:<80}", "NONE", "29-NOV-26 12:00:00", "NONE", "NONE",
             f"{function:5d}{1:10d}{0:5d}{0:10d} {'NONE':<10}{7:10d}{3:4d} {'NONE':<10}{0:10d}{0:4d}",
             f"{4 if double else 2:10d}{len(values):10d}{1 if even else 0:10d}{0.0:13.5E}{step or 0.0:13.5E}{0.0:13.5E}",
             f"{17:10d}{0:5d}{0:5d}{0:5d} {'time':<20} {'s':<20}",
             f"{12:10d}{0:5d}{0:5d}{0:5d} {'acceleration':<20} {unit:<20}",
             f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {'NONE':<20}", f"{0:10d}{0:5d}{0:5d}{0:5d} {'NONE':<20} {'NONE':<20}"]
    head = (end.join(lines) + end).encode()
    if binary:
        return head + raw + before_border.encode() + f"    -1{end}".encode()
    body = ""
    each = 4 if double and even else 2 if double else 6 if even else 3
    for at in range(0, len(values), each):
        row = "".join(("" if even else f"{times[i]:13.5E}") + number(values[i]) for i in range(at, min(at + each, len(values))))
        body += row.replace("E", exponent) + end
    return head + body.encode() + before_border.encode() + f"    -1{end}".encode()


_TDMS = {"i1": 1, "i2": 2, "i4": 3, "i8": 4, "u1": 5, "u2": 6, "u4": 7, "u8": 8, "f4": 9, "f8": 10}


def _text(text):
    return struct.pack("<I", len(text.encode())) + text.encode()


def _property(name, value):
    if isinstance(value, str):
        return _text(name) + struct.pack("<I", 0x20) + _text(value)
    if isinstance(value, int):
        return _text(name) + struct.pack("<Ii", 3, value)
    return _text(name) + struct.pack("<Id", 10, value)


def tdms_segment(objects, chunks=1, interleaved=False, new_list=True, unfinished=False, daqmx=False, same=False):
    """objects: {path: (values or None, properties)}; values of all chunks, one after the other."""
    meta = struct.pack("<I", len(objects))
    for path, (values, properties) in objects.items():
        meta += _text(path)
        if daqmx and values is not None:
            meta += struct.pack("<I", 0x1269)
        elif values is None:
            meta += struct.pack("<I", 0xFFFFFFFF)
        elif same:
            meta += struct.pack("<I", 0)
        else:
            meta += struct.pack("<IIIQ", 20, _TDMS[values.dtype.str[1:]], 1, len(values) // chunks)
        meta += struct.pack("<I", len(properties)) + b"".join(_property(*pair) for pair in properties.items())
    channels = [values for values, _ in objects.values() if values is not None]
    raw = b""
    if interleaved:
        raw = b"".join(value.tobytes() for row in zip(*channels, strict=True) for value in row)
    else:
        for c in range(chunks):
            for values in channels:
                each = len(values) // chunks
                raw += values[c * each:(c + 1) * each].tobytes()
    contents = 2 | (4 if new_list else 0) | (8 if raw else 0) | (32 if interleaved else 0) | (128 if daqmx else 0)
    size = 2**64 - 1 if unfinished else len(meta) + len(raw)
    return b"TDSm" + struct.pack("<IIQQ", contents, 4713, size, len(meta)) + meta + raw


class _SoundInfo(ctypes.Structure):
    _fields_ = [("frames", ctypes.c_int64), ("samplerate", ctypes.c_int), ("channels", ctypes.c_int), ("format", ctypes.c_int),
                ("sections", ctypes.c_int), ("seekable", ctypes.c_int)]


def flac(path, values, rate):
    """24-bit whole numbers, rows of channels, as libsndfile writes them."""
    library = ctypes.CDLL(ctypes.util.find_library("sndfile"))
    library.sf_open.restype, library.sf_open.argtypes = ctypes.c_void_p, [ctypes.c_char_p, ctypes.c_int, ctypes.POINTER(_SoundInfo)]
    library.sf_writef_int.restype = ctypes.c_int64
    library.sf_writef_int.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64]
    library.sf_close.argtypes = [ctypes.c_void_p]
    write, flac_24 = 0x20, 0x170003
    file = library.sf_open(str(path).encode(), write, ctypes.byref(_SoundInfo(0, rate, values.shape[1], flac_24, 0, 0)))
    numbers = numpy.ascontiguousarray(values.astype("<i4") << 8)
    assert library.sf_writef_int(file, numbers.ctypes.data, len(values)) == len(values)
    library.sf_close(file)
    return path
