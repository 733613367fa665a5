"""Greatest feed at each station of a path, with the name of the limit that gives it.

Each limit is inverted into a feed per tooth: a Kienzle force grows with ``f^(1−m)``, so the
feed at a bound is ``(bound/load)^(1/(1−m))``. The loads are those of the virtual machine at
the station's own engagement: mean force and power from section and mean chip, forces along the
helix from the contact arc. They are written apart from the virtual machine, which judges them.

Units: mm, mm/s, rev/s, N, W, N·mm.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from math import inf, pi

import numpy as np

from optimiser.along_path.holding_limits import held_feeds
from optimiser.bounds.chip_load import GREATEST_THINNING, catalogue_feed
from optimiser.bounds.limits import drill_point, force_factor, is_bent
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.hardest_places import LEAST_RATIO, bending, chip_sines, width_ratios
from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics.drilling import chisel_factors, constant_thrust
from simulator.physics.engagement import conventional
from simulator.physics.spindle import curve_segments
from simulator.physics.strength import end_mill
from simulator.removal.stations import StationKind, Stations
from simulator.tool_windows import DrillPoint, FeedWindow
from stepnc_model.units import NMM_S_PER_WATT

RAMP = 0.01
"""Sine of the descent above which a path with chips counts as a ramp."""


class CapName(StrEnum):
    """Names of what bounds the feed at a place of the path."""

    MOTOR_POWER = "motor_power"
    SPINDLE_TORQUE = "spindle_torque"
    CUTTING_FORCE = "cutting_force"
    TOOL_DEFLECTION = "tool_deflection"
    SHANK_STRENGTH = "shank_strength"
    CHIP_THICKNESS = "chip_thickness"
    FEED_PER_TOOTH = "feed_per_tooth"
    ROUGHNESS = "roughness"
    HOLDING = "work_holding"
    PLUNGE = "plunge_feed"
    ENTRY = "entry"
    FEED_MECHANISM = "feed_mechanism"
    AXIS_SPEED = "axis_speed"
    BLOCK_TIME = "block_time"
    CURVATURE = "curvature"
    CORNER = "corner"
    AIR = "air_feed"
    LOCKED = "locked"
    LEAST = "least_feed"
    RISE = "greatest_rise"
    STRAIGHT = "straight_plunge"
    NO_STOCK = "no_stock_met"
    SHOULDER = "depth_at_a_shoulder"
    GUESSED = "guessed_values"
    AS_PROGRAMMED = "as_programmed"

    @property
    def words(self) -> str:
        """Name in words, without underscores."""
        return self.value.replace("_", " ")


NAMES: tuple[CapName, ...] = tuple(CapName)
"""All names in the order of their numbers."""

NUMBER: dict[CapName, int] = {name: number for number, name in enumerate(NAMES)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Caps:
    """Greatest feed of each row, with the number of the limit that gives it."""

    feed: Floats
    """Greatest feed, (M,), mm/s; infinite where nothing limits it."""
    name: Ints
    """Number in :data:`NAMES` of the limit, (M,)."""

    def least(self, other: "Caps") -> "Caps":
        """Lesser cap of each row."""
        is_less = other.feed < self.feed
        return Caps(
            feed=np.where(is_less, other.feed, self.feed),
            name=np.where(is_less, other.name, self.name),
        )

    def at(self, rows: Ints | Bools | slice) -> "Caps":
        """Caps of the selected rows."""
        return Caps(feed=self.feed[rows], name=self.name[rows])


def unbounded(count: int, name: CapName = CapName.AIR) -> Caps:
    """Caps that limit nothing."""
    return Caps(feed=np.full(count, inf), name=np.full(count, NUMBER[name]))


def capped(feed: Floats, name: CapName) -> Caps:
    """Caps of one limit."""
    return Caps(feed=feed, name=np.full(len(feed), NUMBER[name]))


@dataclass(frozen=True, slots=True, kw_only=True)
class CutBounds:
    """Tool, conditions and permitted feeds of one part of a path."""

    cut: Cut
    at: CuttingConditions
    fixed: tuple[tuple[CapName, float], ...] = ()
    """Greatest feeds per tooth that hold wherever there are chips, mm."""
    plunge: float | None = None
    """Greatest feed per tooth on the way down into the material, mm; None: not limited."""
    is_held_along: bool = False
    """Whether the work-holding of the conditions is looked at at each place."""
    least: float = 0.0
    """Feed that the user permits everywhere, mm/s, whatever the limits of the process say."""
    deepest: float | None = None
    """Depth of a turning tool beyond which the programmed feed stays, mm; None: any depth."""
    keeps_programmed: bool = False
    """Whether no feed in the material may rise, because no source says how far."""
    plausible: "tuple[CutBounds, ...]" = ()
    """Bounds for other values of what is guessed about the tool: a feed rises only as far as
    all permit, and falls only where none permits the programmed one."""
    is_stock_guessed: bool = False
    """Whether the stock is guessed: no feed falls for it, and none rises where nothing is
    met."""

    @property
    def is_guessed(self) -> bool:
        """True if anything about the cut is guessed."""
        return self.is_stock_guessed or bool(self.plausible)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class StationCaps:
    """Caps of the stations of a path."""

    caps: Caps
    """All process limits, (M,); infinite in air."""
    chip: Floats
    """Feed at the greatest permitted chip alone, (M,), mm/s; infinite where not limited."""

    most: Floats
    """Greatest of the caps for all values of what is guessed, (M,), mm/s."""
    floor: Floats | None = None
    """Feed below which no cap goes, as it rests on a guess, (M,), mm/s; None: any."""

    def least(self, other: "StationCaps") -> "StationCaps":
        """Lesser caps of each station, for two values of what is guessed."""
        return StationCaps(
            caps=self.caps.least(other.caps),
            chip=np.minimum(self.chip, other.chip),
            most=np.maximum(self.most, other.most),
        )


def station_caps(
    stations: Stations, bounds: CutBounds, *, spindle: Floats, descent: Floats
) -> StationCaps:
    """Process limits on the feed at each station.

    Parameters
    ----------
    stations : Stations
        M stations of one tool.
    spindle : (M,) array, rev/s
        Magnitude of the spindle speed; where it is 0 nothing is limited.
    descent : (M,) array
        Sine of the angle at which the path goes down; negative up.

    Returns
    -------
    StationCaps
    """
    per_tooth = bounds.cut.tool.teeth * spindle
    cuts = (stations.peak_section > 0.0) & (spindle > 0.0)
    found = unbounded(len(stations))
    chip = np.full(len(stations), inf)
    for name, feed in _feeds_per_tooth(stations, bounds, cuts, spindle, descent):
        speed = np.where(cuts, feed, inf) * np.where(per_tooth > 0.0, per_tooth, 1.0)
        found = found.least(capped(speed, name))
        if name in {CapName.CHIP_THICKNESS, CapName.FEED_PER_TOOTH}:
            chip = np.minimum(chip, speed)
    caps = _not_below(found, bounds.least)
    return StationCaps(caps=caps, chip=chip, most=caps.feed)


def raised_to(caps: Caps, feed: Floats, name: CapName) -> Caps:
    """Caps of which none is below a feed, (M,), mm/s; those that were have another name."""
    is_low = caps.feed < feed
    return Caps(
        feed=np.where(is_low, feed, caps.feed), name=np.where(is_low, NUMBER[name], caps.name)
    )


def _not_below(caps: Caps, least: float) -> Caps:
    """Caps of which none is below a feed, mm/s."""
    return raised_to(caps, np.full(len(caps.feed), least), CapName.LEAST)


def _feeds_per_tooth(
    stations: Stations, bounds: CutBounds, cuts: Bools, spindle: Floats, descent: Floats
) -> Iterator[tuple[CapName, Floats]]:
    """Feeds per tooth at the bounds of each limit, (M,), mm."""
    for name, feed in bounds.fixed:
        yield name, np.full(len(stations), feed)
    yield from _chip_bounds(stations, bounds)
    if bounds.plunge is not None:
        yield CapName.PLUNGE, _plunge(stations, bounds.plunge, descent)
    yield from _force_bounds(stations, bounds, cuts, spindle)
    if is_bent(bounds.cut) and bounds.at.grade is not None:
        yield from _bending_bounds(stations, bounds)


def _plunge(stations: Stations, greatest: float, descent: Floats) -> Floats:
    """Feed per tooth on the way down: its part along the axis is limited."""
    is_down = (stations.kind == StationKind.DRILLING) | (
        (stations.kind == StationKind.MILLING) & (descent > RAMP)
    )
    steep = np.where(stations.kind == StationKind.DRILLING, 1.0, np.maximum(descent, RAMP))
    return np.where(is_down, greatest / steep, inf)


def _chip_bounds(stations: Stations, bounds: CutBounds) -> Iterator[tuple[CapName, Floats]]:
    """Catalogue feed per tooth at the engagement of each station."""
    cut, at = bounds.cut, bounds.at
    base = catalogue_feed(cut, at)
    if base is None:
        return
    window = None if at.grade is None else at.grade.feed_window
    if cut.kind is not CutKind.MILLING or window is None or at.machine.only_stated_limits:
        yield CapName.FEED_PER_TOOTH, np.full(len(stations), base)
        return
    factor = np.ones(len(stations))
    arcs = stations.arcs
    at_arc = np.flatnonzero(
        (stations.kind == StationKind.MILLING) & (arcs.exit_angle > arcs.entry_angle)
    )
    width, sine = width_ratios(arcs, at_arc), chip_sines(arcs, at_arc)
    factor[at_arc] = feed_factors(width, sine, window)
    is_thin = factor > 1.0
    yield CapName.CHIP_THICKNESS, np.where(is_thin, base * factor, inf)
    yield CapName.FEED_PER_TOOTH, np.where(is_thin, inf, base * factor)


def feed_factors(width_ratio: Floats, sine: Floats, window: FeedWindow) -> Floats:
    """Factors on the catalogue feed, as ``feed_factor`` of the chip load, for arrays."""
    reference = window.width_ratio
    beyond = np.clip((width_ratio - reference) / max(1.0 - reference, 1e-12), 0.0, 1.0)
    thickest = conventional(reference, 1.0).greatest_sine
    thinner = np.clip(thickest / np.maximum(sine, 1e-12), 1.0, GREATEST_THINNING)
    factors: Floats = np.where(
        width_ratio > reference, 1.0 - beyond * (1.0 - window.slot_factor), thinner
    )
    return factors


def _force_bounds(
    stations: Stations, bounds: CutBounds, cuts: Bools, spindle: Floats
) -> Iterator[tuple[CapName, Floats]]:
    """Limits on cutting force or thrust, torque and power.

    The mean tangential force is ``F = K·k_c1.1·χ^−m · A·z/(π·D) · f^(1−m)``, with the section A
    and the mean chip ratio χ of the station.
    """
    cut, at = bounds.cut, bounds.at
    kienzle, machine, point = at.material.kienzle, at.machine, drill_point(at)
    growth = 1.0 - kienzle.m_c
    diameter = np.where(cuts, stations.diameter, 1.0)
    ratio = np.where(cuts, stations.chip_ratio, 1.0).clip(LEAST_RATIO)
    is_drilled = stations.kind == StationKind.DRILLING
    is_solid = is_drilled & _is_solid(stations, point)
    chisel = chisel_factors(point.chisel_ratio)
    factor = force_factor(at) * at.safety_factor
    force = (
        factor * kienzle.k_c11 * ratio**-kienzle.m_c * np.where(is_solid, chisel.torque, 1.0)
    )
    force *= stations.peak_section * cut.tool.teeth / (pi * diameter)

    def feed_at(bound: Floats | float, load: Floats) -> Floats:
        known = np.where(load > 0.0, load, 1.0)
        share = np.where(load > 0.0, np.maximum(bound, 0.0) / known, inf)
        feed: Floats = share ** (1.0 / growth)
        return feed

    if machine.max_cutting_force is not None:
        raised = np.where(is_solid, chisel.thrust / chisel.torque, 1.0)
        along = point.thrust_share * ratio * raised * force
        constant = factor * constant_thrust(
            kienzle, diameter + stations.axial_depth, lip_sine=ratio, teeth=cut.tool.teeth,
            constant=chisel.constant,
        )  # fmt: skip
        left = machine.max_cutting_force - np.where(is_solid, constant, 0.0)
        across = feed_at(machine.max_cutting_force, force)
        yield CapName.CUTTING_FORCE, np.where(is_drilled, feed_at(left, along), across)
    power, torque = _spindle_bounds(bounds, spindle)
    watts = force * pi * diameter * spindle / (NMM_S_PER_WATT * machine.spindle.efficiency)
    if bounds.is_held_along:
        for held in held_feeds(cut, at, stations, spindle=spindle, force=force):
            yield CapName.HOLDING, held
    yield CapName.MOTOR_POWER, feed_at(power, watts)
    yield CapName.SPINDLE_TORQUE, feed_at(torque, 0.5 * diameter * force)


def _is_solid(stations: Stations, point: DrillPoint) -> Bools:
    """True if the chisel edge of a drill meets material: any existing hole is narrower."""
    inside = stations.diameter - stations.axial_depth
    solid: Bools = inside <= point.chisel_ratio * (stations.diameter + stations.axial_depth)
    return solid & (point.chisel_ratio > 0.0)


def _spindle_bounds(bounds: CutBounds, spindle: Floats) -> tuple[Floats, Floats]:
    """Power and torque that the drive gives at each spindle speed, W and N·mm."""
    power, torque = np.full(len(spindle), inf), np.full(len(spindle), inf)
    segments = curve_segments(bounds.at.machine.spindle)
    ends = np.array([part.max_speed for part in segments[:-1]])
    which = np.searchsorted(ends, spindle, side="left")
    for number, part in enumerate(segments):
        rows = np.flatnonzero(which == number)
        power[rows] = part.power_coefficient * spindle[rows] ** part.power_exponent
        if part.torque_coefficient is not None:
            torque[rows] = part.torque_coefficient * spindle[rows] ** part.torque_exponent
    return power, torque


def _bending_bounds(stations: Stations, bounds: CutBounds) -> Iterator[tuple[CapName, Floats]]:
    """Limits on deflection and bending stress of an end mill."""
    cut, at, grade = bounds.cut, bounds.at, bounds.at.grade
    if grade is None:
        return
    kienzle = at.material.kienzle
    bent = bending(cut, stations, kienzle, is_exact=True)
    shank = end_mill(
        cut.tool.diameter,
        cutting_edge_length=cut.tool.cutting_edge_length,
        youngs_modulus=grade.youngs_modulus,
        overhang=cut.tool.overhang,
    )
    scale = force_factor(at) * at.safety_factor * kienzle.k_c11
    for name, load, bound in (
        (CapName.TOOL_DEFLECTION, bent.wall * shank.compliance, at.deflection.value),
        (CapName.SHANK_STRENGTH, bent.shank * shank.stress(1.0), grade.bending_strength),
    ):
        feed = np.full(len(stations), inf)
        some = np.flatnonzero(load > 0.0)
        feed[bent.at[some]] = (bound / (scale * load[some])) ** (1.0 / (1.0 - kienzle.m_c))
        yield name, feed
