#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files of one folder are compiled together (cmake/strainwave.cmake), so that each sees the functions of all others. A function
of one file alone, in an anonymous namespace, must not be one that a call elsewhere could mean: the compiler would take it for an
overload, and the better match, without a word.
"""
import os
import pathlib
import re
import unittest
from collections import defaultdict

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ("analysis", "bench", "daq", "protocols", "schedules")
FUNCTION = re.compile(r"^(?:template <[^>]*>\s*)?(?:\[\[\w+\]\] )?(?:inline |constexpr |static )*"
                      r"[A-Za-z_][\w:<>,&\*\s]*?[\s&\*]([A-Z]\w+)\(", re.M)
LOCAL = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.M | re.S)
# What converts into each other without being asked.
NUMBERS = re.compile(r"^(double|float|bool|char|int|long|unsigned|(std::)?u?int\d+_t|std::size_t|std::ptrdiff_t|(std::chrono::)?\w*seconds)$")
TEXTS = re.compile(r"^(std::string|std::string_view|char\*|std::filesystem::path|fs::path)$")
ANYTHING = re.compile(r"auto|span|vector|function|^(T|Value)$")


def parameters(text, begin):
    """Types and whether they have a default, of a parameter list that begins there."""
    found, current, depth, i = [], "", 0, begin
    while depth >= 0:
        c = text[i]
        depth += (c in "([{<") - (c in ")]}" or (c == ">" and text[i - 1] != "-"))
        if c == "," and depth == 0:
            found.append(current)
            current = ""
        elif depth >= 0:
            current += c
        i += 1
    types = []
    for one in found + [current] * bool(current.strip()):
        declared = re.sub(r"\bconst\b|&", "", one.split("=")[0]).strip()
        named = re.match(r"(.*\S)\s+\w+$|(.*\*)\s*\w+$", declared)
        types.append((re.sub(r"\s+", "", (named[1] or named[2]) if named else declared), "=" in one))
    return types


def converts(a, b):
    both = lambda pattern: pattern.search(a) and pattern.search(b)
    return a.split("::")[-1] == b.split("::")[-1] or bool(both(NUMBERS) or both(TEXTS) or ANYTHING.search(a) or ANYTHING.search(b))


def may_be_meant(a, b):
    """Whether a call could have arguments that fit both lists of parameters."""
    needed = max(sum(not default for _, default in one) for one in (a, b))
    return needed <= min(len(a), len(b)) and all(converts(x[0], y[0]) for x, y in zip(a, b))


def space(text):
    found = re.search(r"^namespace ([\w:]+) \{", text, re.M)
    return found[1] if found else ""


def reached(file, included):
    seen, left = set(), [file]
    while left:
        for one in included[left.pop()]:
            if one not in seen:
                seen.add(one)
                left.append(one)
    return seen


def clashes(texts):
    """texts: the code by path."""
    included = {file: [i for i in re.findall(r'#include "([^"]+)"', text) if i in texts] for file, text in texts.items()}
    declared, local = defaultdict(list), []
    for file, text in texts.items():
        if file.endswith(".h"):
            for one in FUNCTION.finditer(text):
                declared[one[1]].append((space(text), file, parameters(text, one.end())))
        else:
            for part in LOCAL.finditer(text):
                local += [(one[1], space(text), file, parameters(part[1], one.end())) for one in FUNCTION.finditer(part[1])]
    found = []
    for name, own, file, types in local:
        known = reached(file, included)
        for outer, header, others in declared[name]:
            if header not in known and (own + "::").startswith(outer + "::") and may_be_meant(types, others):
                found.append(f"{file}: {name} could be meant by a call of that of {header}")
    for i, (name, own, file, types) in enumerate(local):
        for other_name, other, beside, others in local[i + 1:]:
            if name == other_name and own == other and file != beside and os.path.dirname(file) == os.path.dirname(beside) \
                    and may_be_meant(types, others):
                found.append(f"{file}: {name} could be meant by a call of that of {beside}")
    return found


class Overloads(unittest.TestCase):
    maxDiff = None

    def test_no_function_of_one_file_could_be_meant_elsewhere(self):
        texts = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for folder in FOLDERS
                 for path in (ROOT / folder).rglob("*") if path.suffix in (".h", ".cc")}
        self.assertGreater(len(texts), 500)
        self.assertEqual(clashes(texts), [])

    def test_finds_one(self):
        header = "namespace a {\nstd::string Quoted(std::string_view text);\n}\n"
        code = "namespace a::b {\nnamespace {\n\nstd::string Quoted(%s) {\n}\n\n}  // namespace\n}\n"
        for types, count in (("const std::string& text", 1), ("std::string_view text, int width = 3", 1), ("int number", 0),
                             ("std::string_view text, int width", 0), ("", 0)):
            self.assertEqual(len(clashes({"a/q.h": header, "b/c.cc": code % types})), count, types)
        self.assertEqual(clashes({"a/q.h": header, "b/c.cc": '#include "a/q.h"\n' + code % "std::string_view text"}), [])
        beside = {"b/c.cc": code % "double x", "b/d.cc": code % "int n"}
        self.assertEqual(clashes(beside), ["b/c.cc: Quoted could be meant by a call of that of b/d.cc"])


if __name__ == "__main__":
    unittest.main()
