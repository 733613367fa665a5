"""Log of the service: JSON lines on stderr, one for each event, from every process and thread.

An uncaught exception is one line as well, with the event ``fault``, in place of the tracebacks
over many lines that the interpreter, its threads, multiprocessing and asyncio print.
"""

import json
import logging
import sys
import threading
from collections.abc import Callable
from functools import partial
from multiprocessing import set_forkserver_preload
from types import TracebackType
from typing import TYPE_CHECKING, Any

import orjson
import structlog

if TYPE_CHECKING:
    from structlog.typing import EventDict

STAMP = structlog.processors.TimeStamper(fmt="iso", utc=True)

FAULT = "fault"
"""Event of a line that tells of a fault of the program."""

FORKED = "service.processes.fork_log"
"""Module that configures the log of a fork server; the first that one loads."""

FAULTY = 1
"""Exit code of a process that ended through a fault."""


def configure(level: str) -> None:
    """Send all log messages of a level or above to stderr as JSON lines."""
    least = logging.getLevelNamesMapping()[level.upper()]
    structlog.configure(
        cache_logger_on_first_use=True,
        wrapper_class=structlog.make_filtering_bound_logger(least),
        processors=[
            structlog.processors.add_log_level,
            STAMP,
            structlog.processors.format_exc_info,
            structlog.processors.JSONRenderer(serializer=_line),
        ],
        logger_factory=structlog.WriteLoggerFactory(file=sys.stderr),
    )
    handler = LibraryHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=[structlog.stdlib.add_log_level, STAMP],
            processors=[
                _as_fault,
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.format_exc_info,
                structlog.processors.JSONRenderer(serializer=_line),
            ],
        )
    )
    logging.basicConfig(level=max(least, logging.INFO), handlers=[handler], force=True)
    # Alembic logs every migration that it checks.
    logging.getLogger("alembic").setLevel(logging.WARNING)


def report_faults() -> None:
    """Log what nobody catches in this process, and warnings, as lines of JSON."""
    sys.excepthook = _uncaught
    threading.excepthook = _uncaught_in_thread
    sys.unraisablehook = partial(_unraisable, sys.unraisablehook)
    logging.captureWarnings(True)


def reported(level: str, function: Callable[..., None], *arguments: Any) -> None:
    """Call the main function of a process that multiprocessing has started.

    An exception is logged as a fault and ends the process with exit code 1; multiprocessing
    would print its traceback.

    Parameters
    ----------
    level : str
        Level of the log.
    function : callable
        Main function.
    *arguments
        Its arguments.
    """
    configure(level)
    report_faults()
    # Processes that this one has forked in its turn.
    set_forkserver_preload([FORKED])
    try:
        function(*arguments)
    except Exception as error:
        tell_fault(error)
        raise SystemExit(FAULTY) from None


def tell_fault(error: BaseException, **where: object) -> None:
    """Log an exception as a fault, with the place where it was found."""
    structlog.get_logger("fault").error(FAULT, exc_info=error, **where)


class LibraryHandler(logging.StreamHandler[Any]):
    """Handler of what libraries log; a message that cannot be formatted is a fault."""

    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 (of the base)
        """Log the error of a log message instead of printing its traceback."""
        error = sys.exc_info()[1]
        if error is not None and not isinstance(error, OSError):
            tell_fault(error, place=f"log message of {record.name}: {record.msg}")


def _as_fault(_logger: object, _method: str, line: "EventDict") -> "EventDict":
    """Call an error of a library a fault: a traceback, or whatever asyncio could not tell."""
    record: logging.LogRecord = line["_record"]
    if record.levelno >= logging.ERROR and (line.get("exc_info") or record.name == "asyncio"):
        line["reason"], line["event"] = line["event"], FAULT
    return line


def _uncaught(
    _kind: type[BaseException], error: BaseException, _traceback: TracebackType | None
) -> None:
    tell_fault(error)


def _uncaught_in_thread(caught: threading.ExceptHookArgs) -> None:
    # A thread may end itself so.
    if caught.exc_value is not None and not isinstance(caught.exc_value, SystemExit):
        tell_fault(caught.exc_value, thread=caught.thread.name if caught.thread else "")


def _unraisable(
    others: "Callable[[sys.UnraisableHookArgs], Any]", caught: "sys.UnraisableHookArgs"
) -> None:
    """Log what was raised where nobody can catch it, as in a destructor; no interrupt."""
    if issubclass(caught.exc_type, KeyboardInterrupt):
        others(caught)
        return
    what = f"{caught.err_msg or 'exception ignored in'}: {caught.object!r}"
    tell_fault(caught.exc_value or caught.exc_type(), place=what)


def _line(entry: object, **_: object) -> str:
    try:
        return orjson.dumps(entry, default=str).decode()
    except TypeError:
        # Text that is no valid UTF-8, as in names of files.
        return json.dumps(entry, default=str)
