"""Server-sent events: one reader serves all subscribers of a run or of a monitored machine.

While a run has subscribers, its reader polls the files of the run several times a second, makes
one message of what is new and sends the same bytes to every subscriber. A client that is too
slow loses messages, is told so by an event ``gap``, and should read the series again.
"""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol

import numpy as np
import orjson
import structlog

from service.errors import NotFound, ServiceError, TooMany
from service.live.journal import LiveFolder, read_on
from service.live.series import open_series
from service.rest.metrics import STREAMS
from service.rest.storage_queries import answered
from service.rest.views import job_view
from service.storage import jobs
from service.storage.folder import DataFolder
from service.storage.jobs import Job

LOG = structlog.get_logger("streams")

TICK = 0.1
"""Interval between two polls of a run's files, in s."""

ROWS = 40
"""Most rows of the series in one message; longer stretches are thinned out."""

WAITING = 50
"""Messages that may wait for a client before further ones are dropped."""

MOST_CLIENTS = 1000

QUIET = 10.0
"""Time without a message after which a comment keeps the connection alive, in s."""

END_OF_STREAM = b""
"""Marker of the end of the stream in a client's queue."""


def event(name: str, content: Any) -> bytes:
    """Encode a server-sent event."""
    data = orjson.dumps(content, option=orjson.OPT_SERIALIZE_NUMPY)
    return b"event: " + name.encode() + b"\ndata: " + data + b"\n\n"


@dataclass(eq=False)
class StreamClient:
    """Subscriber of server-sent events. Running state."""

    queue: asyncio.Queue[bytes] = field(default_factory=lambda: asyncio.Queue(WAITING))
    has_lost: bool = False

    def give(self, message: bytes) -> None:
        """Queue a message; drop it if the client is too slow."""
        if self.has_lost and self.queue.qsize() < WAITING // 2:
            self.has_lost = False
            self.queue.put_nowait(event("gap", {}))
        if self.has_lost:
            return
        try:
            self.queue.put_nowait(message)
        except asyncio.QueueFull:
            self.has_lost = True

    def end(self) -> None:
        """End the stream; tell a client that has lost messages before it ends."""
        if self.has_lost or self.queue.full():
            while self.queue.qsize() > WAITING - 2:
                self.queue.get_nowait()
            self.queue.put_nowait(event("gap", {}))
        self.queue.put_nowait(END_OF_STREAM)


class Reader(Protocol):
    """Makes the messages for all subscribers of one thing."""

    clients: set[StreamClient]
    is_finished: bool

    def first(self) -> list[bytes]:
        """Return the first messages for a new subscriber."""
        ...

    async def run(self) -> None:
        """Send messages until there are no more, or no subscriber is left."""
        ...


class RunReader:
    """Reads the files of one run for all its subscribers. Running state."""

    def __init__(self, data_folder: DataFolder, id: str) -> None:
        self.clients: set[StreamClient] = set()
        self.is_finished = False
        self._data_folder, self._id = data_folder, id
        self._folder = LiveFolder(path=data_folder.job_folder(id))
        self._row = 0
        self._offset = 0
        self._job: bytes = b""
        self._status: bytes = b""

    async def run(self) -> None:
        """Poll and send until the job has ended or no subscriber is left."""
        try:
            with suppress(NotFound):
                await self._current()
                self._skip()
                while self.clients:
                    job = await self._current()
                    # The job is read first, so that what it wrote before its end is not missed.
                    for message in self._news(job):
                        for client in self.clients:
                            client.give(message)
                    if job.state.is_finished:
                        break
                    await asyncio.sleep(TICK)
        finally:
            # Also after an error: no subscriber may wait for messages that never come.
            self.is_finished = True
            for client in self.clients:
                client.end()

    async def _current(self) -> Job:
        """Return the job as it is, and find its folder."""
        job = await answered(jobs.get, self._data_folder, self._id)
        path = self._data_folder.run_folder(job.id, job.attempt)
        self._folder = LiveFolder(path=path)
        return job

    def _skip(self) -> None:
        """Skip rows and events written so far; subscribers read those from the files."""
        series = open_series(self._folder.series)
        self._row = 0 if series is None else len(series)
        while (read := read_on(self._folder.events, self._offset)).lines:
            self._offset = read.offset

    def first(self) -> list[bytes]:
        """Return the first messages for a new subscriber: the job and the status."""
        return [message for message in (self._job, self._status) if message]

    def _news(self, job: Job) -> list[bytes]:
        """Return messages about everything that has changed since the last poll."""
        news = []
        status = self._folder.read_status()
        said = b"" if status is None else event("status", status)
        if said != self._status:
            self._status = said
            news.append(said)
        rows = self._rows()
        if rows is not None:
            news.append(rows)
        read = read_on(self._folder.events, self._offset)
        self._offset = read.offset
        news += [event("event", line) for line in read.lines]
        told = event("job", job_view(job))
        if told != self._job:
            self._job = told
            news.append(told)
        return news

    def _rows(self) -> bytes | None:
        series = open_series(self._folder.series)
        if series is not None and len(series) < self._row:
            # The job was started again and writes a new series.
            self._row = 0
        if series is None or len(series) <= self._row:
            return None
        count = len(series) - self._row
        at = np.unique(np.linspace(self._row, len(series) - 1, min(count, ROWS)).astype(int))
        values = np.ascontiguousarray(series.values[at].T)
        self._row = len(series)
        columns = {name: values[place] for place, name in enumerate(series.columns)}
        return event("rows", {"columns": columns, "is_reduced": count > ROWS})


class StreamHub:
    """Readers of everything that is watched, by its id. Running state."""

    def __init__(self, data_folder: DataFolder) -> None:
        self._data_folder = data_folder
        self._readers: dict[str, Reader] = {}
        self._tasks: set[asyncio.Task[None]] = set()
        self._clients = 0

    def require_room(self) -> None:
        """Refuse a subscriber beyond the allowed number, before the answer begins.

        Raises
        ------
        TooMany
        """
        if self._clients >= MOST_CLIENTS:
            raise TooMany(10.0)

    def watch(self, id: str) -> AsyncIterator[bytes]:
        """Yield the messages of a run to a new subscriber; as :meth:`watch_by`."""
        return self.watch_by(id, partial(RunReader, self._data_folder, id))

    async def watch_by(self, id: str, make: Callable[[], Reader]) -> AsyncIterator[bytes]:
        """Yield the messages of a reader, made if there is none, to a new subscriber.

        Raises
        ------
        TooMany
            When the allowed number of subscribers is reached.
        """
        self.require_room()
        client = StreamClient()
        reader = self._joined(id, client, make)
        self._clients += 1
        STREAMS.inc()
        try:
            for message in reader.first():
                yield message
            while True:
                try:
                    async with asyncio.timeout(QUIET):
                        message = await client.queue.get()
                except TimeoutError:
                    yield b": still here\n\n"
                    continue
                if message == END_OF_STREAM:
                    return
                yield message
        finally:
            self._clients -= 1
            STREAMS.dec()
            reader.clients.discard(client)

    def _joined(self, id: str, client: StreamClient, make: Callable[[], Reader]) -> Reader:
        reader = self._readers.get(id)
        if reader is not None and not reader.is_finished:
            reader.clients.add(client)
            return reader
        reader = self._readers[id] = make()
        reader.clients.add(client)
        task = asyncio.create_task(reader.run())
        self._tasks.add(task)

        def done(ended: asyncio.Task[None]) -> None:
            self._tasks.discard(ended)
            if self._readers.get(id) is reader:
                del self._readers[id]
            if not ended.cancelled() and (error := ended.exception()) is not None:
                LOG.error("watching failed", id=id, reason=str(error))

        task.add_done_callback(done)
        return reader

    async def close(self) -> None:
        """End all streams when the service stops."""
        for reader in self._readers.values():
            for client in reader.clients:
                client.end()
        for task in list(self._tasks):
            task.cancel()
            with suppress(asyncio.CancelledError, ServiceError):
                await task
