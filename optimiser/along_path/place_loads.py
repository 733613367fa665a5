"""Loads at single places of a path, told by the limits of a workingstep.

Caps say how fast a tool may go at each place (:mod:`optimiser.along_path.caps`). Where a user
is to read what is broken, the place is taken as a cut of its own: its limits have units,
origins and words, and its loads are those that the caps were computed from.
"""

from collections.abc import Iterator, Mapping
from dataclasses import fields, replace

import numpy as np

from optimiser.advice import LimitLoad
from optimiser.along_path.caps import NAMES, CapName, CutBounds
from optimiser.along_path.filter_transfer import BrokenBound
from optimiser.along_path.pieces import FeedPieces
from optimiser.along_path.runs import OWN, WRITTEN
from optimiser.along_path.stretch import PathStretch, met_caps
from optimiser.bounds.holding import chuck_limits, holding_limits
from optimiser.bounds.limits import machine_limits, segment_at, spindle_limits, tool_limits
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.hardest_places import PathContacts, bending, with_hardest
from optimiser.planning.formulate import limit_loads
from optimiser.solver.problem import BoundSide, LimitName, Setting
from simulator.removal.stations import StationKind, Stations

HELD = frozenset({
    LimitName.CHUCK_TORQUE,
    LimitName.TILTING_MOMENT,
    LimitName.HOLDING_FORCE,
    LimitName.BAR_DEFLECTION,
})

OF_CUT: Mapping[CapName, frozenset[LimitName]] = {
    CapName.CHIP_THICKNESS: frozenset({LimitName.FEED_PER_TOOTH}),
    CapName.FEED_PER_TOOTH: frozenset({LimitName.FEED_PER_TOOTH}),
    CapName.CUTTING_FORCE: frozenset({LimitName.CUTTING_FORCE}),
    CapName.MOTOR_POWER: frozenset({LimitName.MOTOR_POWER}),
    CapName.SPINDLE_TORQUE: frozenset({LimitName.SPINDLE_TORQUE}),
    CapName.TOOL_DEFLECTION: frozenset({LimitName.TOOL_DEFLECTION}),
    CapName.SHANK_STRENGTH: frozenset({LimitName.SHANK_STRENGTH}),
    CapName.HOLDING: HELD,
}
"""Limits of a cut from which the caps of a place follow."""

LEFT_ALONE = frozenset({*OWN, *WRITTEN, NAMES.index(CapName.LEAST)})
"""Numbers of the caps that are no bounds of the process."""


def lost_times(pieces: FeedPieces) -> dict[CapName, float]:
    """Time that pieces lose to the bounds of the process, by the bound, s.

    Feeds that only the axes or the caution with a program keep down lose nothing.
    """
    lost = pieces.weight / pieces.rate - pieces.weight / pieces.programmed
    is_lost = (lost > 0.0) & ~np.isin(pieces.name, list(LEFT_ALONE))
    return {
        NAMES[number]: float(lost[is_lost & (pieces.name == number)].sum())
        for number in np.unique(pieces.name[is_lost])
    }


def broken_bounds(stretch: PathStretch, pieces: FeedPieces) -> dict[CapName, BrokenBound]:
    """Bounds that the programmed feeds of a stretch break, each where it is broken most.

    Raises
    ------
    ValueError
        When an engagement is not a number; with its place.
    """
    found: dict[CapName, BrokenBound] = {}
    ratio = pieces.programmed / pieces.rate
    for name in lost_times(pieces):
        rows = np.flatnonzero(pieces.name == NAMES.index(name))
        row = rows[ratio[rows].argmax()]
        found[name] = BrokenBound(
            block=int(pieces.block[row]), ratio=float(ratio[row]), name=name
        )
    if stretch.bounds is not None and (pieces.rate < pieces.programmed).any():
        # A least feed of the user hides the bound that would demand less.
        free = replace(stretch, bounds=replace(stretch.bounds, least=0.0))
        found |= {each.name: each for each in _broken_at_stations(free)}
    return found


def worst_bounds(
    one: Mapping[CapName, BrokenBound], other: Mapping[CapName, BrokenBound]
) -> dict[CapName, BrokenBound]:
    """Broken bounds of two stretches, each where it is broken most."""
    found = dict(one)
    for name, bound in other.items():
        if name not in found or bound.ratio > found[name].ratio:
            found[name] = bound
    return found


def _broken_at_stations(stretch: PathStretch) -> Iterator[BrokenBound]:
    """Bounds that are broken at stations of their own, with their loads."""
    bounds = stretch.bounds
    if bounds is None:
        return
    segments, segment = stretch.segments, stretch.met.segment
    caps = met_caps(stretch).caps
    speed = np.where(stretch.is_free & ~segments.is_rapid, segments.speed, 0.0)[segment]
    ratio = speed / caps.feed
    for number in np.unique(caps.name[ratio > 1.0]):
        rows = np.flatnonzero(caps.name == number)
        row = int(rows[ratio[rows].argmax()])
        at, load = segment[row], None
        # What nothing is cut at has no loads, as before the first contact.
        if stretch.met.axial_depth[row] > 0.0:
            loads = loads_at(
                row_of(stretch.met, row),
                bounds,
                feed=float(segments.speed[at]),
                spindle=float(stretch.spindle[at]),
            )
            load = _load_of(NAMES[number], loads)
        yield BrokenBound(
            block=int(segments.block[at]),
            ratio=float(ratio[row]),
            name=NAMES[number],
            load=load,
        )


def _load_of(name: CapName, loads: tuple[LimitLoad, ...]) -> LimitLoad | None:
    """Load farthest above its bound among those that a cap follows from."""
    names = OF_CUT.get(name, frozenset())
    known = [
        each
        for each in loads
        if each.limit.name in names and each.limit.sense is BoundSide.AT_MOST
    ]
    worst = min(known, key=lambda load: load.margin, default=None)
    return None if worst is None or worst.margin >= 0.0 else worst


def row_of(stations: Stations, row: int) -> Stations:
    """One row of stations."""
    names = [each.name for each in fields(Stations)]
    return Stations(**{name: getattr(stations, name)[row : row + 1] for name in names})


def loads_at(
    place: Stations, bounds: CutBounds, *, feed: float, spindle: float
) -> tuple[LimitLoad, ...]:
    """Loads at one station as a cut of its own has them.

    Parameters
    ----------
    place : Stations
        One row, where the tool cuts.
    feed : float, mm/s
    spindle : float, rev/s
        Magnitude of the spindle speed.
    """
    cut, at = cut_at(place, bounds, feed=feed, spindle=spindle), bounds.at
    if (cut.radial_width if cut.kind is CutKind.GROOVING else cut.depth_share) <= 0.0:
        # A contact that is thinner than the stock map resolves.
        return ()
    limits = (
        *machine_limits(cut, at),
        *tool_limits(cut, at),
        *spindle_limits(cut, at, segment_at(at, spindle)),
        *(holding_limits(cut, at) if bounds.is_held_along else ()),
        *(chuck_limits(cut, at, spindle, spindle) if bounds.is_held_along else ()),
    )
    setting = cut.programmed
    return limit_loads(
        tuple(limit.with_safety(at.safety_factor) for limit in limits),
        (setting.feed, setting.depth, setting.speed),
    )


def cut_at(place: Stations, bounds: CutBounds, *, feed: float, spindle: float) -> Cut:
    """Cut of one station, as programmed there.

    Parameters
    ----------
    place : Stations
        One row, where the tool cuts.
    feed : float, mm/s
    spindle : float, rev/s
    """
    cut, depth = bounds.cut, float(place.axial_depth[0])
    if place.kind[0] == StationKind.DRILLING and cut.kind is CutKind.MILLING:
        cut = cut.as_drill
    elif cut.kind.is_turned:
        cut = replace(cut, diameter=float(place.diameter[0]))
    setting = Setting(
        feed=feed / (cut.tool.teeth * spindle), depth=depth, passes=1, speed=spindle
    )
    cut = replace(cut, programmed=setting, total_depth=depth)
    kienzle = bounds.at.material.kienzle
    met = PathContacts(stations=place, length=np.ones(1), cell=0.0)
    bent = bending(cut, place, kienzle, is_exact=True)
    return with_hardest(cut, met, kienzle, depth=depth, bent=bent)
