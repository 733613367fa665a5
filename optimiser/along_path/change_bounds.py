"""Bounds on how far NC code may be changed whose intent only its own feeds tell.

A feed that a person programmed has reasons that no table knows. So it rises to a few times its
value at most, and a mill that goes straight down keeps it: the edges near the axis hardly move,
and chips must leave past the flutes. Where the user lets tools plunge, the catalogue's share
holds down to one diameter in one go, and falls beyond with the depth: each retract begins anew.

Units: mm, mm/s.
"""

import numpy as np

from optimiser.along_path.stretch import PathStretch
from simulator.motion.segments import Bools, Floats
from simulator.removal.stations import stretch_lengths

STRAIGHT = 0.9
"""Sine of the descent from which a mill goes straight down: about 64°. Ramps are flatter than
half of that."""

DEPTH_RATIO = 1.0
"""Depth of a plunge in one go over the tool diameter, up to which the catalogue's share of the
feed holds (customary)."""


def programmed_rates(stretch: PathStretch) -> Floats:
    """Programmed feed of each segment in the unit of its block, (N,): mm/s, or mm per turn."""
    is_own = ~np.isnan(stretch.per_revolution)
    return np.where(is_own, stretch.per_revolution, stretch.segments.speed)


def risen(stretch: PathStretch, base: Floats, rise: float) -> Floats:
    """Greatest feed by a rise over base feeds in the units of their blocks, (N,), mm/s."""
    rates, speed = programmed_rates(stretch), stretch.segments.speed
    is_fed = ~stretch.segments.is_rapid & (rates > 0.0)
    feeds = np.where(is_fed, speed, np.inf)
    feeds[is_fed] *= rise * base[is_fed] / rates[is_fed]
    return feeds


def is_straight_down(stretch: PathStretch) -> Bools:
    """True if segments at a feed go straight down along Z, (N,)."""
    return _descent(stretch) >= STRAIGHT


def is_straight_up(stretch: PathStretch) -> Bools:
    """True if segments at a feed go straight up along Z, (N,)."""
    return _descent(stretch) <= -STRAIGHT


def _descent(stretch: PathStretch) -> Floats:
    segments = stretch.segments
    length = np.where(segments.length > 0.0, segments.length, 1.0)
    sine: Floats = (segments.start[:, 2] - segments.end[:, 2]) / length
    return np.where(segments.is_rapid, 0.0, sine)


def plunge_feeds(stretch: PathStretch, base: Floats, *, is_allowed: bool) -> Floats:
    """Greatest feed of straight plunges of a mill, (N,), mm/s; infinite elsewhere.

    Parameters
    ----------
    base : (N,) array
        Feeds as programmed, in the units of their blocks.
    is_allowed : bool
        Whether the user lets tools plunge faster than programmed.
    """
    is_down = is_straight_down(stretch)
    feeds = risen(stretch, base, 1.0)
    bounds = stretch.bounds
    if is_allowed and bounds is not None and bounds.plunge is not None:
        depth = _depths(stretch, is_down)
        share = np.minimum(1.0, DEPTH_RATIO * bounds.cut.diameter / np.maximum(depth, 1e-9))
        catalogue = bounds.plunge * bounds.cut.tool.teeth * stretch.spindle
        feeds = np.maximum(feeds, np.maximum(share * catalogue, bounds.least))
    return np.where(is_down, feeds, np.inf)


def _depths(stretch: PathStretch, is_down: Bools) -> Floats:
    """Depth in the material to which the descent of each segment goes in one go, (N,), mm."""
    met = stretch.met
    cut = np.zeros(len(is_down))
    np.add.at(cut, met.segment, np.where(met.peak_section > 0.0, stretch_lengths(met), 0.0))
    begins = np.flatnonzero(np.diff(is_down, prepend=~is_down[:1]))
    whole = np.add.reduceat(cut, begins)
    return np.repeat(whole, np.diff(np.append(begins, len(is_down))))
