"""Engagement of a mill that goes down into the material: straight, or on a slope.

A way down that the path generator adds may have a feed of its own
(:class:`PlungeEngagement`). A way down that the file defines runs at the feed of the cut, so
its loads limit the whole cut (:func:`plunge_of`).

Straight down the mill cuts as a drill does, with lips square to its axis, in the section that
was met. On a ramp, a helix or a zigzag it mills as along a pass. Units: mm.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from optimiser.cuts.cut import Cut, CutKind, PlungeEngagement
from optimiser.cuts.hardest_places import Bending, PathContacts, bending, with_hardest
from simulator.motion.segments import Bools, Floats, Ints, Segments
from simulator.motion.tool_path import ToolPathRun, follows, plunges
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Kienzle
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref

CORE = 0.25
"""Share of the radius that contact must reach inwards to count as drilling."""

TINY = 1e-9
"""Least length of a move, mm, to avoid division by zero."""

LEAST_SHARE = 0.02
"""Share of the tool's section below which removed material is only a sliver."""


def is_fed(run: ToolPathRun, technology: Ref[Entity], cut: Cut) -> Bools:
    """Segments that run at the feed of the cut rather than a feed of their own, (N,)."""
    bound = follows(run, technology)
    return bound if cut.way_in is None else bound & ~plunges(run)


def plunge_feed_of(run: ToolPathRun, cut: Cut) -> float:
    """Feed per tooth on the ways down as programmed, mm."""
    own = [move.feed.per_revolution for move in run.moves if move.feed and move.feed.is_plunge]
    per_turn = own[0] if own else None
    return cut.programmed.feed if per_turn is None else per_turn / cut.tool.teeth


def along_passes(run: ToolPathRun, met: PathContacts) -> PathContacts:
    """Contacts without those on ways down that may have a feed of their own."""
    down = plunges(run)
    return met.where(~down[met.stations.segment]) if down.any() else met


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlungeCuts:
    """Milling contacts on ramps that may have a feed of their own."""

    met: PathContacts
    bent: Bending
    """Bending forces of an end mill at these contacts."""


def down_ramps(
    cut: Cut, run: ToolPathRun, met: PathContacts, kienzle: Kienzle
) -> PlungeCuts | None:
    """Milling contacts on the ramps of a path; None without ramps."""
    stations = met.stations
    rows = plunges(run)[stations.segment] & (stations.kind == StationKind.MILLING)
    if not rows.any():
        return None
    down = met.where(rows)
    return PlungeCuts(met=down, bent=bending(cut, down.stations, kienzle))


def way_in_of(
    cut: Cut,
    met: PathContacts,
    run: ToolPathRun,
    *,
    slope: PlungeCuts | None,
    kienzle: Kienzle,
    depth: float,
) -> PlungeEngagement | None:
    """Engagement on ways down that may have a feed of their own; None without any.

    Parameters
    ----------
    met : PathContacts
        Contacts along the path.
    run : ToolPathRun
        Run of the path.
    slope : PlungeCuts or None
        Result of :func:`down_ramps`.
    depth : float, mm
        Nominal depth of one pass.
    """
    stations = met.stations
    rows = plunges(run)[stations.segment] & (stations.kind == StationKind.DRILLING)
    straight = np.flatnonzero(rows)
    if cut.kind is not CutKind.MILLING or (slope is None and not len(straight)):
        return None
    ramp, sine = None, 0.0
    if slope is not None:
        # The ramp follows from its path; a path with other passes is tried anew.
        as_met = replace(cut.bare, is_depth_free=False)
        ramp = with_hardest(as_met, slope.met, kienzle, depth=depth, bent=slope.bent)
        sine = float(_sine(run.segments)[slope.met.stations.segment].max())
    return PlungeEngagement(
        drilled=tuple(_drilled(cut, stations, row) for row in _hardest(stations, straight)),
        ramp=ramp,
        sine=sine,
        reaches_axis=bool(is_core(stations, cut.diameter)[straight].any()),
    )


def _hardest(stations: Stations, rows: Ints) -> list[int]:
    """Rows of the straight plunges with the greatest power and the greatest thrust."""
    if not len(rows):
        return []
    section = stations.peak_section[rows]
    found = (section.argmax(), (section / stations.diameter[rows]).argmax())
    return sorted({int(rows[at]) for at in found})


def _drilled(cut: Cut, stations: Stations, row: int) -> Cut:
    """Model one straight plunge as drilling a hole of which only a part may be met."""
    width, middle = float(stations.axial_depth[row]), float(stations.diameter[row])
    outer, inner = middle + width, max(0.0, middle - width)
    return replace(
        cut.as_drill,
        diameter=outer,
        previous_diameter=inner,
        fill=float(stations.peak_section[row]) / (0.25 * pi * (outer**2 - inner**2)),
    )


def _sine(segments: Segments) -> Floats:
    """Descent of each segment over its length, (N,)."""
    drop = segments.start[:, 2] - segments.end[:, 2]
    fall: Floats = drop / np.maximum(segments.length, TINY)
    return fall


def is_core(stations: Stations, diameter: float) -> Bools:
    """True if straight plunges meet material near the axis, and not only a sliver, (M,)."""
    # Here the axial depth is the width of a lip, and the diameter twice its mid-radius.
    inner = stations.diameter - stations.axial_depth
    is_thick = stations.section >= LEAST_SHARE * 0.25 * pi * diameter**2
    core: Bools = is_thick & (inner <= CORE * diameter)
    return core


def plunge_of(cut: Cut, met: PathContacts, is_bound: Bools) -> Cut | None:
    """Hardest straight plunge of a milling cut modelled as drilling; None without one.

    Parameters
    ----------
    met : PathContacts
        Contacts along the path.
    is_bound : (N,) array
        Segments of the path that run at the feed of the cut.
    """
    if cut.kind is not CutKind.MILLING:
        return None
    stations = met.stations
    rows = (stations.kind == StationKind.DRILLING) & is_bound[stations.segment]
    rows &= stations.section >= LEAST_SHARE * 0.25 * pi * cut.diameter**2
    inner = (stations.diameter - stations.axial_depth)[rows]
    if not (inner <= CORE * cut.diameter).any():
        return None
    return replace(cut.as_drill, previous_diameter=max(0.0, float(inner.min())))
