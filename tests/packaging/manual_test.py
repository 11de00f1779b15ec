#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Manual pages that packaging/manual.sh writes of programs whose --help is given here.

  tests/packaging/manual_test.py
"""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "packaging/manual.sh"
OPTIONS = "\nOptions:\n  -h,--help                   Print this help message and exit\n"
TOP = "Tries.\nUsage: ./top [OPTIONS] SUBCOMMAND\n" + OPTIONS + "\nSubcommands:\n  go                          Go.\n"
GO = "Go.\nUsage: ./top go [OPTIONS]\n" + OPTIONS


class Manual(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.pages = self.folder / "pages"

    def program(self, name, helps):
        """A program that says helps[' '.join(its arguments before --help)], and fails where that is None."""
        file = self.folder / name
        rows = ['case "$*" in']
        for number, (words, text) in enumerate(helps.items()):
            said = self.folder / f"{name}.{number}"
            said.write_text(text or "", encoding="utf-8")
            rows.append(f"  '{words}--help') " + (f"cat '{said}'" if text is not None else "echo not now >&2; exit 7") + " ;;")
        file.write_text("\n".join(["#!/bin/sh", *rows, "  *) exit 9 ;;", "esac", ""]), encoding="utf-8")
        file.chmod(0o755)
        return file

    def write(self, *programs):
        return subprocess.run([SCRIPT, self.pages, "1.2.3", *programs], capture_output=True, text=True, check=False)

    def page(self, name, *programs):
        done = self.write(*programs)
        self.assertEqual((done.returncode, done.stdout + done.stderr), (0, ""))
        return (self.pages / f"{name}.1").read_text(encoding="utf-8")

    def refused(self, message, helps):
        self.pages.mkdir()
        (self.pages / "top-old.1").touch()
        done = self.write(self.program("top", helps))
        self.assertEqual((done.returncode, done.stdout, done.stderr), (1, "", f"manual.sh: error: {message}\n"))
        self.assertEqual([file.name for file in self.pages.iterdir()], ["top-old.1"])

    def test_has_names_with_what_is_said_of_them(self):
        text = self.page("top-go", self.program("top", {"": TOP, "go ": (
            "Go on: far.\nSecond line.\nExample: top go \"a b\" \\\n         top go --far\nUsage: /x/top go [OPTIONS] [WHERE]\n\n"
            "Positionals:\n  WHERE TEXT REQUIRED         .hidden folder\n" + OPTIONS +
            "  --a-name-so-long ENUM:value in {one->1}\n                              behind it\n"
            "                              'quoted' at the beginning\n"
            "  --of-27-columns--TEXT=12345 `~^`…\n  --bare\n")}))
        self.assertEqual(text.split('"User Commands"\n')[1], r""".nh
.ad l
.SH NAME
top\-go \- go on
.SH SYNOPSIS
\fBtop go\fR [OPTIONS] [WHERE]
.SH DESCRIPTION
Go on: far. Second line.
.SH ARGUMENTS
.TP
\fBWHERE\fR TEXT REQUIRED
\&.hidden folder
.SH OPTIONS
.TP
\fB\-h,\-\-help\fR
Print this help message and exit
.TP
\fB\-\-a\-name\-so\-long\fR ENUM:value in {one\->1}
behind it
\(aqquoted\(aq at the beginning
.TP
\fB\-\-of\-27\-columns\-\-TEXT=12345\fR
\(ga\(ti\(ha\(ga...
.TP
\fB\-\-bare\fR
.SH EXAMPLES
.nf
top go \(dqa b\(dq \(rs
top go \-\-far
.fi
.SH SEE ALSO
.BR top (1)
""")

    def test_commands_of_commands_have_pages_and_name_each_other(self):
        inner = "Go.\nUsage: top go [OPTIONS] SUBCOMMAND\n" + OPTIONS + (
            "\nSubcommands:\n  up                          Up.\n                              Example: top go up\n"
            "  a-command-that-has-a-long-name\n                              Long.\n")
        leaf = "It goes.\nUsage: top [OPTIONS]\n" + OPTIONS
        text = self.page("top-go", self.program("top", {"": TOP, "go ": inner, "go up ": leaf,
                                                        "go a-command-that-has-a-long-name ": leaf}))
        self.assertEqual({file.name for file in self.pages.iterdir()},
                         {"top-go.1", "top-go-up.1", "top-go-a-command-that-has-a-long-name.1"})
        self.assertTrue(text.endswith(r""".SH COMMANDS
.TP
\fBup\fR
Up.
.TP
\fBa\-command\-that\-has\-a\-long\-name\fR
Long.
.SH SEE ALSO
.BR top (1),
.BR top\-go\-a\-command\-that\-has\-a\-long\-name (1),
.BR top\-go\-up (1)
"""), text)
        self.assertTrue((self.pages / "top-go-up.1").read_text(encoding="utf-8").endswith(
            ".SH SEE ALSO\n.BR top (1),\n.BR top\\-go (1)\n"))

    def test_a_command_and_a_program_of_one_name_share_a_page(self):
        other = self.program("top-go", {"": "top-go walks.\nUsage: top-go [OPTIONS] FOOT\n" + OPTIONS + "  --slowly\n"})
        text = self.page("top-go", self.program("top", {"": TOP, "go ": GO}), other)
        self.assertIn(".SH NAME\ntop\\-go \\- go\n.br\ntop\\-go \\- walks\n.SH SYNOPSIS\n"
                      "\\fBtop go\\fR [OPTIONS]\n.br\n\\fBtop\\-go\\fR [OPTIONS] FOOT\n", text)
        self.assertEqual(text.count("\\-\\-slowly"), 1)
        self.assertGreater(text.index("\\-\\-slowly"), text.index('.SH "PROGRAM TOP\\-GO"\n'))

    def test_nothing_of_an_earlier_time_stays(self):
        self.pages.mkdir()
        (self.pages / "top-old.1").touch()
        self.page("top-go", self.program("top", {"": TOP, "go ": GO}))
        self.assertEqual([file.name for file in self.pages.iterdir()], ["top-go.1"])

    @unittest.skipUnless(shutil.which("man") and shutil.which("groff"), "needs man and groff, to show a page")
    def test_man_shows_what_was_said(self):
        said = "'.TH' .br \\fB \\n(.x \"- --\" `a` ~^ {a->b}"
        page = self.page("top-go", self.program("top", {"": TOP, "go ": f".{said}\nUsage: top go [OPTIONS]\n{OPTIONS}  {said}\n"}))
        self.assertIn("DESCRIPTION", page)
        done = subprocess.run(["man", "--warnings", "-l", self.pages / "top-go.1"], capture_output=True, text=True, check=True,
                              env={"PATH": "/usr/bin:/bin", "LC_ALL": "C", "MANWIDTH": "200"})
        self.assertEqual(done.stderr, "")
        self.assertEqual(done.stdout.count(said), 3, done.stdout)

    def test_a_program_that_fails(self):
        self.refused("'top --help' ended with exit code 7 (expected 0): not now", {"": None})

    def test_a_command_that_fails(self):
        self.refused("'top go --help' ended with exit code 7 (expected 0): not now", {"": TOP, "go ": None})

    def test_a_program_without_commands(self):
        self.refused("'top --help' lists no commands (expected some below 'Subcommands:')", {"": GO})

    def test_a_help_that_is_empty(self):
        self.refused("'top go --help' says nothing", {"": TOP, "go ": ""})

    def test_a_help_without_usage(self):
        self.refused("'top go --help': no usage (expected a line 'Usage: ' with [OPTIONS])", {"": TOP, "go ": "Go.\n"})

    def test_a_help_that_does_not_say_what_it_does(self):
        self.refused("'top go --help': nothing says what it does (expected a sentence before 'Usage: ')",
                     {"": TOP, "go ": "Usage: top go [OPTIONS]\n" + OPTIONS})

    def test_a_help_with_a_part_that_is_not_known(self):
        self.refused("'top go --help': '[Option Group: x]' is no part of a help (expected Positionals:, Options: or Subcommands:)",
                     {"": TOP, "go ": GO + "\n[Option Group: x]\n"})

    def test_a_help_with_names_before_any_part(self):
        self.refused("'top go --help': '  --bare' follows the usage (expected Positionals:, Options: or Subcommands:)",
                     {"": TOP, "go ": "Go.\nUsage: top go [OPTIONS]\n  --bare\n"})

    def test_a_program_that_is_not_there(self):
        done = self.write(self.folder / "top")
        self.assertEqual(done.returncode, 1)
        self.assertTrue(done.stderr.startswith("manual.sh: error: 'top --help' ended with exit code 127 (expected 0): "), done.stderr)


if __name__ == "__main__":
    unittest.main()
