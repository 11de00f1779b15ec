#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Every page, section, row and paper that the files of this checkout name is there, and every Markdown link leads to
something. references.py says how they are named."""
import unittest

from references import Tree, all_findings, anchors_of

PAGES = {
    "docs/effects.md": '## Bearing life\n| <a id="e5"></a>E5 | stiffness |\n| <a id="e17"></a>E17 | compliance |\n',
    "docs/requirements.md": '| <a id="r14"></a>R14 | stops by itself |\n',
    "docs/sources.md": "A survey of models. Automatica 30 (1994) 1083–1138.\n",
}


def found_in(name, text):
    return all_findings(Tree({**PAGES, name: text}))


class References(unittest.TestCase):
    def test_all_of_this_checkout_lead_somewhere(self):
        tree = Tree()
        pointing = [path for path in tree.paths() if "docs/" in tree.text(path)]
        self.assertGreater(len(pointing), 50, "hardly a file points anywhere: the test looks in the wrong place")
        found = all_findings(tree)
        if found:
            self.fail("\n" + "\n".join(found))

    def test_a_reference_that_is_there_is_not_found_fault_with(self):
        self.assertEqual(found_in("a.h", "/// In series (docs/effects.md E5, E17): E5 alone; docs/effects.md#bearing-life.\n"
                                         "/// A survey (Automatica 30\n/// (1994) 1083), docs/requirements.md R14.\n"
                                         '  {"series", "E17"},  // of tcp://E99\n'), [])

    def test_a_missing_page_is_found(self):
        self.assertEqual(found_in("a.py", "# as docs/effect.md says\n"), ["a.py:1: there is no docs/effect.md"])

    def test_a_missing_section_is_found(self):
        self.assertEqual(found_in("a.cc", "\n// docs/effects.md#gear-life\n"), ["a.cc:2: docs/effects.md has no gear-life"])

    def test_a_missing_row_is_found_wherever_it_stands(self):
        self.assertEqual(found_in("a.h", "// docs/effects.md E5 to E18\n"), ["a.h:1: docs/effects.md has no E18"])
        self.assertEqual(found_in("a.h", "// docs/effects.md E5,\n// E26\n"), ["a.h:2: docs/effects.md has no E26"])
        self.assertEqual(found_in("a.cc", '  .effect = "E30",\n'), ["a.cc:1: docs/effects.md has no E30"])
        self.assertEqual(found_in("a.h", "int a;  // docs/requirements.md R15\n"),
                         ["a.h:1: docs/requirements.md has no R15"])

    def test_a_row_alone_needs_its_page_in_the_same_file(self):
        self.assertEqual(found_in("a.h", "int a;  // E17\n"),
                         ["a.h:1: E17 of what? (expected docs/effects.md somewhere in the file)"])

    def test_a_paper_without_its_title_is_found(self):
        self.assertEqual(found_in("a.h", "/// Source: Nobody, Biometrika 65\n/// (1978) 297.\n"),
                         ["a.h:1: '65 (1978) 297' is not in docs/sources.md"])

    def test_names_that_nobody_can_look_up_are_found(self):
        for name in ("BENCH " + "row 14", "contract, " + "section 3", "seed " + "003"):
            with self.subTest(name):
                self.assertEqual(len(found_in("a.py", f"# {name}\n")), 1)

    def test_a_link_to_nothing_is_found(self):
        for link, said in (("../docs/efects.md", "the link ../docs/efects.md leads to no file"),
                           ("../../outside.md", "the link ../../outside.md leads to no file"),
                           ("#top", "bench/README.md has no #top"),
                           ("../docs/effects.md#gear-life", "docs/effects.md has no #gear-life")):
            with self.subTest(link):
                self.assertEqual(found_in("bench/README.md", f"# Bench\n[here]({link})\n"), [f"bench/README.md:2: {said}"])
        self.assertEqual(found_in("bench/README.md", "# Bench\n[a](#bench) [b](../docs/effects.md#e5) [c](../docs)\n"
                                                     "[d](https://example.org/x.md#y)\n```\n[e](nothing.md)\n```\n"), [])

    def test_a_page_that_names_a_file_which_is_not_there_is_found(self):
        self.assertEqual(found_in("docs/bench.md", "`bench/no/such.h` and `docs/effects.md`, `bench/no.yaml`\n"),
                         ["docs/bench.md:1: there is no bench/no/such.h", "docs/bench.md:1: there is no bench/no.yaml"])

    def test_a_page_may_name_a_source_by_the_end_of_its_path(self):
        tree = Tree({**PAGES, "bench/devices/can/bus.h": "", "bench/README.md": "`bus.h`, `can/bus.h`, `an/bus.h`, `no.py`\n"})
        self.assertEqual(all_findings(tree), ["bench/README.md:1: there is no an/bus.h",
                                              "bench/README.md:1: there is no no.py"])

    def test_a_program_that_nothing_builds_is_found(self):
        tree = Tree({**PAGES, "tests/CMakeLists.txt": "strainwave_tests(all_tests FILES\n  one_test)\n",
                     "docs/run.md": "`build/tests/all_tests`\n`build/tests/one_test`\n"})
        self.assertEqual(all_findings(tree), ["docs/run.md:2: nothing builds one_test (expected a program of a "
                                              "CMakeLists.txt; a test of one: ctest -R NAME)"])

    def test_headings_have_the_anchors_that_github_gives_them(self):
        self.assertEqual(anchors_of("# Exit codes\n## `--json`, and more\n## Exit codes\n### K₁\n```\n# no\n```\n"),
                         {"exit-codes", "--json-and-more", "exit-codes-1"})


if __name__ == "__main__":
    unittest.main()
