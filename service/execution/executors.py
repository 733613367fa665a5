"""Executors of long work, and work that is submitted again after its executor was lost.

An executor may be lost at any moment: the system ends a process when memory is short, a
scheduler is restarted and forgets everything. What was not returned is then submitted to a new
one.
"""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import AbstractContextManager, contextmanager
from itertools import islice
from multiprocessing import active_children, get_context
from multiprocessing.connection import wait as ended
from multiprocessing.process import BaseProcess
from os import _exit, cpu_count
from signal import SIGTERM, getsignal, signal
from time import monotonic
from types import FrameType
from typing import Any, TypeVar, cast

from service.processes.lifeline import end_with_parent, starting
from stepnc_model.errors import StepNcError

MOST_PROCESSES = 64

AHEAD = 256
"""Most tasks that are submitted and not yet done."""

MOST_LOSSES = 3
"""Times that an executor may be lost without a result in between."""

LOST = (BrokenExecutor, CancelledError)
"""Errors of work that was lost, whatever it was."""

LONGEST_END = 10.0
"""Time for a process to clean up and end, in s."""

BROKEN_OFF = 1
"""Exit code of a process whose task was broken off."""

Result = TypeVar("Result")
Pools = Callable[[], AbstractContextManager[Executor]]
"""Makes an executor; called again after the executor was lost."""


@contextmanager
def processes(count: int = MOST_PROCESSES) -> Iterator[Executor]:
    """Executor with a process for each processor, at most a given number."""
    workers = max(1, min(count, cpu_count() or 1))
    context = get_context("forkserver")
    others = set(active_children())
    with _Processes(workers, mp_context=context, initializer=_begin) as pool:
        try:
            yield pool
        except BaseException:
            _end(set(active_children()) - others)
            pool.shutdown(cancel_futures=True)
            raise


def _end(processes: Iterable[BaseProcess]) -> None:
    """Break off what processes do."""
    left = {each.sentinel: each for each in processes}
    for process in left.values():
        process.terminate()
    latest = monotonic() + LONGEST_END
    while left and (now := monotonic()) < latest:
        for sentinel in ended(list(left), latest - now):
            del left[cast(int, sentinel)]
    for process in left.values():
        process.kill()


def _begin() -> None:
    """Prepare a process: it ends with its parent, and a task that is broken off cleans up."""
    end_with_parent()
    signal(SIGTERM, _break_off)


def _break_off(_number: int, _frame: FrameType | None) -> None:
    signal(SIGTERM, _too_late)
    raise SystemExit(BROKEN_OFF)


def _too_late(_number: int, _frame: FrameType | None) -> None:
    """Ignore a request to end: the process ends."""


def _done(
    function: Callable[..., Result], args: tuple[Any, ...], kwargs: dict[str, Any]
) -> Result:
    """Do a task; when it was broken off, end the process, which would begin the next."""
    try:
        return function(*args, **kwargs)
    finally:
        if getsignal(SIGTERM) is _too_late:
            _exit(BROKEN_OFF)


class _Processes(ProcessPoolExecutor):
    """Executor whose processes leave Ctrl-C to the main one."""

    def submit(
        self, fn: Callable[..., Result], /, *args: object, **kwargs: object
    ) -> Future[Result]:
        """Submit a task; starts a process when all are at work."""
        with starting():
            return super().submit(_done, fn, args, kwargs)


class Losses:
    """Counts executors that were lost without a result in between. Running state."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        self._tell = tell
        self._count = 0

    def got_on(self) -> None:
        """Begin to count anew: there is a result."""
        self._count = 0

    def lost(self, error: BaseException, *, what: str) -> None:
        """Count an executor that was lost.

        Raises
        ------
        StepNcError
            If too many were lost.
        """
        self._count += 1
        if self._count >= MOST_LOSSES:
            reason = f" ({error})" if str(error) else ""
            raise StepNcError(
                f"{what}: the processes that make them were ended {self._count} times{reason}, "
                "as the system does when memory is short; what was made before is kept: free "
                "memory and start again"
            ) from error
        self._tell(f"{what}: a process was ended from outside; they are made again")


def results(
    pools: Pools,
    function: Callable[..., Result],
    tasks: Iterable[tuple[object, ...]],
    *,
    tell: Callable[[str], None],
    what: str,
) -> Iterator[tuple[int, Result]]:
    """Yield the index and the result of each task, in the order in which they end.

    Parameters
    ----------
    pools : callable
        Makes executors.
    function : callable
        Defined in a module, so that other processes find it.
    tasks : iterable of tuple
        Arguments of the function; taken as there is room for them.
    tell : callable
        Receives what was lost.
    what : str
        Name of the tasks for messages, in the plural.

    Raises
    ------
    StepNcError
        If executors are lost again and again.
    """
    coming = enumerate(tasks)
    begun: dict[int, tuple[object, ...]] = {}
    losses = Losses(tell)
    while True:
        try:
            with pools() as pool:
                waiting = {pool.submit(function, *begun[index]): index for index in begun}
                while True:
                    for index, task in islice(coming, AHEAD - len(waiting)):
                        begun[index] = task
                        waiting[pool.submit(function, *task)] = index
                    if not waiting:
                        return
                    for each in wait(waiting, return_when=FIRST_COMPLETED).done:
                        index, result = waiting.pop(each), each.result()
                        del begun[index]
                        losses.got_on()
                        yield index, result
        except LOST as error:
            losses.lost(error, what=f"{len(begun)} {what}")
