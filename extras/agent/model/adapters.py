"""Connections of SHDR: adapters that an agent listens to, and one that feeds other agents."""

import asyncio
import socket
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import ConditionValue, Value
from extras.agent.model.model import DeviceModel
from extras.agent.model.shdr import ShdrObservation, read_line, written

LONGEST_LINE = 1 << 16
"""bytes of a line; a longer one ends the connection"""

AGAIN = 2.0
"""s before a lost adapter is called again"""

USUAL_HEARTBEAT = 10.0
"""s between pings; an adapter may ask for another"""

SKEW = 2.0
"""s between the clocks of an adapter and the agent from which on it is told"""

ENOUGH = 3
"""parts with newer stamps after which a clock is judged"""

MOST_WAITING = 100_000
"""lines that may wait for a slow agent, until it is dropped"""


@dataclass(frozen=True, slots=True, kw_only=True)
class AdapterAddress:
    """Address of an adapter."""

    host: str
    port: int


@dataclass(kw_only=True)
class AdapterIntake:
    """Intake of adapters' values; repeats and small changes are dropped. Running state."""

    agent: Agent
    tell: Callable[[str], None] = field(default=lambda _: None)
    """takes messages on adapters"""
    _last: dict[int, tuple[int, Value]] = field(default_factory=dict)

    def take(self, observations: Sequence[ShdrObservation]) -> None:
        """Add what is new."""
        kept = [each for each in observations if self._is_new(each)]
        self.agent.add(
            np.array([each.item for each in kept], dtype=np.int64),
            np.array([each.time for each in kept], dtype=np.int64),
            [each.value for each in kept],
        )

    def forget(self, items: Sequence[int]) -> None:
        """Lose the source of some data items."""
        for item in items:
            self._last.pop(item, None)
        self.agent.lose(items)

    def _is_new(self, seen: ShdrObservation) -> bool:
        item = self.agent.model.items[seen.item]
        if item.constant is not None:
            return False
        last = self._last.get(seen.item)
        if last is not None and not isinstance(seen.value, ConditionValue | dict):
            time, value = last
            if value == seen.value and not item.is_discrete:
                return False
            # A clock that was set back tells no period.
            if item.period and 0 <= seen.time - time < 1e6 * item.period:
                return False
            both = isinstance(value, float) and isinstance(seen.value, float)
            if item.minimum_delta and both and abs(seen.value - value) < item.minimum_delta:  # type: ignore[operator]
                return False
        self._last[seen.item] = seen.time, seen.value
        return True


@dataclass(kw_only=True)
class AdapterClock:
    """Clock of an adapter against that of the agent. Running state.

    What waits on the way makes an adapter seem slow, and so does what holds since long, which
    an adapter tells at first: so the least of several differences counts, of stamps that are
    newer than all before.
    """

    newest: int | None = None
    """µs since 1970"""
    count: int = 0
    """how often a part with a newer stamp came"""
    behind: int | None = None
    """least difference so far, µs; negative: the adapter is ahead"""
    is_judged: bool = False

    def skew(self, times: Sequence[int], now: int) -> float | None:
        """Seconds that the clock is behind, once and only if they are many.

        Parameters
        ----------
        times : sequence of int, µs since 1970
            Stamps of a part.
        now : int, µs since 1970
            When it came, by the clock of the agent.
        """
        newest = max(times, default=None)
        if self.is_judged or newest is None:
            return None
        if self.newest is not None and newest > self.newest:
            self.count += 1
            behind = now - newest
            self.behind = behind if self.behind is None else min(self.behind, behind)
        self.newest = max(newest, self.newest or newest)
        if self.count < ENOUGH or self.behind is None:
            return None
        self.is_judged = True
        seconds = self.behind / 1e6
        return seconds if abs(seconds) >= SKEW else None


async def listen_to(address: AdapterAddress, intake: AdapterIntake) -> None:
    """Keep a connection to an adapter, and take what it tells, until cancelled."""
    clock = AdapterClock()
    while True:
        told: set[int] = set()
        with suppress(OSError, TimeoutError):
            await _listen_once(address, intake, told, clock)
        if told:
            intake.forget(sorted(told))
        await asyncio.sleep(AGAIN)


async def _listen_once(
    address: AdapterAddress, intake: AdapterIntake, reported: set[int], clock: AdapterClock
) -> None:
    reader, writer = await asyncio.open_connection(address.host, address.port)
    agent, heartbeat = intake.agent, USUAL_HEARTBEAT
    pinger = asyncio.create_task(_ping(writer, lambda: heartbeat))
    try:
        _begin(agent, reported)
        rest = b""
        while True:
            # An adapter that answers no ping for two heartbeats is lost.
            async with asyncio.timeout(2.0 * heartbeat + 1.0):
                data = await reader.read(LONGEST_LINE)
            *lines, rest = (rest + data).split(b"\n")
            if not data or len(rest) > LONGEST_LINE:
                return
            found: list[ShdrObservation] = []
            for each in lines:
                text = each.decode("utf-8", "replace").strip()
                if text.startswith("* PONG"):
                    heartbeat = _requested_heartbeat(text, heartbeat)
                elif not text.startswith("*"):
                    found += read_line(text, agent.model, agent.clock)
            reported.update(each.item for each in found)
            skew = clock.skew([each.time for each in found], agent.clock())
            if skew is not None:
                intake.tell(_skewed(address, skew))
            intake.take(found)
    finally:
        pinger.cancel()
        writer.close()


def _skewed(address: AdapterAddress, seconds: float) -> str:
    """Warning about a clock that is wrong."""
    how = "behind" if seconds > 0.0 else "ahead of"
    return (
        f"adapter {address.host}:{address.port}: its clock is {abs(seconds):.1f} s {how} that "
        "of the agent; its timestamps are kept, and cannot be compared with those of others. "
        "Set its clock"
    )


def _begin(agent: Agent, reported: set[int]) -> None:
    """Report the devices of a connected adapter as available."""
    for number, item in enumerate(agent.model.items):
        of = agent.model.devices[agent.model.components[item.component].device]
        if item.type == "AVAILABILITY" and not of.is_agent:
            reported.add(number)
            agent.tell({item.id: "AVAILABLE"})


async def _ping(writer: asyncio.StreamWriter, heartbeat: Callable[[], float]) -> None:
    while True:
        writer.write(b"* PING\n")
        with suppress(OSError):
            await writer.drain()
        await asyncio.sleep(heartbeat())


def _requested_heartbeat(text: str, before: float) -> float:
    word = text.removeprefix("* PONG").strip()
    return min(max(int(word) / 1000.0, 0.1), 3600.0) if word.isdecimal() else before


class ShdrServer:
    """Adapter of an agent: tells every agent that connects what holds, then what is new.

    Parameters
    ----------
    agent : Agent
        Whose observations are told.
    heartbeat : int
        ms that the others are asked to ping within.
    """

    def __init__(self, agent: Agent, *, heartbeat: int = 10_000) -> None:
        self.agent = agent
        self.heartbeat = heartbeat

    async def serve(self, listener: socket.socket) -> asyncio.Server:
        """Take connections of agents."""
        return await asyncio.start_server(self._feed, sock=listener, limit=LONGEST_LINE)

    async def _feed(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        answers: deque[bytes] = deque()
        listener = asyncio.create_task(self._answer(reader, answers))
        try:
            await self._tell(writer, answers, listener)
        except (OSError, TimeoutError, asyncio.CancelledError):
            # Streams of Python 3.11 report a cancelled connection as a fault of the program.
            pass
        finally:
            listener.cancel()
            writer.close()

    async def _answer(self, reader: asyncio.StreamReader, answers: deque[bytes]) -> None:
        with suppress(OSError, ValueError):
            while line := await reader.readline():
                if line.startswith(b"* PING"):
                    answers.append(f"* PONG {self.heartbeat}\n".encode())

    async def _tell(
        self,
        writer: asyncio.StreamWriter,
        answers: deque[bytes],
        listener: "asyncio.Task[None]",
    ) -> None:
        buffer, model = self.agent.buffer, self.agent.model
        lines = [
            line
            for item, held in enumerate(buffer.state)
            if not _is_of_agent(model, item)
            for entry in held
            for line in written(model, item, entry.time, entry.value)
        ]
        following = buffer.next
        while not listener.done():
            while answers:
                lines.append(answers.popleft().decode().rstrip())
            writer.write("".join(f"{line}\n" for line in lines).encode())
            async with asyncio.timeout(15.0):
                await writer.drain()
            await self.agent.wait(following, 0.2)
            if buffer.next - following > MOST_WAITING or following < buffer.first:
                return
            span = np.arange(following, buffer.next)
            items, times = buffer.take(span)
            lines = [
                line
                for item, time, sequence in zip(
                    items.tolist(), times.tolist(), span.tolist(), strict=True
                )
                if not _is_of_agent(model, item)
                for line in written(model, item, time, buffer.value(sequence))
            ]
            following = buffer.next


def _is_of_agent(model: DeviceModel, item: int) -> bool:
    return model.devices[model.components[model.items[item].component].device].is_agent
