"""A command as a process of its own, interrupted at a moment that its stderr tells."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from tests.service.waiting import ROOT, children, ended, environment, is_alive, until

START = "from service.cli.main import main; main()"

PARTS = ROOT / "examples" / "parts"

IMPORTED = re.compile(r"import time:.*\| +([\w.]+)\n")
"""Line of stderr for a module that was loaded."""

FAULTS = (
    *("Traceback", "Exception ignored", "Task was destroyed", "never retrieved", "Error"),
    *("never awaited", "leaked", "Fatal", '"fault"'),
)


class Command:
    """A command that runs, with what it said so far. Running state."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.said = ""
        self._below = set[int]()

    def lines(self) -> Iterator[str]:
        """Lines of stderr until the end; of a loaded module its name alone."""
        assert self.process.stderr is not None
        for line in self.process.stderr:
            if found := IMPORTED.fullmatch(line):
                yield found[1]
            elif not line.startswith("import time:"):
                self.said += line
                yield line

    def wait_for(self, moment: str) -> None:
        """Read until a line with these words, or with the name of a module."""
        assert any(moment in line for line in self.lines()), self.said

    def send(self, number: int) -> None:
        """Send a signal as a terminal does: to all processes of the command."""
        self._below |= children(self.process.pid)
        os.killpg(self.process.pid, number)

    def require_quiet(self, *codes: int) -> None:
        """Wait for the end, and require that nothing is left or complained of."""
        for _ in self.lines():
            """The rest."""
        code = ended(self.process)
        assert code in codes, (code, self.said)
        assert not any(each in self.said for each in FAULTS), self.said
        until(lambda: not any(map(is_alive, self._below)))


@contextmanager
def command(folder: Path, words: Sequence[str], *, start: str = START) -> Iterator[Command]:
    """A command in a folder, with a line of stderr for each module that it loads."""
    home = folder / "home"
    with subprocess.Popen(
        [sys.executable, "-X", "importtime", "-c", start, *words],
        cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
        env={
            **environment(home), "PYTHONPATH": str(ROOT),
            "XDG_CACHE_HOME": os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache")),
        },
    ) as process:  # fmt: skip
        try:
            yield Command(process)
        finally:
            process.kill()
