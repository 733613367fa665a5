"""Stations of a path: one row each, whatever the process.

``section`` is the volume removed per length of path, so that the removal rate is section times
the speed along the path, and ``chip_ratio`` is the mean chip thickness over the feed per tooth:
with the two, force and power need not know whether the cut is milling, drilling or turning.
"""

from dataclasses import dataclass, fields
from enum import IntEnum
from math import pi

import numpy as np

from simulator.motion.segments import Floats, Ints

WALL = 0.1
"""rad from φ = 0 or π within which an arc of contact reaches the wall: 0.5 % of the radius"""

SINGLE = 0.02
"""of the section, within which an arc is the only one"""

THICKEST = 2.3311
"""rad, length of the arc at a wall whose mean chip is greatest: tan(β/2) = β"""

HALVINGS = 32


class StationKind(IntEnum):
    """Process at a station."""

    AIR = 0
    MILLING = 1
    DRILLING = 2
    TURNING = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stations:
    """M stations, ascending along the path; each holds for the stretch before it.

    The first station of a segment holds from the segment's start, each other one from the
    station before it; the last lies on the segment's end. Segments that remove nothing have
    one row of kind AIR at their end.
    """

    segment: Ints
    """Segment, (M,) row of the segment"""
    station: Floats
    """Station, (M,) mm along that segment: the end of the stretch"""
    kind: Ints
    """Kind, (M,) :class:`StationKind`"""
    section: Floats
    """Section, (M,) mm², volume removed per mm of path"""
    growth: Floats
    """(M,) mm² by which the section grows from the beginning of the stretch to its end"""
    axial_depth: Floats
    """Axial depth, (M,) mm, a_p; in turning the depth of cut; 0 in air"""
    radial_width: Floats
    """(M,) mm, a_e: section over axial depth in milling; of a lip or an insert elsewhere"""
    entry_angle: Floats
    """Entry angle, (M,) rad, φ_st of the arc that holds all contact; milling only"""
    exit_angle: Floats
    """Exit angle, (M,) rad, φ_ex"""
    contact_angle: Floats
    """(M,) rad of contact, all arcs together; φ_ex − φ_st when there is one arc"""
    chip_ratio: Floats
    """Chip ratio, (M,) mean chip thickness over feed per tooth"""
    diameter: Floats
    """(M,) mm at which the cutting speed drives the force: of the cutter where it cuts, of
    the middle of a lip, of the workpiece in the middle of the cut"""

    def __post_init__(self) -> None:
        count = len(self.segment)
        for field in fields(self):
            if getattr(self, field.name).shape != (count,):
                raise ValueError(f"{field.name} must have shape {(count,)}")

    @property
    def peak_section(self) -> Floats:
        """(M,) mm², greatest section of each stretch: what angles, depth and chip belong to."""
        peak: Floats = self.section + 0.5 * np.abs(self.growth)
        return peak

    def __len__(self) -> int:
        return len(self.segment)


def stretch_lengths(stations: Stations) -> Floats:
    """(M,) mm, the stretch for which each station holds."""
    before = stations.station.copy()
    before[1:] = stations.station[:-1]
    before[:1] = 0.0
    before[1:][stations.segment[1:] != stations.segment[:-1]] = 0.0
    stretch: Floats = stations.station - before
    return stretch


def air(segments: Ints, length: Floats) -> Stations:
    """Stations of segments that remove nothing.

    Parameters
    ----------
    segments : (M,) array of int
        Their rows.
    length : (M,) array, mm
        Their lengths.
    """
    nothing = np.zeros(len(segments))
    return Stations(
        segment=segments,
        station=length,
        kind=np.full(len(segments), int(StationKind.AIR)),
        section=nothing,
        growth=nothing,
        axial_depth=nothing,
        radial_width=nothing,
        entry_angle=nothing,
        exit_angle=nothing,
        contact_angle=nothing,
        chip_ratio=nothing,
        diameter=nothing,
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SingleArcs:
    """One arc of contact for each station, with the section and the mean chip that were met."""

    entry_angle: Floats
    """Entry angle, (M,) rad"""
    exit_angle: Floats
    """Exit angle, (M,) rad; the entry angle in air"""
    depth: Floats
    """Depth, (M,) mm, at most the axial depth"""
    fill: Floats
    """Fill, (M,) section over that of arc and depth, 1 where both are met; 0 in air"""


def single_arcs(stations: Stations) -> SingleArcs:
    """One arc for each station that mills.

    The arc of a station holds all contact, also slivers of a floor or of a wall high above. Of
    what was seen in several arcs the mean chip tells how long one of them would be: at the wall
    that it reaches, else about the middle. The section then tells its depth. All is that of the
    place of the stretch where the section is greatest.
    """
    entry, exit_ = stations.entry_angle.copy(), stations.exit_angle.copy()
    section = stations.peak_section
    cuts = (section > 0.0) & (exit_ > entry)
    radius = 0.5 * stations.diameter
    seen = radius * stations.axial_depth * (np.cos(entry) - np.cos(exit_))
    is_several = cuts & (np.abs(seen - section) > SINGLE * seen)
    at = np.flatnonzero(is_several)
    if len(at):
        least = section[at] / (radius * stations.axial_depth)[at]
        entry[at], exit_[at] = _of_mean_chip(
            entry[at], exit_[at], stations.chip_ratio[at], least=least
        )
    swept = radius * (np.cos(entry) - np.cos(exit_))
    known = np.where(cuts, swept, 1.0)
    depth = np.where(cuts, np.minimum(stations.axial_depth, section / known), 0.0)
    is_deep = depth > 0.0
    return SingleArcs(
        entry_angle=np.where(is_deep, entry, 0.0),
        exit_angle=np.where(is_deep, exit_, 0.0),
        depth=depth,
        fill=np.where(is_deep, section / np.where(is_deep, known * depth, 1.0), 0.0),
    )


def _of_mean_chip(
    entry: Floats, exit_: Floats, ratio: Floats, *, least: Floats
) -> tuple[Floats, Floats]:
    """Arcs within others whose mean chip over the feed per tooth is given, or these others.

    The mean chip of an arc at a wall grows with its length up to 2.33 rad; that of an arc about
    a middle falls. No arc has a smaller ``cos φ_st − cos φ_ex`` than the least: with it the
    section takes the whole depth.
    """
    whole = exit_ - entry
    is_down, is_up = exit_ >= pi - WALL, entry <= WALL
    is_walled = is_down | is_up
    middle = 0.5 * (entry + exit_)
    low = np.full(len(whole), 1e-6)
    high = np.where(is_walled, np.minimum(whole, THICKEST), whole)
    for _ in range(HALVINGS):
        length = 0.5 * (low + high)
        walled = (1.0 - np.cos(length)) / length
        centred = 2.0 * np.sin(middle) * np.sin(0.5 * length) / length
        is_short = np.where(is_walled, walled < ratio, centred > ratio)
        low, high = np.where(is_short, length, low), np.where(is_short, high, length)
    walled = np.arccos(1.0 - np.minimum(least, 2.0))
    centred = 2.0 * np.arcsin(np.minimum(0.5 * least / np.sin(middle), 1.0))
    high = np.minimum(np.maximum(high, np.where(is_walled, walled, centred)), whole)
    start = np.where(is_down, pi - high, np.where(is_up, 0.0, middle - 0.5 * high))
    return start, start + high
