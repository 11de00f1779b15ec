#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What is typed at the prompt for a password is not shown, and whatever interrupts it leaves the terminal as it was.

usage: password_prompt_test.py PROGRAM"""
import os
import pathlib
import pty
import signal
import subprocess
import sys
import tempfile
import termios
import unittest

PROGRAM = ""  # of `__main__`
PASSWORD = "correct horse"

# Stands between the test and the program as a shell does, so that the program can be stopped: its group is in the terminal's
# foreground. Says what becomes of it, a word each time, and lets it go on after a line.
SHELL = """
import os, signal, sys
child = os.fork()
if child == 0:
    os.setpgid(0, 0)
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)
    os.tcsetpgrp(0, os.getpid())
    signal.signal(signal.SIGTTOU, signal.SIG_DFL)
    os.execv(sys.argv[1], sys.argv[1:])
while True:
    _, status = os.waitpid(child, os.WUNTRACED)
    said = 'stopped' if os.WIFSTOPPED(status) else f'signal {os.WTERMSIG(status)}' if os.WIFSIGNALED(status) else f'exit {os.WEXITSTATUS(status)}'
    os.write(int(os.environ['SAYS']), (said + ' ' + str(child) + '\\n').encode())
    if said != 'stopped':
        break
    os.read(int(os.environ['HEARS']), 1)
    os.kill(child, signal.SIGCONT)
"""


class ThePasswordPrompt(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.file = pathlib.Path(scratch.name) / "users.yaml"
        self.ours, self.terminal = pty.openpty()
        self.says, says = os.pipe()
        hears, self.hears = os.pipe()
        for descriptor in self.ours, self.terminal, self.says, self.hears:
            self.addCleanup(os.close, descriptor)
        before = termios.tcgetattr(self.terminal)
        self.before = before
        self.assertTrue(before[3] & termios.ECHO)
        # With TIOCSCTTY the terminal is that of the new session.
        self.shell = subprocess.Popen(
            [sys.executable, "-c", "import fcntl, termios; fcntl.ioctl(0, termios.TIOCSCTTY, 0)\n" + SHELL, PROGRAM, "users", str(self.file),
             "add", "A. Meier"], stdin=self.terminal, stdout=self.terminal, stderr=self.terminal, start_new_session=True,
            pass_fds=(says, hears), env={**os.environ, "SAYS": str(says), "HEARS": str(hears)})
        self.addCleanup(self.shell.wait)
        self.addCleanup(self.shell.kill)
        os.close(says)
        os.close(hears)
        self.shown = ""
        self.read_until("password of A. Meier: ")

    def read_until(self, text):
        """From where the last call has ended."""
        while text not in self.shown:
            self.shown += os.read(self.ours, 1000).decode()
        before, self.shown = self.shown.split(text, 1)
        return before

    def type(self, text):
        os.write(self.ours, text.encode())

    def became(self):
        word, _, process = os.read(self.says, 100).decode().rpartition(" ")
        return word, int(process)

    def echoes(self):
        return bool(termios.tcgetattr(self.terminal)[3] & termios.ECHO)

    def test_shows_nothing_and_leaves_the_terminal_as_it_was(self):
        self.assertFalse(self.echoes())
        self.type(PASSWORD + "\n")
        between = self.read_until("again, the password of A. Meier: ")
        self.type(PASSWORD + "\n")
        self.assertEqual(self.became()[0], "exit 0")
        self.assertNotIn("horse", between + self.read_until("is a user now, viewer"))
        self.assertEqual(termios.tcgetattr(self.terminal), self.before)
        self.assertNotIn("horse", self.file.read_text())

    def interrupted(self, how, number):
        self.type("half a pass")
        how()
        self.assertEqual(self.became()[0], f"signal {number}")
        self.assertEqual(termios.tcgetattr(self.terminal), self.before)
        self.assertFalse(self.file.exists())

    def foreground(self):
        return os.tcgetpgrp(self.ours)

    def test_leaves_it_so_at_ctrl_c(self):
        self.interrupted(lambda: self.type("\x03"), signal.SIGINT)

    def test_leaves_it_so_at_ctrl_backslash(self):
        self.interrupted(lambda: self.type("\x1c"), signal.SIGQUIT)

    def test_leaves_it_so_when_it_is_terminated(self):
        self.interrupted(lambda: os.kill(self.foreground(), signal.SIGTERM), signal.SIGTERM)

    def test_leaves_it_so_while_it_is_stopped_and_asks_again(self):
        self.type("half a pass\x1a")
        word, process = self.became()
        self.assertEqual(word, "stopped")
        self.assertEqual(termios.tcgetattr(self.terminal), self.before)
        os.write(self.hears, b"\n")
        self.read_until("password of A. Meier: ")
        self.assertFalse(self.echoes())
        self.type(PASSWORD + "\n")
        self.read_until("again, the password of A. Meier: ")
        self.type(PASSWORD + "\n")
        self.assertEqual(self.became(), ("exit 0", process))
        self.assertEqual(termios.tcgetattr(self.terminal), self.before)


if __name__ == "__main__":
    PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
