"""Processes that this one starts: deaf to Ctrl-C, which it answers, and ended with it.

A terminal sends Ctrl-C to all processes of a command, also to one that is still loading its
modules and would print a traceback.
"""

import os
import signal
import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from multiprocessing import parent_process, resource_tracker
from multiprocessing.process import BaseProcess
from types import FrameType
from typing import Any


@contextmanager
def starting() -> Iterator[None]:
    """Block in which a process is started: whole, because interrupts wait until its end.

    The process inherits that SIGINT is blocked, and so do those that it starts in its turn.
    """
    came: list[int] = []
    before: dict[int, Any] = {}

    def hold(number: int, _frame: FrameType | None) -> None:
        came.append(number)

    mask: Iterable[int] | None = None
    try:
        if threading.current_thread() is threading.main_thread():
            for each in (signal.SIGINT, signal.SIGTERM):
                if callable(signal.getsignal(each)):
                    before[each] = signal.signal(each, hold)
        # Its start would unblock the signal.
        resource_tracker.ensure_running()
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in before.items():
            signal.signal(number, handler)
        for again in came:
            signal.raise_signal(again)


def end_with_parent() -> None:
    """End this process as soon as its parent process has ended, if it has one."""
    parent = parent_process()
    if parent is not None:
        threading.Thread(target=_watch, args=(parent,), daemon=True).start()


def _watch(parent: BaseProcess) -> None:
    parent.join()
    os._exit(1)
