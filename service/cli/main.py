"""Entry points ``stepnc`` and ``optimise``: from the first line to the exit code.

Exit codes: 0 ok, 2 usage, 3 bad input, 4 infeasible, 5 limit exceeded, 6 nothing to advise, 130
interrupted. An interrupt ends a command without a traceback whenever it comes: so this module
imports nothing of the project until the signals are taken (:mod:`service.cli.interrupts`).
"""

import os
import signal
import sys
from collections.abc import Sequence


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
    is_process = arguments is None
    if is_process and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        # There is nothing to undo yet: the system ends the process.
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    if is_process:
        # Matrices are small here; threads of BLAS spin, and sums depend on their number.
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from service.cli.interrupts import INTERRUPTED, Interrupts

    interrupts = Interrupts()
    if is_process:
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
    from contextlib import suppress

    from service.terminal import drop_out, prepare, tell

    prepare()
    # The same Ctrl-C may have ended the readers.
    try:
        sys.stdout.flush()
    except OSError:
        drop_out()
    with suppress(OSError):
        tell("interrupted")
