"""Feeds per revolution, kept by a spindle that cannot always follow the radius.

A lathe locks such a feed to the encoder of its spindle: while the spindle ramps, the axes go
as fast as it really turns, and the chip stays as programmed. Units mm, s, rev/s.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from simulator.machine.acts import Stretch
from simulator.machine.spindle_course import SpindleCourse, following
from simulator.motion.motion import Motion
from simulator.motion.segments import Floats, Segments

AGREED = 1e-3
"""relative difference between the feed of a segment and what its mean spindle speed asks for"""

MOST_PLANS = 20
"""of one stretch; a tenth of them is usual"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Paced:
    """A stretch as it is run."""

    segments: Segments
    """with the feeds at which they are planned"""
    motion: Motion
    spindle: SpindleCourse


def paced(
    stretch: Stretch,
    plan: Callable[[Segments], Motion],
    spindle: SpindleCourse,
    *,
    begin: float,
    acceleration: float,
) -> Paced:
    """Motion and spindle that agree.

    The motion says when each radius is reached, hence how far the spindle has come; its mean
    speed in each segment says the feed, hence the motion. Each plan is closed form; they are
    repeated until feeds and spindle agree within ``AGREED``. What happens later changes nothing
    before it, so that the repetition ends as that of an integral equation does.

    Parameters
    ----------
    stretch : Stretch
    plan : callable
        Motion of segments, from rest to rest.
    spindle : SpindleCourse
        Until the stretch begins.
    begin : float, s
    acceleration : float, rev/s²
        Of the spindle; infinite: without delay.
    """
    segments, before = stretch.segments, spindle
    for _ in range(MOST_PLANS):
        motion = plan(segments)
        spindle = _followed(stretch, before, begin, motion.ends, acceleration=acceleration)
        speed = _locked(stretch, spindle, begin, motion.ends)
        is_own = np.isnan(speed)
        if is_own.all() or (np.abs(speed / segments.speed - 1.0)[~is_own] <= AGREED).all():
            break
        segments = replace(segments, speed=np.where(is_own, segments.speed, speed))
    return Paced(segments=segments, motion=motion, spindle=spindle)


def _followed(
    stretch: Stretch,
    spindle: SpindleCourse,
    begin: float,
    ends: Floats,
    *,
    acceleration: float,
) -> SpindleCourse:
    """The spindle, which follows the radius where it keeps a surface speed."""
    wanted = stretch.spindle_speed
    if np.isnan(wanted).all():
        return spindle
    return following(spindle, begin, begin + ends, wanted=wanted, acceleration=acceleration)


def _locked(stretch: Stretch, spindle: SpindleCourse, begin: float, ends: Floats) -> Floats:
    """(N,) mm/s that the spindle's mean speed in each segment asks for; NaN: not locked."""
    turned = np.diff(spindle.revolutions(begin + np.concatenate(([0.0], ends))))
    seconds = np.diff(ends, prepend=0.0)
    mean = np.divide(np.abs(turned), seconds, out=np.zeros(len(ends)), where=seconds > 0.0)
    return np.where(mean > 0.0, stretch.per_revolution * mean, np.nan)
