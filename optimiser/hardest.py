"""From what the tool meets along its path to the places where it cuts hardest.

The section of the cut is the measure: it is right also where the arc of contact holds slivers
of a floor, or the depth is that of a sliver on a wall. With the depth it gives the width, and
the arc of contact is that of the width: at the angles found where these agree with it, else
one-sided. Depth beyond that of the pass counts as far as the section fills it. Loads are exact
functions of depth and arc that rise with both, so every place is tried that is not within
another, no deeper and its arc a part of the other's: a place that is worst for the mean force
need not be worst for the shank. Units mm, rad.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import cos, pi, sin, sqrt

from optimiser.cut import Cut, CutKind, Place
from optimiser.loads import REFERENCE_FEED
from simulator.motion.segments import Bools, Floats
from simulator.physics import drilling, milling
from simulator.physics.engagement import (
    Engagement,
    full_immersion,
    mean_chip_ratio,
    unidirectional,
)
from simulator.removal.stations import CutKind as StationKind
from simulator.removal.stations import Stations
from simulator.spec import Kienzle, ToolKind

NEARLY = 1e-3
"""relative difference of widths that are equal: what an arc of 1/1000 rad makes"""

AGREES = 0.02
"""of the diameter: width by the angles against width by the section"""

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
    is_judged = met.stations.kind == KINDS[cut.kind]
    is_long = is_judged & (met.length >= met.cell)
    rows = is_long if is_long.any() else is_judged
    if not rows.any():
        return cut
    if cut.kind is CutKind.MILLING:
        places = _places(met.stations, rows, diameter=cut.diameter, nominal=depth)
        return _milled(cut, places, kienzle, nominal=depth)
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
        width = 0.5 * cut.diameter * cut.engagement.cosine_difference
        ratio = mean_chip_ratio(cut.engagement, cutting_edge_angle=tool.cutting_edge_angle)
        return depth * cut.depth_share * width, ratio
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


def _milled(cut: Cut, places: Sequence[Place], kienzle: Kienzle, *, nominal: float) -> Cut:
    """A milling cut with the places of its greatest mean force and of its greatest peak."""
    mean = max(places, key=lambda place: milling.mean_force(kienzle, _at(cut, place)))
    bending = None
    if cut.tool_kind is ToolKind.ENDMILL:
        bending = max(places, key=lambda place: milling.peak_force(kienzle, _at(cut, place)))
        bending = replace(bending, depth_share=_share(cut, bending.depth_share / nominal))
    return replace(
        cut,
        engagement=mean.engagement,
        depth_share=_share(cut, mean.depth_share / nominal),
        bending=bending,
        radial_width=0.5 * cut.diameter * mean.engagement.cosine_difference,
    )


def _at(cut: Cut, place: Place) -> milling.MillingCut:
    """The cut at a place whose depth is in mm."""
    return milling.MillingCut(
        feed_per_tooth=REFERENCE_FEED,
        teeth=cut.tool.teeth,
        axial_depth=place.depth_share,
        engagement=place.engagement,
        cutting_edge_angle=cut.tool.cutting_edge_angle,
    )


def _places(stations: Stations, rows: Bools, *, diameter: float, nominal: float) -> list[Place]:
    """Engagements that occur with their depths in mm, but none that is within another."""
    return _outer([
        _place(row, diameter=diameter, nominal=nominal)
        for row in stations.engagements(rows, digits=DIGITS)
        if row[0] > 0.0
    ])


def _outer(places: Sequence[Place]) -> list[Place]:
    """Places that are not within another one, each once, the deepest first."""
    found: list[Place] = []
    for place in sorted(places, key=lambda each: (-each.depth_share, -_arc(each))):
        if not any(_is_within(place, other) for other in found):
            found.append(place)
    return found


def _arc(place: Place) -> float:
    return place.engagement.contact_angle


def _is_within(place: Place, other: Place) -> bool:
    """Whether the arc of a place that is no deeper is a part of another's."""
    inner, outer = place.engagement, other.engagement
    return outer.entry_angle <= inner.entry_angle and inner.exit_angle <= outer.exit_angle


def _place(row: Sequence[float], *, diameter: float, nominal: float) -> Place:
    """One engagement; a section wider than the tool is deeper than it was seen to be."""
    section, depth, entry, exit = row
    by_angles = 0.5 * diameter * (cos(entry) - cos(exit))
    if depth > nominal and by_angles > 0.0:
        depth = min(depth, max(nominal, section / by_angles))
    depth = max(depth, section / diameter)
    width = section / depth
    if width >= diameter * (1.0 - NEARLY):
        engagement = full_immersion()
    elif abs(by_angles - width) <= AGREES * diameter and 0.0 <= entry < exit <= pi:
        engagement = Engagement(entry_angle=entry, exit_angle=exit)
    else:
        engagement = unidirectional(width, diameter)
    return Place(engagement=engagement, depth_share=depth)
