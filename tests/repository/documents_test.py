#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Which documents there are: a README that is read in five minutes, one in every folder of source, and an index of docs/
that leaves nothing out. Where they point is references_test.py's."""
import pathlib
import posixpath
import re
import unittest

from references import LINK, ROOT, Tree, outside_code

MOST_LINES = 150
MOST_BYTES = 256 * 1024  # ten times the largest there is
SOURCE_FOLDERS = ("analysis", "bench", "cmake", "daq", "packaging", "protocols", "schedules")
IS_SOURCE = re.compile(r"\.(?:h|cc|c|in|py|sh|cmake|proto|yaml)$|/run$")


def folders_of_source(paths):
    """Those with source in them. Of tests/ the folders right below it that do not mirror one of the source, which its
    README says once for all."""
    folders = {posixpath.dirname(path) for path in paths if IS_SOURCE.search(path)}
    tests = {folder for folder in folders if re.fullmatch(r"tests/\w+", folder)
             and folder.removeprefix("tests/") not in SOURCE_FOLDERS}
    return {folder for folder in folders if folder.split("/")[0] in SOURCE_FOLDERS} | tests


def linked_from(tree, page):
    """The files that a page links to."""
    found = set()
    for line in outside_code(tree.text(page)):
        for targets in LINK.findall(line):
            target = next(filter(None, targets)).partition("#")[0]
            if target and not re.match(r"[a-z]+:", target):
                found.add(posixpath.normpath(posixpath.join(posixpath.dirname(page), target)))
    return found


def findings(tree):
    found = []
    lines = tree.text("README.md").count("\n")
    if lines > MOST_LINES:
        found.append(f"README.md has {lines} lines (expected at most {MOST_LINES}: the rest belongs into docs/)")
    for folder in sorted(folders_of_source(tree.paths())):
        if not tree.exists(f"{folder}/README.md"):
            found.append(f"{folder} has no README.md (expected: what it is, what goes in and comes out, what to read first)")
    indexed, new = set(), {"docs/README.md"}
    while new:
        indexed |= new
        new = {page for known in new for page in linked_from(tree, known)
               if page.startswith("docs/") and posixpath.basename(known) == "README.md"} - indexed
    for path in tree.paths():
        if path.startswith("docs/") and path.endswith(".md") and path not in indexed:
            found.append(f"{path} is in no index (expected a link in docs/README.md, or in the README of its folder)")
    return found


def too_large(sizes):
    """What no source is: the memory of a program that crashed, a record, an archive."""
    return [f"{path} has {size} bytes (expected at most {MOST_BYTES}: is it source?)"
            for path, size in sorted(sizes.items()) if size > MOST_BYTES]


GOOD = {"README.md": "# x\n", "bench/README.md": "# bench\n", "bench/a.h": "", "tests/README.md": "# tests\n",
        "tests/bench/a_test.cc": "", "docs/README.md": "[a](a.md) [b](b/README.md)\n", "docs/a.md": "",
        "docs/b/README.md": "[c](c.md)\n", "docs/b/c.md": ""}


class Documents(unittest.TestCase):
    def test_of_this_checkout_are_all_there(self):
        tree = Tree()
        self.assertGreater(len(folders_of_source(tree.paths())), 40, "hardly a folder: the test looks in the wrong place")
        found = findings(tree)
        if found:
            self.fail("\n" + "\n".join(found))

    def test_no_file_of_this_checkout_is_too_large(self):
        self.assertEqual(too_large({path: (ROOT / path).stat().st_size for path in Tree().all_paths()}), [])

    def test_a_file_that_is_too_large_is_found(self):
        self.assertEqual(too_large({"core": 262_145, "a.h": 262_144}),
                         ["core has 262145 bytes (expected at most 262144: is it source?)"])

    def test_what_is_as_it_should_be_is_not_found_fault_with(self):
        self.assertEqual(findings(Tree(GOOD)), [])

    def test_a_readme_that_is_too_long_is_found(self):
        self.assertEqual(findings(Tree({**GOOD, "README.md": "x\n" * 150})), [])
        self.assertEqual(findings(Tree({**GOOD, "README.md": "x\n" * 151})),
                         ["README.md has 151 lines (expected at most 150: the rest belongs into docs/)"])

    def test_a_folder_of_source_without_a_readme_is_found(self):
        said = "has no README.md (expected: what it is, what goes in and comes out, what to read first)"
        self.assertEqual(findings(Tree({**GOOD, "bench/devices/b.cc": ""})), [f"bench/devices {said}"])
        self.assertEqual(findings(Tree({**GOOD, "tests/vm/run.sh": ""})), [f"tests/vm {said}"])

    def test_a_page_that_no_index_names_is_found(self):
        said = "is in no index (expected a link in docs/README.md, or in the README of its folder)"
        self.assertEqual(findings(Tree({**GOOD, "docs/d.md": ""})), [f"docs/d.md {said}"])
        # A page that another page names, but no index, is found by nobody who does not read that one.
        self.assertEqual(findings(Tree({**GOOD, "docs/a.md": "[e](e.md)", "docs/e.md": ""})), [f"docs/e.md {said}"])


if __name__ == "__main__":
    unittest.main()
