"""Places where a mill cuts deeper than its tool allows at the width that it meets.

The rule is that of a workingstep (:func:`optimiser.bounds.limits.depth_limits`), asked at the
places of a path. No feed makes a place less deep, so that the depth bounds no feed here: it is
told.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from optimiser.advice import LimitLoad
from optimiser.along_path.caps import CutBounds
from optimiser.along_path.stretch import PathStretch
from optimiser.bounds.limits import DEEPER, depth_limits
from optimiser.cuts.cut import CutKind
from optimiser.cuts.hardest_places import width_ratios
from optimiser.planning.formulate import limit_loads
from optimiser.solver.problem import LimitName
from simulator.motion.segments import Floats, Ints
from simulator.removal.stations import StationKind, stretch_lengths

DIGITS = 2
"""Decimal places of the radial width over the diameter to which places share a bound."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeepPlaces:
    """Places of a part of a program that are too deep, and the one that is so most."""

    block: int
    """Number of the block of that place."""
    load: LimitLoad
    """Its depth, with the greatest at its width."""
    width: float
    """Its radial width, mm."""
    length: float
    """Length of all such places, mm."""

    def with_more(self, other: "DeepPlaces | None") -> "DeepPlaces":
        """These places and others together."""
        if other is None:
            return self
        worst = min(self, other, key=lambda each: each.load.margin)
        return replace(worst, length=self.length + other.length)


def with_deep_places(
    known: Mapping[str, DeepPlaces], stretch: PathStretch
) -> Mapping[str, DeepPlaces]:
    """Deep places by part of the program, with those of one more stretch."""
    found, name = deep_places(stretch), stretch.workingstep
    return known if found is None else {**known, name: found.with_more(known.get(name))}


def deep_places(stretch: PathStretch) -> DeepPlaces | None:
    """Places of a stretch that are deeper than the tool allows; None without any."""
    bounds, met = stretch.bounds, stretch.met
    if bounds is None or bounds.cut.kind is not CutKind.MILLING:
        return None
    arcs = met.arcs
    is_milled = (met.kind == StationKind.MILLING) & (met.peak_section > 0.0)
    at = np.flatnonzero(is_milled & (arcs.exit_angle > arcs.entry_angle))
    width, depth = width_ratios(arcs, at) * arcs.fill[at], arcs.depth[at]
    length = stretch_lengths(met)[at]
    found: DeepPlaces | None = None
    for rows in _alike(width):
        row = int(rows[depth[rows].argmax()])
        load = _load(bounds, float(width[row]), float(depth[row]))
        if load is None or load.value <= DEEPER * load.bound:
            continue
        is_deep = depth[rows] > DEEPER * load.bound
        found = DeepPlaces(
            block=int(stretch.segments.block[met.segment[at[row]]]),
            load=load,
            width=float(width[row]) * bounds.cut.diameter,
            length=float(length[rows[is_deep]].sum()),
        ).with_more(found)
    return found


def _alike(width: Floats) -> Iterator[Ints]:
    """Rows of places of about the same width."""
    _, which, count = np.unique(
        np.round(width, DIGITS), return_inverse=True, return_counts=True
    )
    order = np.argsort(which.ravel(), kind="stable")
    yield from np.split(order, np.cumsum(count)[:-1]) if len(width) else ()


def _load(bounds: CutBounds, width: float, depth: float) -> LimitLoad | None:
    """Depth of a place with the greatest at its width; None where nothing bounds it."""
    cut = bounds.cut
    cut = replace(
        cut,
        radial_width=width * cut.diameter,
        programmed=replace(cut.programmed, depth=depth),
        total_depth=depth,
    )
    limits = depth_limits(cut, bounds.at)
    found = tuple(each for each in limits if each.name is LimitName.AXIAL_DEPTH)
    return limit_loads(found, (1.0, depth, 1.0))[0] if found else None
