"""Workingsteps on two cores: the later half of some in a second process, kept where it may be.

Nothing says before its path is made where a workingstep cuts. So the second process takes its
half as if the first one had changed nothing that matters, and tells afterwards where it looked
and what it changed. Where that lies apart from what the first half changed, its result is that
of one workingstep after another and is kept; otherwise the workingstep is done again. Results
come in the order of the program and are the same as on one core, errors too: the second process
ends at its first one, and the first process meets it again in its turn. Results that are late,
for something else runs on the other core, are not waited for.

Programs whose workingsteps meet, a face before all pockets, are tried again ever more rarely.
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

from stepnc_model.program import ResolvedWorkingstep

LEAST = 16
"""workingsteps for each process that are worth a second one"""

MOST = 64
"""workingsteps for each process before both wait for one another"""

SOON = 0.05
"""s; nothing is late before"""

_SIZE = 8  # bytes in which a size is told

Result = TypeVar("Result")
Trace = TypeVar("Trace")


class SplittableState(Protocol[Trace]):
    """A state that workingsteps change, each in a place of its own."""

    def split(self) -> None:
        """Prepare to repeat what a copy does from now on."""
        ...

    def trace(self) -> Trace:
        """Place that the last workingstep read and changed."""
        ...

    def is_apart(
        self, step: ResolvedWorkingstep, trace: Trace, others: Sequence[Trace]
    ) -> bool:
        """Whether a workingstep would have done the same after others."""
        ...

    def repeat(self, step: ResolvedWorkingstep, trace: Trace) -> None:
        """Change the state as a workingstep has changed a copy of it."""
        ...


def one_by_one(
    steps: Sequence[ResolvedWorkingstep], do: Callable[[ResolvedWorkingstep], Result]
) -> Iterator[Result]:
    """Results of workingsteps, each after the one before."""
    return map(do, steps)


def side_by_side(
    steps: Sequence[ResolvedWorkingstep],
    do: Callable[[ResolvedWorkingstep], Result],
    state: SplittableState[Trace],
) -> Iterator[Result]:
    """Results of workingsteps in their order, on two cores where these are free.

    Parameters
    ----------
    steps : sequence of ResolvedWorkingstep
    do : callable
        Does one of them; a result that can be sent from process to process.
    state : SplittableState
        What ``do`` changes besides.

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
    """Whether there are two cores, and a process that may be forked: one without threads."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    return cores > 1 and threading.active_count() == 1


def _halves(
    first: Sequence[ResolvedWorkingstep],
    second: Sequence[ResolvedWorkingstep],
    do: Callable[[ResolvedWorkingstep], Result],
    state: SplittableState[Trace],
) -> Generator[Result, None, int]:
    """Both halves at once; gives how much of the second could be kept."""
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
                # Its core is busy: what takes longer here than there is not waited for again.
                patience = 0.0
            yield do(step)
            changed.append(state.trace())
    return kept


class _Second(Generic[Result, Trace]):
    """A second process, forked from this one; use it with ``with``. Running state.

    Results lie in a file without a name, their sizes come through a pipe: it never is full, so
    that the second process never waits.
    """

    def __init__(
        self,
        steps: Sequence[ResolvedWorkingstep],
        do: Callable[[ResolvedWorkingstep], Result],
        state: SplittableState[Trace],
    ) -> None:
        self._file = TemporaryFile(buffering=0)  # noqa: SIM115 (closed at the end of ``with``)
        self._ends = [0]
        """where results end in the file"""
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
                # An error comes again in the first process; nothing else is to be cleaned up.
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
        """A result with its trace; None when it does not come within some seconds."""
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
