"""Stations along a path: one row each, for every machining process.

``section`` is the volume removed per length of path, so that the removal rate is section times
the speed along the path. ``chip_ratio`` is the mean chip thickness over the feed per tooth.
From the two, force and power follow in the same way for milling, drilling and turning.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields
from enum import IntEnum
from functools import cached_property
from math import pi

import numpy as np

from simulator.motion.segments import Bools, Floats, Ints

WALL = 0.1
"""Angle, rad, from φ = 0 or π within which a contact arc counts as reaching the wall; this is
0.5 % of the radius."""

SINGLE = 0.02
"""Relative difference of the section below which an arc counts as the only one."""

THICKEST = 2.3311
"""Length, rad, of the arc at a wall with the greatest mean chip: tan(β/2) = β."""

HALVINGS = 32


class StationKind(IntEnum):
    """Machining process at a station."""

    AIR = 0
    MILLING = 1
    DRILLING = 2
    TURNING = 3


@dataclass(frozen=True, kw_only=True, eq=False)
class Stations:
    """Process and engagement at M stations, ascending along the path.

    Each station describes the stretch before it. The first station of a segment describes the
    stretch from the segment's start, each other one the stretch from the previous station; the
    last lies on the segment's end. Segments that remove nothing have one row of kind AIR at
    their end.
    """

    segment: Ints
    """Index of the segment on which the station lies, (M,)."""
    station: Floats
    """Position of the station along its segment, (M,), mm: the end of the stretch."""
    kind: Ints
    """Process at the station, (M,), as :class:`StationKind`."""
    section: Floats
    """Volume removed per mm of path, (M,), mm²."""
    growth: Floats
    """Increase of the section from the beginning to the end of the stretch, (M,), mm²."""
    axial_depth: Floats
    """Axial depth of cut a_p, (M,), mm; in turning the depth of cut; 0 in air."""
    radial_width: Floats
    """Radial width of cut a_e, (M,), mm: section over axial depth in milling; in drilling and
    turning the width cut by a lip or an insert."""
    entry_angle: Floats
    """Entry angle φ_st of the arc that includes all contact, (M,), rad; milling only."""
    exit_angle: Floats
    """Exit angle φ_ex of the arc that includes all contact, (M,), rad; milling only."""
    contact_angle: Floats
    """Total contact angle of all arcs, (M,), rad; φ_ex − φ_st for a single arc."""
    chip_ratio: Floats
    """Mean chip thickness over feed per tooth, (M,)."""
    diameter: Floats
    """Diameter for cutting speed and force, (M,), mm: of the cutter where it cuts, of the
    middle of a drill lip, or of the workpiece in the middle of the turning cut."""

    def __post_init__(self) -> None:
        count = len(self.segment)
        for field in fields(self):
            if getattr(self, field.name).shape != (count,):
                raise ValueError(f"{field.name} must have shape {(count,)}")

    @property
    def peak_section(self) -> Floats:
        """Greatest section in each stretch, (M,), mm²; angles, depth and chip refer to it."""
        peak: Floats = self.section + 0.5 * np.abs(self.growth)
        return peak

    @cached_property
    def arcs(self) -> "SingleArcs":
        """Single arc per station, equivalent to its contact; worked out once."""
        return single_arcs(self)

    def __len__(self) -> int:
        return len(self.segment)


def stretch_lengths(stations: Stations) -> Floats:
    """Length of the stretch described by each station, (M,), mm."""
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
        Indices of the segments.
    length : (M,) array, mm
        Lengths of the segments.
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
    """Single contact arc per station, equivalent in section and mean chip thickness."""

    entry_angle: Floats
    """Entry angle, (M,), rad."""
    exit_angle: Floats
    """Exit angle, (M,), rad; equal to the entry angle in air."""
    depth: Floats
    """Depth of the arc, (M,), mm, at most the axial depth of cut."""
    fill: Floats
    """Section over that swept by arc and depth, (M,); 1 if both are matched, 0 in air."""


def single_arcs(stations: Stations) -> SingleArcs:
    """Replace the contact of each milling station by one equivalent arc.

    The arc stored in a station spans all contact, including slivers of a floor or of a wall
    high above. Where the contact has several arcs, the mean chip gives the length of one
    equivalent arc: at the wall that the contact reaches, otherwise about its middle. Its depth
    follows from the section. All values refer to the point of the stretch with the greatest
    section.
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
    """Shorten arcs until they have a given mean chip ratio; keep arcs that cannot match it.

    The mean chip of an arc at a wall grows with its length up to 2.33 rad; that of an arc about
    a middle falls. ``cos φ_st − cos φ_ex`` of a shortened arc is at least ``least``, at which
    the section takes the whole depth.
    """
    whole = exit_ - entry
    is_down, is_up = exit_ >= pi - WALL, entry <= WALL
    is_walled = is_down | is_up
    middle = 0.5 * (entry + exit_)
    high, at, beside = np.empty(len(whole)), is_walled, ~is_walled
    sine = 2.0 * np.sin(middle[beside])
    high[at] = _halved(
        np.minimum(whole[at], THICKEST),
        lambda length: (1.0 - np.cos(length)) / length < ratio[at],
    )
    high[beside] = _halved(
        whole[beside], lambda length: sine * np.sin(0.5 * length) / length > ratio[beside]
    )
    walled = np.arccos(1.0 - np.minimum(least, 2.0))
    centred = 2.0 * np.arcsin(np.minimum(0.5 * least / np.sin(middle), 1.0))
    high = np.minimum(np.maximum(high, np.where(is_walled, walled, centred)), whole)
    start = np.where(is_down, pi - high, np.where(is_up, 0.0, middle - 0.5 * high))
    return start, start + high


def _halved(longest: Floats, is_short: Callable[[Floats], Bools]) -> Floats:
    """Lengths of arcs, (M,), rad, by bisection up to the longest."""
    low, high = np.full(len(longest), 1e-6), longest
    for _ in range(HALVINGS):
        length = 0.5 * (low + high)
        is_longer = is_short(length)
        low, high = np.where(is_longer, length, low), np.where(is_longer, high, length)
    return high
