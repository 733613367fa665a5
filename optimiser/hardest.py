"""From what the tool meets along its path to the places where it cuts hardest.

Loads are those of the virtual machine: the mean force follows from the section of the cut and
the mean chip, forces along the helix from the arc of contact, and from the depth that the
section fills there. Every station is tried: a place that is worst for the mean force need not
be worst for the shank. Units mm, rad.
"""

from dataclasses import dataclass, replace
from math import pi, sin, sqrt

import numpy as np

from optimiser.cut import Cut, CutKind, Place
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics import drilling
from simulator.physics.engagement import Engagement
from simulator.physics.flutes import Law
from simulator.physics.tooth_forces import Places, peak_resultant, wall_force
from simulator.removal.stations import CutKind as StationKind
from simulator.removal.stations import Stations, single_arcs
from simulator.spec import Kienzle, ToolKind

LEAST_RATIO = 0.01
"""mean chip over the feed; the power of what is thinner is not to be told"""

DIGITS = 3
"""to which engagements are told apart: µm, mrad"""

KINDS = {
    CutKind.MILLING: StationKind.MILLING,
    CutKind.TURNING: StationKind.TURNING,
    CutKind.GROOVING: StationKind.TURNING,
    CutKind.DRILLING: StationKind.DRILLING,
}
"""which stations an operation is judged by; plunges of a mill are in :mod:`optimiser.plunge`"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Met:
    """What the tool met along a path."""

    stations: Stations
    length: Floats
    """(M,) mm, stretch for which each station holds"""
    cell: float
    """mm: sections of shorter stretches are noise"""

    @property
    def volume(self) -> float:
        """Removed, mm³."""
        return float((self.stations.section * self.length).sum())


def lengths(stations: Stations) -> Floats:
    """(M,) mm, the stretch for which each station holds."""
    before = stations.station.copy()
    before[1:] = stations.station[:-1]
    before[:1] = 0.0
    before[1:][stations.segment[1:] != stations.segment[:-1]] = 0.0
    stretch: Floats = stations.station - before
    return stretch


def with_hardest(cut: Cut, met: Met, kienzle: Kienzle, *, depth: float) -> Cut:
    """A cut with its engagement as met in passes of a nominal depth, where anything was met."""
    rows = met.stations.kind == KINDS[cut.kind]
    if cut.kind is not CutKind.MILLING:
        is_long = rows & (met.length >= met.cell)
        rows = is_long if is_long.any() else rows
    if not rows.any():
        return cut
    if cut.kind is CutKind.MILLING:
        return _milled(cut, met, rows, kienzle, nominal=depth)
    if cut.kind is CutKind.DRILLING:
        return _drilled(cut, float(met.stations.section[rows].max()), met.cell)
    deepest = float(met.stations.axial_depth[rows].max())
    if cut.kind is CutKind.GROOVING:
        return replace(cut, radial_width=min(cut.radial_width, deepest))
    return replace(cut, depth_share=_share(cut, deepest / depth))


def weighted_volume(met: Met, exponent: float) -> float:
    """``Σ V·χ^(−m)``: what the energy of the cut is in proportion to; χ is the chip ratio."""
    rows = met.stations.section > 0.0
    volume = met.stations.section[rows] * met.length[rows]
    ratio = met.stations.chip_ratio[rows].clip(LEAST_RATIO)
    return float((volume * ratio**-exponent).sum())


def greatest_section(cut: Cut, *, depth: float) -> tuple[float, float]:
    """Section of the hardest place in mm² in passes of a nominal depth, and its chip ratio."""
    tool = cut.tool
    if cut.kind is CutKind.MILLING:
        if cut.engagement is None:
            raise ValueError("a milling cut needs its engagement")
        width = 0.5 * cut.diameter * cut.engagement.cosine_difference * cut.fill
        return depth * cut.depth_share * width, cut.mean_chip_ratio
    if cut.kind is CutKind.DRILLING:
        point = 0.5 * tool.point_angle if tool.point_angle else drilling.CUSTOMARY_EDGE_ANGLE
        return 0.25 * pi * (cut.diameter**2 - cut.previous_diameter**2), sin(point)
    if cut.kind is CutKind.GROOVING:
        return pi * cut.diameter * cut.radial_width, 1.0
    return pi * cut.diameter * depth * cut.depth_share, sin(tool.cutting_edge_angle)


def _share(cut: Cut, share: float) -> float:
    """Real depth over the nominal one; at least 1 where another depth may be chosen.

    A pass may have found less material than its depth because there was no more: another
    depth would not.
    """
    return max(1.0, share) if cut.is_depth_free else share


def _drilled(cut: Cut, section: float, cell: float) -> Cut:
    """A hole with what was there before, unless the map cannot tell it from what is said."""
    said, _ = greatest_section(cut, depth=cut.programmed.depth)
    if abs(section - said) <= 0.5 * pi * cut.diameter * cell:
        return cut
    bored = sqrt(max(0.0, cut.diameter**2 - 4.0 * section / pi))
    return replace(cut, previous_diameter=bored)


def _milled(cut: Cut, met: Met, rows: Bools, kienzle: Kienzle, *, nominal: float) -> Cut:
    """A milling cut with the places of its greatest forces: mean, across it, at the wall."""
    stations = met.stations
    at = np.flatnonzero(rows & (stations.exit_angle > stations.entry_angle))
    if not len(at):
        return cut
    arcs = single_arcs(stations)
    mean = stations.section[at] * stations.chip_ratio[at].clip(LEAST_RATIO) ** -kienzle.m_c
    hardest = at[(mean / stations.diameter[at]).argmax()]

    def place(row: np.int64) -> Place:
        return Place(
            engagement=Engagement(
                entry_angle=max(float(arcs.entry_angle[row]), 0.0),
                exit_angle=min(float(arcs.exit_angle[row]), pi),
            ),
            depth_share=_share(cut, float(arcs.depth[row]) / nominal),
            fill=float(arcs.fill[row]),
        )

    shank = wall = None
    if cut.tool_kind is ToolKind.ENDMILL:
        shank, wall = map(place, _bent_most(cut, stations, at, kienzle))
    greatest = place(hardest)
    return replace(
        cut,
        engagement=greatest.engagement,
        depth_share=greatest.depth_share,
        fill=greatest.fill,
        chip_ratio=max(float(stations.chip_ratio[hardest]), LEAST_RATIO),
        shank=shank,
        wall=wall,
        radial_width=0.5 * cut.diameter * greatest.engagement.cosine_difference * greatest.fill,
    )


def _bent_most(
    cut: Cut, stations: Stations, at: Ints, kienzle: Kienzle
) -> tuple[np.int64, np.int64]:
    """Stations at which an end mill is bent most, and most while it makes a wall."""
    arcs = single_arcs(stations)
    columns = (arcs.entry_angle, arcs.exit_angle, arcs.depth, arcs.fill)
    keys = np.round(np.stack([column[at] for column in columns]), DIGITS)
    told, first = np.unique(keys, axis=1, return_index=True)
    places = Places(entry_angle=told[0], exit_angle=told[1], axial_depth=told[2])
    law = Law(exponent=1.0 - kienzle.m_c)
    shank = told[3] * peak_resultant(cut.edges, places, law)
    wall = told[3] * wall_force(cut.edges, places, law)
    return at[first[shank.argmax()]], at[first[wall.argmax()]]
