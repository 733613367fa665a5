"""Signals that ask a command to end, at any moment of a process.

They are SIGINT (Ctrl-C), SIGTERM, and SIGHUP of a terminal that closes.

* While modules are loaded and options are read, a signal is held until all is ready.
* While the command works, the first one raises KeyboardInterrupt. Launchers pass on what the
  terminal has sent to all, so the second is ignored; a third one raises it again.
* While the process ends, they are ignored, but for a third one, which ends it at once.

Imports nothing slow: it is loaded before anything else of the project.
"""

import atexit
import os
import signal
import sys
from collections.abc import Callable
from types import CodeType, FrameType
from typing import Any

INTERRUPTED = 130
"""Exit code of an interrupted command, as of shells: 128 + SIGINT."""

SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)

INSISTING = 3
"""Number of the signal from which on each counts."""

SOON = 0.01
"""Time after which an interrupt is repeated that came where nothing could catch it, in s."""

UnraisableHook = Callable[["sys.UnraisableHookArgs"], Any]


class Interrupts:
    """Signals that this process was sent so far. Running state."""

    def __init__(self) -> None:
        self._count = 0
        self._is_working = False
        self._is_ending = False
        self._is_lost = False
        self._others: UnraisableHook = sys.unraisablehook

    @property
    def has_come(self) -> bool:
        """True if the process was asked to end."""
        return self._count > 0

    def install(self) -> None:
        """Take the signals of this process, until its end; those that it ignores stay so."""
        for number in SIGNALS:
            if signal.getsignal(number) is not signal.SIG_IGN:
                signal.signal(number, self._take)
        self._others, sys.unraisablehook = sys.unraisablehook, self._repeat
        # Registered first, it is called last: then the interpreter drops the handlers.
        atexit.register(_ignore)

    def start(self) -> None:
        """Begin with the work of the command.

        Raises
        ------
        KeyboardInterrupt
            When the process was asked to end before.
        """
        self._is_working = True
        if self.has_come:
            raise KeyboardInterrupt

    def end(self) -> None:
        """Begin to end the process."""
        self._is_ending = True

    def _take(self, _number: int, frame: FrameType | None) -> None:
        if self._is_lost:
            if self._is_ending or _is_within(frame, Interrupts._repeat.__code__):
                return
            self._is_lost = False
            raise KeyboardInterrupt
        self._count += 1
        if self._is_ending and self._count >= INSISTING:
            os._exit(INTERRUPTED)
        if self._is_ending or not self._is_working or 1 < self._count < INSISTING:
            return
        raise KeyboardInterrupt

    def _repeat(self, caught: "sys.UnraisableHookArgs") -> None:
        """Raise an interrupt once more after it came where nothing could catch it."""
        if not issubclass(caught.exc_type, KeyboardInterrupt):
            self._others(caught)
        elif not self._is_ending:
            from threading import Thread

            self._is_lost = True
            Thread(target=self._insist, daemon=True).start()

    def _insist(self) -> None:
        """Send the signal until it is taken outside of the hook."""
        from threading import Event, main_thread

        never, main = Event(), main_thread().ident
        while not never.wait(SOON) and self._is_lost and not self._is_ending:
            signal.pthread_kill(main or 0, signal.SIGINT)


def _is_within(frame: FrameType | None, code: CodeType) -> bool:
    """True if a function is one of those that were called."""
    while frame is not None and frame.f_code is not code:
        frame = frame.f_back
    return frame is not None


def _ignore() -> None:
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
