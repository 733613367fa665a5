"""Entry points ``stepnc`` and ``optimise``: from the first line to the exit code.

Exit codes: 0 ok, 2 usage, 3 bad input, 4 infeasible, 5 limit exceeded, 6 nothing to advise, 130
interrupted. An interrupt ends a command without a traceback whenever it comes: so this module
imports nothing else of the project until the signals are taken (:mod:`service.cli.interrupts`).
"""

import sys
from collections.abc import Sequence

from service.cli.interrupts import INTERRUPTED, Interrupts


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line ``stepnc``.

    Parameters
    ----------
    arguments : sequence of str, optional
        Default: those of this process, whose signals are then taken until its end.
    """
    _run("stepnc", arguments)


def optimise_main(arguments: Sequence[str] | None = None) -> None:
    """Run the command ``optimise``, an alias of ``stepnc optimise``."""
    _run("optimise", arguments)


def _run(name: str, arguments: Sequence[str] | None) -> None:
    interrupts = Interrupts()
    if arguments is None:
        interrupts.install()
    code = INTERRUPTED
    try:
        try:
            from service.cli import commands

            work = commands.parsed(name, arguments)
            interrupts.start()
            code = work()
        finally:
            interrupts.end()
    except KeyboardInterrupt:
        _tell_interrupted()
    except Exception:
        # Compilers and extension modules replace the interrupt by an error of their own.
        if not interrupts.has_come:
            raise
        _tell_interrupted()
    sys.exit(code)


def _tell_interrupted() -> None:
    from service.terminal import drop_out, tell

    try:
        sys.stdout.flush()
    except OSError:
        # The same Ctrl-C has ended the reader.
        drop_out()
    tell("interrupted")
