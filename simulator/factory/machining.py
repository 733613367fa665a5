"""Machining of parts: time, energy and settings of one part after another.

Times of a program with fixed settings are exact, and so is the energy without deviation; drawn
settings are interpolated. The deviation is drawn for each movement of each part.
"""

from collections.abc import Iterator
from typing import NamedTuple

from simulator.factory.shop import StateLoad
from simulator.factory.streams import Streams


class Settings(NamedTuple):
    """Settings of a part, as in Fig. 11 of paper 003; NaN where a part has none."""

    feed: float
    """mm/s"""
    spindle_speed: float
    """rev/s, negative clockwise"""
    depth: float
    """mm"""


NO_SETTINGS = Settings(float("nan"), float("nan"), float("nan"))


class Machining(NamedTuple):
    """Machining of one part."""

    time: float
    """s"""
    energy: float
    """J"""
    peak_power: float
    """W"""
    settings: Settings = NO_SETTINGS


def timed_machining(load: StateLoad, streams: Streams, owner: str) -> Iterator[Machining]:
    """Machining of which only time and power are known."""
    for time in streams.numbers(load.time, owner, "machining"):
        yield Machining(time, load.power * time, load.power)
