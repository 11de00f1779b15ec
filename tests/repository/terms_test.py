#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Words that the field has another term for (docs/glossary.md, "Words that are not used") stand in no comment, no
identifier (of C++, and of Python in tests/blind) and no document. Texts that the program prints are left out: their
words are part of formats that are kept."""
import re
import unittest

from references import Tree, outside_code

TABLE = re.compile(r"^\| `([^`|]+)` \| ([^|]+) \|$", re.MULTILINE)
HEADING = "## Words that are not used"
# What tells how the project came to be keeps the words of its time.
HISTORY = ("CHANGELOG.md", "docs/glossary.md", "tests/blind/history.md", "tests/repository/terms_test.py")
IN_PYTHON = re.compile(r"tests/blind/.*\.py")
TEXTS = re.compile(r'R"(\w*)\((?s:.*?)\)\1"|"(?:\\.|[^"\\\n])*"')


def unused_words(glossary):
    """What stands in the glossary's table: word -> term."""
    return dict(TABLE.findall(glossary.partition(HEADING)[2]))


def pattern_of(words):
    """Any of them with its endings, alone or as a part of a name: knock, knocks, kKnock_s, KnocksOf. Group 1 or 2 is
    the word."""
    def any_of(forms):
        return "(" + "|".join(forms) + ")(?:s|es|ed|ing)?(?![a-z])"
    return re.compile("(?<![a-z])" + any_of(words) + "|(?<![A-Z])" + any_of(word[0].upper() + word[1:] for word in words))


def without_texts(code):
    return TEXTS.sub(lambda text: "\n" * text.group().count("\n"), code)


def findings(tree):
    words = unused_words(tree.text("docs/glossary.md"))
    pattern = pattern_of(words)
    found = []
    for path in tree.paths():
        if path in HISTORY or not (path.endswith((".h", ".cc", ".md")) or IN_PYTHON.fullmatch(path)):
            continue
        text = tree.text(path)
        lines = outside_code(text) if path.endswith(".md") else without_texts(text).split("\n")
        for number, line in enumerate(lines, 1):
            for match in pattern.finditer(line):
                word = next(filter(None, match.groups()))
                word = word if word in words else word[0].lower() + word[1:]
                found.append(f"{path}:{number}: '{word}' (expected: {words[word].strip()})")
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
