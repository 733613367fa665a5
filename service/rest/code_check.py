"""Check of NC code in a process of its own, with a time limit.

Subprograms and loops let a small program execute for minutes, and the check of a large one
takes that long too: neither may hold up the requests that a web process answers meanwhile.
"""

import signal
import subprocess
import sys
from pathlib import Path

from service.processes.process_limits import GIB, ProcessLimits, limit_process
from service.rendering.columns import dump
from service.verbs.check.request import CheckFiles, CheckRequest
from service.verbs.check.run import run
from stepnc_model.errors import StepNcError

LONGEST = 120.0
"""Time limit of a check, in s."""

MOST_MEMORY = 4 * GIB
"""Limit of the address space of a check, bytes."""

REFUSED = 3
"""Exit code of a check that ends with an error of the project."""


def checked_code(file: Path, *, name: str, longest: float = LONGEST) -> bytes:
    """Check NC code and return its contents and findings as JSON.

    Parameters
    ----------
    name : str
        Name of the program.
    longest : float, s
        Time limit.

    Raises
    ------
    StepNcError
        As :func:`service.verbs.check.run.run`, or when the time limit is exceeded.
    """
    words = [sys.executable, "-m", "service.rest.code_check", str(file), name]
    try:
        done = subprocess.run(words, capture_output=True, timeout=longest, check=False)
    except subprocess.TimeoutExpired:
        text = f"the check takes longer than {longest:g} s, the limit of this service"
        raise StepNcError(f"{name}: {text}; check it with `stepnc check`") from None
    if done.returncode == -signal.SIGXCPU:
        text = f"the check takes longer than {LONGEST:g} s, the limit of this service"
        raise StepNcError(f"{name}: {text}; check it with `stepnc check`")
    if done.returncode == REFUSED:
        raise StepNcError(f"{name}: {done.stderr.decode(errors='replace').strip()}")
    if done.returncode:
        raise RuntimeError(done.stderr.decode(errors="replace")[-2000:])
    return done.stdout


def main() -> int:
    """Check the file that the command line names; return the exit code."""
    file, name = sys.argv[1:]
    limit_process(ProcessLimits(memory=MOST_MEMORY, processor=int(LONGEST) + 1))
    try:
        text = dump(run(CheckRequest(), CheckFiles(file=Path(file), name=name)).record())
    except StepNcError as error:
        sys.stderr.write(str(error))
        return REFUSED
    except MemoryError:
        sys.stderr.write(f"the check needs more than {MOST_MEMORY / GIB:g} GB of memory")
        return REFUSED
    sys.stdout.buffer.write(text.encode())
    return 0


if __name__ == "__main__":
    sys.exit(main())
