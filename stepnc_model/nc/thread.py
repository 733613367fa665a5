"""Synchronised moves of NC code: leads of threads, and spindle speeds of taps.

Controls say a lead in different words: as the feed per revolution or per minute at the spindle
speed (Fanuc, Haas), along the path (LinuxCNC G33), along one axis (Sinumerik), or as an
argument of a cycle. Here it is that along the axis that moves most, mm per revolution.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import dist, isnan, nan
from typing import Self

from stepnc_model.nc.moves import FeedMode, ModalSetting
from stepnc_model.post.canonical import along_longest
from stepnc_model.units import SECONDS_PER_MINUTE


@dataclass(frozen=True, slots=True, kw_only=True)
class NcThread:
    """Thread that a move cuts."""

    lead: float
    """Lead along the axis that moves most, mm; NaN if not known."""
    speed: float | None = None
    """Spindle speed that the move itself commands, rev/s, signed; None: that in force."""

    @property
    def back(self) -> Self:
        """The same thread on the way out of a tapped hole: the spindle turns the other way."""
        return self if self.speed is None else replace(self, speed=-self.speed)

    def setting(self, setting: ModalSetting) -> ModalSetting:
        """Modal setting in which the move is executed."""
        if self.speed is None:
            return setting
        speed = None if isnan(self.speed) else self.speed
        return replace(setting, spindle=speed, surface=None, limit=None)


def lead_of_word(word: float, mode: FeedMode) -> float:
    """Lead that an F word names, mm, whatever the feed mode in force; NaN if not known.

    Parameters
    ----------
    word : float, mm/s or mm
        Feed in force as the mode takes it.
    mode : FeedMode
    """
    return word * SECONDS_PER_MINUTE if mode is FeedMode.PER_MINUTE else word


def tap_by_feed(word: float, mode: FeedMode, *, speed: float | None) -> NcThread:
    """Tap whose lead follows from the feed: that per revolution, or by the spindle speed.

    Parameters
    ----------
    word : float, mm/s or mm
        Feed in force as the mode takes it.
    mode : FeedMode
    speed : float or None, rev/s
        Spindle speed of the tap, signed; None: that in force, which is not constant.
    """
    if mode is FeedMode.PER_REVOLUTION:
        return NcThread(lead=word, speed=speed)
    is_known = mode is FeedMode.PER_MINUTE and bool(speed)
    return NcThread(lead=word / abs(speed) if is_known and speed else nan, speed=speed)


def lead_of_path(start: Sequence[float], end: Sequence[float], lead: float) -> float:
    """Lead along the axis that moves most from that along the path, mm; NaN if not known."""
    way = dist(start, end)
    return along_longest(start, end, lead) if way > 0.0 else nan
