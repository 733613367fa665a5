"""Runs that an agent plays: it is handed observations when they are due.

Apart from what reads recorded runs, which needs the packages of an extra.
"""

import asyncio
import time
from collections.abc import Iterator, Mapping
from typing import Protocol

from extras.agent.model.agent import Agent
from extras.agent.model.buffer import Value
from extras.agent.model.machine_feed import RunFeed
from extras.agent.model.model import DeviceModel
from stepnc_model.units import US_PER_SECOND

STEP = 0.02
"""Wall-clock time between looks at what is due, in s."""

PART_COUNT = "PART_COUNT"


class PlayableRun(Protocol):
    """Run that can be played: a simulated or a recorded one."""

    @property
    def devices(self) -> DeviceModel:
        """Device model whose data items are observed."""

    @property
    def duration(self) -> float:
        """Duration of the run, in s."""

    def feeds(self) -> Iterator[RunFeed]:
        """Yield the observations from the beginning on, in the order of time."""

    def first(self, count: int) -> Mapping[str, Value]:
        """Return the values that hold at the beginning, after a number of earlier runs."""

    def equip(self, agent: Agent) -> None:
        """Add the assets of the run to an agent."""


def begun(run: PlayableRun, *, speed: float, size: int) -> Agent:
    """Return an agent that has no observation of the run yet, and begins with it."""
    agent = Agent(
        model=run.devices,
        clock=now,
        size=size,
        begin=_anchor(run, speed),
        is_scaled=speed != 1.0,
    )
    run.equip(agent)
    return agent


async def play(agent: Agent, run: PlayableRun, *, speed: float, is_looped: bool) -> None:
    """Hand observations to an agent when they are due.

    Stamps are time of the run, anchored so that the last one is not after the clock.

    Parameters
    ----------
    speed : float
        Seconds of the run per second of wall-clock time; 0: all at once.
    is_looped : bool
        Whether to start again at the end.
    """
    counters = [item.id for item in run.devices.items if item.type == PART_COUNT]
    count = 0
    while True:
        begin = now()
        anchor = agent.buffer.last_time if count == 0 else _anchor(run, speed)
        first = run.first(count)
        agent.tell(first, time=anchor)
        for feed in run.feeds():
            await _play_part(agent, feed, begin=begin, anchor=anchor, speed=speed)
        count += 1
        agent.tell({id: count for id in counters if id in first})
        if not is_looped:
            return


async def _play_part(
    agent: Agent, feed: RunFeed, *, begin: int, anchor: int, speed: float
) -> None:
    at, total = 0, len(feed.values)
    stamps = anchor + (feed.times * US_PER_SECOND).astype(int)
    while at < total:
        end = total
        if speed > 0.0:
            due = speed * (now() - begin) / US_PER_SECOND
            end = int(feed.times.searchsorted(due, side="right"))
        agent.add(feed.items[at:end], stamps[at:end], feed.values[at:end])
        at = end
        await asyncio.sleep(STEP if at < total else 0.0)


def _anchor(run: PlayableRun, speed: float) -> int:
    """Stamp of the beginning of a run that is played from now on, in µs since 1970."""
    duration = int(run.duration * US_PER_SECOND)
    if speed == 0.0:
        return now() - duration
    return now() - (duration - int(duration / speed) if speed > 1.0 else 0)


def now() -> int:
    """Return the wall-clock time in µs since 1970."""
    return time.time_ns() // 1000
