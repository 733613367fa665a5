"""Engagement of a mill that goes down into the material: straight, or on a slant.

A way down that the path makes itself may run at a feed of its own
(:class:`PlungeEngagement`). A way down that the file draws runs as the file says, at the feed
of the cut, so what it takes holds for the whole cut (:func:`plunge_of`).

Straight down the mill cuts as a drill does, with lips square to its axis, in the section that
was met. On a ramp, a helix or a zigzag it mills as along a pass. Units mm.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from optimiser.cut import Cut, CutKind, PlungeEngagement
from optimiser.hardest import Bending, PathContacts, bending, with_hardest
from simulator.motion.segments import Bools, Floats, Ints, Segments
from simulator.motion.tool_path import ToolPathRun, follows, plunges
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Kienzle
from stepnc_model.entities.entity import Entity
from stepnc_model.part21.values import Ref

CORE = 0.25
"""of the radius; what does not reach so far in is planed off at the side, not drilled"""

TINY = 1e-9
"""mm; a shorter move is none"""

LEAST_SHARE = 0.02
"""of the tool's section, over a stretch that begins above the material; less is a sliver"""


def is_fed(run: ToolPathRun, technology: Ref[Entity], cut: Cut) -> Bools:
    """(N,) which segments run at the feed of the cut, and none of its own."""
    bound = follows(run, technology)
    return bound if cut.way_in is None else bound & ~plunges(run)


def plunge_feed_of(run: ToolPathRun, cut: Cut) -> float:
    """Feed per tooth on the ways down as the file has it, mm."""
    own = [move.feed.per_revolution for move in run.moves if move.feed and move.feed.is_plunge]
    per_turn = own[0] if own else None
    return cut.programmed.feed if per_turn is None else per_turn / cut.tool.teeth


def along_passes(run: ToolPathRun, met: PathContacts) -> PathContacts:
    """Contacts without those on ways down that may have a feed of their own."""
    down = plunges(run)
    return met.where(~down[met.stations.segment]) if down.any() else met


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlungeCuts:
    """Milling contacts on ways down that may have a feed of their own."""

    met: PathContacts
    bent: Bending
    """by that"""


def down_ramps(
    cut: Cut, run: ToolPathRun, met: PathContacts, kienzle: Kienzle
) -> PlungeCuts | None:
    """Milling contacts on the ramps of a path; None: there are none."""
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
    """Engagement on ways down that may have a feed of their own; None where there is none.

    Parameters
    ----------
    cut : Cut
    met : PathContacts
        What its path met.
    run : ToolPathRun
        Of its path.
    slope : PlungeCuts or None
        Of :func:`down_ramps`.
    kienzle : Kienzle
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
        # What a ramp meets follows from its path, and a path of other passes is met anew.
        as_met = replace(cut.bare, is_depth_free=False)
        ramp = with_hardest(as_met, slope.met, kienzle, depth=depth, bent=slope.bent)
        sine = float(_sine(run.segments)[slope.met.stations.segment].max())
    return PlungeEngagement(
        drilled=tuple(_drilled(cut, stations, row) for row in _hardest(stations, straight)),
        ramp=ramp,
        sine=sine,
        reaches_axis=bool(_is_core(cut, stations)[straight].any()),
    )


def _hardest(stations: Stations, rows: Ints) -> list[int]:
    """Stations straight down with the greatest power, and the greatest thrust."""
    if not len(rows):
        return []
    section = stations.peak_section[rows]
    found = (section.argmax(), (section / stations.diameter[rows]).argmax())
    return sorted({int(rows[at]) for at in found})


def _drilled(cut: Cut, stations: Stations, row: int) -> Cut:
    """One station straight down as a hole, of which only a part need be met."""
    width, middle = float(stations.axial_depth[row]), float(stations.diameter[row])
    outer, inner = middle + width, max(0.0, middle - width)
    return replace(
        cut.as_drill,
        diameter=outer,
        previous_diameter=inner,
        fill=float(stations.peak_section[row]) / (0.25 * pi * (outer**2 - inner**2)),
    )


def _sine(segments: Segments) -> Floats:
    """(N,) height that each segment loses over its length."""
    drop = segments.start[:, 2] - segments.end[:, 2]
    fall: Floats = drop / np.maximum(segments.length, TINY)
    return fall


def _is_core(cut: Cut, stations: Stations) -> Bools:
    """(M,) whether stations straight down meet material near the axis, and not a sliver."""
    # A lip's width is its axial depth here, and twice the radius of its middle the diameter.
    inner = stations.diameter - stations.axial_depth
    is_thick = stations.section >= LEAST_SHARE * 0.25 * pi * cut.diameter**2
    core: Bools = is_thick & (inner <= CORE * cut.diameter)
    return core


def plunge_of(cut: Cut, met: PathContacts, is_bound: Bools) -> Cut | None:
    """The hardest plunge of a milling cut, as a drill would make it; None where there is none.

    Parameters
    ----------
    cut : Cut
    met : PathContacts
        What its path met.
    is_bound : (N,) array
        Which segments of the path run at the feed of the cut.
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
