# SPDX-License-Identifier: Apache-2.0
"""Where comments and documents point, and whether anything is there.

A comment names a page, and a section or a row of it: `docs/contract.md#exit-codes`, `docs/effects.md E17`,
`docs/requirements.md R10 and R12`. After that, rows of the page may stand alone in the same file (`E12`). What a paper
is cited by (`Automatica 30 (1994) 1083`) is in docs/sources.md, with its title. Documents have Markdown links.

Anchors of a page are its headings, as GitHub makes them, and `<a id="e17">`; a heading that is not plain ASCII has
none, since what becomes of its signs is not worth guessing."""
import pathlib
import posixpath
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = (".ci", "analysis", "bench", "cmake", "daq", "docs", "packaging", "protocols", "schedules", "tests")
# The latter two point to nothing on purpose.
NOT_READ = ("tests/fuzz/corpus/", "tests/repository/references_test.py", "tests/repository/documents_test.py")
ROWS = {"E": "docs/effects.md", "R": "docs/requirements.md"}
SOURCES = "docs/sources.md"

PAGE = re.compile(r"(?<![\w/.-])(docs/[\w./-]*\w\.md)(?:#([\w-]*\w))?((?:(?:,| and| to|)\s[A-Z]\d+\b)*)")
ROW = re.compile(r"(?<![\w/#.-])([ER])(\d+)\b(?![/-])")
ROW_LITERAL = re.compile(r'"([ER])(\d+)"')
JOURNAL = re.compile(r"\b\d+ \((?:19|20)\d\d\) \d+")
LINK = re.compile(r"\]\(\s*<?([^)>\s]+)>?(?:\s+\"[^\"]*\")?\)|^\[[^\]]+\]:\s+(\S+)")
PATH_IN_CODE = re.compile(rf"`((?:{'|'.join(FOLDERS[1:])})/[\w./-]+\.\w+)`")
# A file of source, by its path or the end of it.
SOURCE_IN_CODE = re.compile(r"`(?:\./)?([a-z0-9_./-]*[a-z0-9_]\.(?:h|cc|py|sh|cmake|proto))`")
# A program of the tests, and where one is declared.
TEST_PROGRAM = re.compile(r"\bbuild/(?:tests|benchmarks)/([a-z]\w+)")
DECLARED = re.compile(r"^(?:strainwave_tests?|strainwave_kernel_device_test|add_executable)\((\w+)", re.MULTILINE)
# Words for the same things that lead nowhere.
LOST = re.compile(r"\bBENCH (?:rows?|section|E)\b|\bcontract,? sections?\b|\bsection \d of the contract\b|\bseed 00\d")


class Tree:
    """The files of a checkout; or of a test, `texts` by path."""

    def __init__(self, texts=None):
        self._texts = texts
        self._read = dict(texts or {})
        self._anchors = {}
        self._ends = self._programs = None

    def text(self, path):
        if path not in self._read:
            try:
                self._read[path] = (ROOT / path).read_text(encoding="utf-8") if self._texts is None else ""
            except (UnicodeDecodeError, OSError):
                self._read[path] = ""
        return self._read[path]

    def exists(self, path):
        if self._texts is not None:
            return any(known == path or known.startswith(path.rstrip("/") + "/") for known in self._texts)
        return (ROOT / path).exists()

    def anchors(self, path):
        if path not in self._anchors:
            self._anchors[path] = anchors_of(self.text(path))
        return self._anchors[path]

    def all_paths(self):
        if self._texts is not None:
            return sorted(self._texts)
        found = [path for path in ROOT.iterdir() if path.is_file()]
        for folder in FOLDERS:
            found += [path for path in (ROOT / folder).rglob("*") if path.is_file()]
        return sorted(path.relative_to(ROOT).as_posix() for path in found)

    def paths(self):
        return [path for path in self.all_paths() if not path.startswith(NOT_READ) and not path.endswith(".pyc")]

    def has_source(self, end):
        """Whether a file's path ends in this."""
        if self._ends is None:
            parts = (path.split("/") for path in self.all_paths())
            self._ends = {"/".join(part[i:]) for part in parts for i in range(len(part))}
        return end in self._ends

    def builds(self, program):
        if self._programs is None:
            build_files = [path for path in self.paths() if path.endswith(("CMakeLists.txt", ".cmake"))]
            self._programs = {name for path in build_files for name in DECLARED.findall(self.text(path))}
        return program in self._programs


def outside_code(text):
    """The lines of a Markdown page with what is in fences and code spans blanked."""
    fenced = False
    for line in text.split("\n"):
        if line.lstrip().startswith("```"):
            fenced = not fenced
            yield ""
        else:
            yield "" if fenced else re.sub(r"`[^`]*`", lambda span: " " * len(span.group()), line)


def anchors_of(text):
    found = set()
    for line, plain in zip(text.split("\n"), outside_code(text)):
        found.update(re.findall(r'<a id="([^"]+)">', plain))
        if plain.startswith("#") and line.isascii():
            title = re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower()).replace(" ", "-")
            count = sum(1 for known in found if re.fullmatch(re.escape(title) + r"(-\d+)?", known))
            found.add(f"{title}-{count}" if count else title)
    return found


def comment_in(line):
    """What a line of C++ says to people; an address (`tcp://`) is no comment."""
    at = re.search(r"(?<!:)//+<?", line)
    return line[at.end():] if at else ""


def findings(path, tree):
    """Everything in the file at `path` that points to nothing, as `PATH:LINE: what`."""
    text, is_cpp, is_page = tree.text(path), path.endswith((".h", ".cc", ".c")), path.endswith(".md")
    lines = text.split("\n")
    prose = [comment_in(line) for line in lines] if is_cpp else list(outside_code(text)) if is_page else lines
    found = []

    def miss(index, what):
        found.append(f"{path}:{index + 1}: {what}")

    for i, line in enumerate(lines):
        for page, anchor, rows in PAGE.findall(LINK.sub("", line) if is_page else line):
            if not tree.exists(page):
                miss(i, f"there is no {page}")
                continue
            for name in [anchor] * bool(anchor) + re.findall(r"[A-Z]\d+", rows):
                if name.lower() not in tree.anchors(page):
                    miss(i, f"{page} has no {name}")
        for program in TEST_PROGRAM.findall(line):
            if not tree.builds(program):
                miss(i, f"nothing builds {program} (expected a program of a CMakeLists.txt; a test of one: ctest -R NAME)")
        if LOST.search(line):
            miss(i, f"'{LOST.search(line).group()}' leads nowhere (expected a page of docs/)")
    for i, line in enumerate(prose):
        if is_cpp or is_page:
            for kind, number in ROW.findall(PAGE.sub("", line)) + (ROW_LITERAL.findall(lines[i]) if is_cpp else []):
                if f"{kind}{number}".lower() not in tree.anchors(ROWS[kind]):
                    miss(i, f"{ROWS[kind]} has no {kind}{number}")
            for kind, number in ROW.findall(PAGE.sub("", line)):
                if posixpath.basename(ROWS[kind]) not in text and path != ROWS[kind]:
                    miss(i, f"{kind}{number} of what? (expected {ROWS[kind]} somewhere in the file)")
        if is_cpp:
            joined = line + " " + (prose[i + 1].strip() if i + 1 < len(prose) else "")
            for cited in JOURNAL.finditer(joined):
                if cited.start() < len(line) and cited.group() not in tree.text(SOURCES):
                    miss(i, f"'{cited.group()}' is not in {SOURCES}")
        if is_page:
            for targets in LINK.findall(line):
                target = next(filter(None, targets))
                if re.match(r"[a-z]+:", target):
                    continue
                file, _, anchor = target.partition("#")
                goal = posixpath.normpath(posixpath.join(posixpath.dirname(path), file)) if file else path
                if goal.startswith("..") or not tree.exists(goal):
                    miss(i, f"the link {target} leads to no file")
                elif anchor and anchor not in tree.anchors(goal):
                    miss(i, f"{goal} has no #{anchor}")
            for named in SOURCE_IN_CODE.findall(lines[i]):
                if not tree.has_source(re.sub(r"^(\.\./)+", "", named)):
                    miss(i, f"there is no {named}")
        if path.startswith("docs/"):
            for named in PATH_IN_CODE.findall(lines[i]):
                if not tree.exists(named) and not SOURCE_IN_CODE.fullmatch(f"`{named}`"):
                    miss(i, f"there is no {named}")
    return found


def all_findings(tree):
    return [finding for path in tree.paths() for finding in findings(path, tree)]
