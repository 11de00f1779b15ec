#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Reads the real numeric arrays of a MATLAB level-5 file.

Source: MathWorks, "MAT-File Format", chapter 1. Little-endian files only; cells, structures, characters and
complex parts are passed over.
"""
import struct
import zlib

import numpy

_NUMBERS = {1: "<i1", 2: "<u1", 3: "<i2", 4: "<u2", 5: "<i4", 6: "<u4", 7: "<f4", 9: "<f8", 12: "<i8", 13: "<u8"}
_MATRIX = 14
_COMPRESSED = 15
_NUMERIC_CLASSES = range(6, 16)


def _elements(data):
    """Yields (type, payload) of each data element."""
    at = 0
    while at + 8 <= len(data):
        kind, size = struct.unpack_from("<II", data, at)
        if kind >> 16:  # small element: size in the upper half, payload in the second word
            kind, size = kind & 0xFFFF, kind >> 16
            yield kind, data[at + 4:at + 4 + size]
            at += 8
            continue
        yield kind, data[at + 8:at + 8 + size]
        at += 8 + size
        if kind != _COMPRESSED:
            at += -size % 8


def _array(payload):
    """(name, array) of a matrix element, or None where it is not a real numeric array."""
    parts = list(_elements(payload))
    flags = struct.unpack_from("<I", parts[0][1])[0]
    if flags & 0xFF not in _NUMERIC_CLASSES or flags & 0x800:
        return None
    shape = numpy.frombuffer(parts[1][1], "<i4")
    kind, numbers = parts[3]
    values = numpy.frombuffer(numbers, _NUMBERS[kind]).astype(float)
    return parts[2][1].decode("ascii"), values.reshape(shape, order="F")


def read(path):
    """All real numeric arrays of the file, by name."""
    with open(path, "rb") as file:
        data = file.read()
    if len(data) < 128 or data[126:128] != b"IM":
        raise ValueError(f"{path}: error: not a little-endian MATLAB level-5 file")
    arrays = {}
    for kind, payload in _elements(data[128:]):
        if kind == _COMPRESSED:
            kind, payload = next(_elements(zlib.decompress(payload)))
        found = _array(payload) if kind == _MATRIX else None
        if found:
            arrays[found[0]] = found[1]
    return arrays
