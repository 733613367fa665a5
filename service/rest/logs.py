"""Logs as lines of JSON on stderr: one shape for requests, jobs and the server's own words."""

import asyncio
import logging
import sys
from datetime import UTC, datetime

import orjson
import structlog

WAIT = 0.05
"""s for which the lines of requests are kept back"""

STAMP = structlog.processors.TimeStamper(fmt="iso", utc=True)


def configure(level: str) -> None:
    """Send everything there, from a level on."""
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
    # It tells of every version that it looks at.
    logging.getLogger("alembic").setLevel(logging.WARNING)


class RequestLog:
    """A line for each request, several of them written at once. Running state.

    Lines wait for a twentieth of a second: one by one they would cost a look-up a tenth more.
    """

    def __init__(self) -> None:
        self._lines: list[bytes] = []

    def add(self, entry: dict[str, object]) -> None:
        """One line more; within a running loop."""
        if not self._lines:
            asyncio.get_running_loop().call_later(WAIT, self.write)
        stamp = datetime.now(UTC).isoformat(timespec="milliseconds")
        line = {"event": "request", "level": "info", "timestamp": stamp, **entry}
        self._lines.append(orjson.dumps(line))

    def write(self) -> None:
        """All that wait."""
        if self._lines:
            text = b"\n".join(self._lines).decode()
            self._lines.clear()
            sys.stderr.write(f"{text}\n")
            sys.stderr.flush()


def _line(entry: object, **_: object) -> str:
    return orjson.dumps(entry, default=str).decode()
