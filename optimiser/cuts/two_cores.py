"""Process workingsteps on two cores, with the same results as on one.

Where a workingstep cuts is not known before its path is made. So a second process handles the
later half of a batch as if the first half changed nothing relevant, and afterwards reports
which places it read and changed. If these are apart from the changes of the first half, its
results are kept; otherwise the workingsteps are done again. Results come in program order and
are the same as on one core, errors too: the second process ends at its first error, which the
first process meets again in its turn. Results that are late, because the other core is busy,
are not waited for.

Programs whose workingsteps overlap, such as a face before all pockets, are tried on two cores
less and less often.
"""

import os
import pickle
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from select import select
from tempfile import TemporaryFile
from typing import Generic, Protocol, TypeVar

from stepnc_model.programs.program import ResolvedWorkingstep

LEAST = 16
"""Least number of workingsteps per process that justifies a second process."""

MOST = 64
"""Greatest number of workingsteps per process before both synchronise."""

SOON = 0.05
"""Least waiting time before a result counts as late, s."""

_SIZE = 8  # number of bytes that encode the size of a result

Result = TypeVar("Result")
Trace = TypeVar("Trace")


class SplittableState(Protocol[Trace]):
    """State that workingsteps change, each in a place of its own."""

    def split(self) -> None:
        """Prepare to repeat the changes that a copy makes from now on."""
        ...

    def trace(self) -> Trace:
        """Trace of the place that the last workingstep read and changed."""
        ...

    def is_apart(
        self, step: ResolvedWorkingstep, trace: Trace, others: Sequence[Trace]
    ) -> bool:
        """True if a workingstep would have had the same result after the others."""
        ...

    def repeat(self, step: ResolvedWorkingstep, trace: Trace) -> None:
        """Apply to this state the change that a workingstep made in a copy of it."""
        ...


def one_by_one(
    steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
) -> Iterator[Result]:
    """Results of workingsteps, processed one after the other."""
    return map(do, steps)


def side_by_side(
    steps: Sequence[ResolvedWorkingstep],
    do: Callable[[ResolvedWorkingstep], Result],
    state: SplittableState[Trace],
) -> Iterator[Result]:
    """Results of workingsteps in their order, on two cores where these are free.

    Parameters
    ----------
    do : callable
        Processes one workingstep; its result must be picklable.
    state : SplittableState
        State that ``do`` changes.

    Yields
    ------
    Result
    """
    if not _is_possible():
        yield from one_by_one(steps, do)
        return
    index, size, pause, patience = 0, LEAST, 0, 2 * LEAST
    while index < len(steps):
        half = min(size, (len(steps) - index) // 2)
        if pause > 0 or half < LEAST:
            yield do(steps[index])
            index, pause = index + 1, pause - 1
            continue
        batch = steps[index : index + 2 * half]
        kept = yield from _halves(batch[:half], batch[half:], do, state)
        index += 2 * half
        if 2 * kept >= half:
            size, patience = min(2 * size, MOST), 2 * LEAST
        else:
            size, pause, patience = LEAST, patience, 2 * patience


def _is_possible() -> bool:
    """True if there are two cores and this process has no threads, so that it may fork."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    return cores > 1 and threading.active_count() == 1


def _halves(
    first: Sequence[ResolvedWorkingstep],
    second: Sequence[ResolvedWorkingstep],
    do: Callable[[ResolvedWorkingstep], Result],
    state: SplittableState[Trace],
) -> Generator[Result, None, int]:
    """Process both halves at once; return how many results of the second were kept."""
    kept = 0
    state.split()
    with _Second(second, do, state) as other:
        changed = []
        begin = time.perf_counter()
        for step in first:
            yield do(step)
            changed.append(state.trace())
        patience = max((time.perf_counter() - begin) / len(first), SOON)
        for index, step in enumerate(second):
            told = other.result(index, patience)
            if told is not None and state.is_apart(step, told[1], changed):
                state.repeat(step, told[1])
                kept += 1
                yield told[0]
                continue
            if told is None:
                # The core is busy: do not wait again for results that take longer there.
                patience = 0.0
            yield do(step)
            changed.append(state.trace())
    return kept


class _Second(Generic[Result, Trace]):
    """Second process, forked from this one; a context manager with mutable state.

    Results are written to an unnamed file and their sizes to a pipe, which never fills, so the
    second process never waits.
    """

    def __init__(
        self,
        steps: Sequence[ResolvedWorkingstep],
        do: Callable[[ResolvedWorkingstep], Result],
        state: SplittableState[Trace],
    ) -> None:
        self._file = TemporaryFile(buffering=0)  # noqa: SIM115 (closed at the end of ``with``)
        self._ends = [0]
        """Offsets at which results end in the file."""
        self._pipe, write = os.pipe()
        self._pid = os.fork()
        if self._pid == 0:
            try:
                signal.signal(signal.SIGINT, signal.SIG_DFL)
                for step in steps:
                    told = pickle.dumps((do(step), state.trace()))
                    self._file.write(told)
                    os.write(write, len(told).to_bytes(_SIZE))
            finally:
                # The first process meets any error again; there is nothing else to clean up.
                os._exit(0)
        os.close(write)

    def __enter__(self) -> "_Second[Result, Trace]":
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self._pipe)
        self._file.close()
        os.kill(self._pid, signal.SIGKILL)
        os.waitpid(self._pid, 0)

    def result(self, index: int, patience: float) -> tuple[Result, Trace] | None:
        """Return a result with its trace, or None if it takes longer than ``patience`` s."""
        while index + 1 >= len(self._ends):
            if not select([self._pipe], [], [], patience)[0]:
                return None
            size = os.read(self._pipe, _SIZE)
            if not size:
                return None
            self._ends.append(self._ends[-1] + int.from_bytes(size))
        begin, end = self._ends[index : index + 2]
        told: tuple[Result, Trace] = pickle.loads(
            os.pread(self._file.fileno(), end - begin, begin)
        )
        return told
