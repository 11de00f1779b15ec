#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Words that the field has another term for (docs/glossary.md, "Words that are not used") stand in no comment, no
identifier and no document. Texts that the program prints are left out: their words are part of formats that are kept."""
import re
import unittest

from references import Tree, outside_code

TABLE = re.compile(r"^\| `([^`|]+)` \| ([^|]+) \|$", re.MULTILINE)
HEADING = "## Words that are not used"
# What tells how the project came to be keeps the words of its time.
HISTORY = ("CHANGELOG.md", "docs/glossary.md", "tests/blind/history.md", "tests/repository/terms_test.py")
TEXTS = re.compile(r'R"(\w*)\((?s:.*?)\)\1"|"(?:\\.|[^"\\\n])*"')


def unused_words(glossary):
    """What stands in the glossary's table: word -> term."""
    return dict(TABLE.findall(glossary.partition(HEADING)[2]))


def pattern_of(word):
    """The word with its endings, alone or as a part of a name: knock, knocks, kKnock_s, KnocksOf."""
    capital = word[0].upper() + word[1:]
    return re.compile(rf"(?<![a-z]){word}(?:s|es|ed|ing)?(?![a-z])|(?<![A-Z]){capital}(?:s|es|ed|ing)?(?![a-z])")


def without_texts(code):
    return TEXTS.sub(lambda text: "\n" * text.group().count("\n"), code)


def findings(tree):
    words = {pattern_of(word): (word, term.strip()) for word, term in unused_words(tree.text("docs/glossary.md")).items()}
    found = []
    for path in tree.paths():
        if path in HISTORY or not path.endswith((".h", ".cc", ".md")):
            continue
        text = tree.text(path)
        lines = outside_code(text) if path.endswith(".md") else without_texts(text).split("\n")
        for number, line in enumerate(lines, 1):
            found += [f"{path}:{number}: '{word}' (expected: {term})" for pattern, (word, term) in words.items()
                      if pattern.search(line)]
    return found


class Terms(unittest.TestCase):
    def test_of_the_field_alone_are_used(self):
        tree = Tree()
        self.assertTrue(unused_words(tree.text("docs/glossary.md")))
        self.assertEqual(findings(tree), [])

    def test_are_told_by_file_and_line(self):
        tree = Tree({"docs/glossary.md": f"{HEADING}\n\n| `knock` | impact |\n",
                     "a.cc": "// no knock\nint kKnocksInACell;\nauto text = \"a knock\";  // knocking\nint unknocked;\n"})
        self.assertEqual(findings(tree), ["a.cc:1: 'knock' (expected: impact)", "a.cc:2: 'knock' (expected: impact)",
                                               "a.cc:3: 'knock' (expected: impact)"])


if __name__ == "__main__":
    unittest.main()
