# SPDX-License-Identifier: Apache-2.0
"""Where a secret is told: in files, and in the command lines and environments of a program's processes and of whatever they
start. A secret is found as it is, in base64 at any place of a longer text, and with % as in a URL."""
import base64
import pathlib
import threading
import urllib.parse


def forms_of(secret):
    """The bytes to look for."""
    plain = secret.encode()
    forms = {plain, urllib.parse.quote(secret, safe="").encode()}
    for before in range(3):
        packed = base64.b64encode(b"\0" * before + plain).rstrip(b"=")
        forms.add(packed[-(-before * 8 // 6):-1])
    return forms


def found_in(folders, secrets):
    """{(name of the secret, file)}: `secrets` has them by name."""
    forms = {name: forms_of(secret) for name, secret in secrets.items()}
    found = set()
    for folder in folders:
        for file in folder.rglob("*"):
            if not file.is_file():
                continue
            data = file.read_bytes()
            found |= {(name, file) for name, texts in forms.items() if any(text in data for text in texts)}
    return found


class Processes:
    """Looks at the processes of a program, and at their children, until `end`: what each was given."""

    def __init__(self, program):
        self.program = str(pathlib.Path(program).resolve())
        self.ours = set()
        self.seen = {}  # (process, "cmdline" or "environ"): bytes
        self.over = threading.Event()
        self.thread = threading.Thread(target=self._look)
        self.thread.start()

    def _look(self):
        while not self.over.wait(0.005):
            for entry in pathlib.Path("/proc").iterdir():
                if entry.name.isdigit():
                    self._look_at(entry)

    def _look_at(self, entry):
        process = int(entry.name)
        try:
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            if (entry / "exe").resolve() != pathlib.Path(self.program) and parent not in self.ours:
                return
            self.ours.add(process)
            for what in "cmdline", "environ":
                self.seen[process, what] = (entry / what).read_bytes()
        except OSError:
            return  # it has ended

    def commands(self):
        """What the program was told to do."""
        return {words[1].decode() for (_, what), text in self.seen.items() if what == "cmdline"
                and len(words := text.split(b"\0")) > 1}

    def found(self, secrets, but_of=()):
        """{(name of the secret, process, where)}, but for the environment of those that were given it on purpose."""
        forms = {name: forms_of(secret) for name, secret in secrets.items()}
        return {(name, process, what) for (process, what), text in self.seen.items() for name, texts in forms.items()
                if any(form in text for form in texts) and not (what == "environ" and process in but_of)}

    def end(self):
        self.over.set()
        self.thread.join()


def leaves_core(process):
    """Whether its memory would be written to the disk in a crash."""
    limits = pathlib.Path(f"/proc/{process}/limits").read_text()
    soft = next(line for line in limits.splitlines() if line.startswith("Max core file size")).split()[4]
    return soft != "0"
