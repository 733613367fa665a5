"""Logging as JSON lines on stderr, in one format for requests, jobs and the server itself."""

import asyncio
import logging
import sys
from datetime import UTC, datetime

import orjson
import structlog

WAIT = 0.05
"""Time for which request lines are buffered, in s."""

STAMP = structlog.processors.TimeStamper(fmt="iso", utc=True)


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
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=[structlog.stdlib.add_log_level, STAMP],
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.format_exc_info,
                structlog.processors.JSONRenderer(serializer=_line),
            ],
        )
    )
    logging.basicConfig(level=max(least, logging.INFO), handlers=[handler], force=True)
    # Alembic logs every migration that it checks.
    logging.getLogger("alembic").setLevel(logging.WARNING)


class RequestLog:
    """Log of requests, which writes several lines at once. Running state.

    Lines are buffered for 0.05 s: writing each alone would make a look-up a tenth slower.
    """

    def __init__(self) -> None:
        self._lines: list[bytes] = []

    def add(self, entry: dict[str, object]) -> None:
        """Add a line for a request; must be called within a running event loop."""
        if not self._lines:
            asyncio.get_running_loop().call_later(WAIT, self.write)
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
        line = {"event": "request", "level": "info", "timestamp": stamp, **entry}
        self._lines.append(orjson.dumps(line))

    def write(self) -> None:
        """Write all buffered lines."""
        if self._lines:
            text = b"\n".join(self._lines).decode()
            self._lines.clear()
            sys.stderr.write(f"{text}\n")
            sys.stderr.flush()


def _line(entry: object, **_: object) -> str:
    return orjson.dumps(entry, default=str).decode()
