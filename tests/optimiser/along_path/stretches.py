"""Stretches of path for tests: straight and bent lines with caps by place."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from optimiser.along_path.caps import CapName, CutBounds, capped
from optimiser.along_path.runs import MachineFeeds
from optimiser.along_path.stretch import PathStretch, PlaceCaps
from simulator.motion.control import control_model
from simulator.motion.model_name import ControlModelName
from simulator.motion.segments import AxisLimits, Segments, lines
from simulator.removal.stations import StationKind, Stations, air
from tests.optimiser.sample_cuts import CARBIDE, CUT

LIMITS = AxisLimits(
    acceleration=np.full(3, 4000.0),
    rapid=np.full(3, 500.0),
    feed=np.full(3, 300.0),
    jerk=np.full(3, 50_000.0),
)
BOUNDS = CutBounds(cut=CUT, at=CARBIDE)
FIR = MachineFeeds(control=control_model(ControlModelName.FIR, LIMITS), limits=LIMITS)


def half_cut(ends: list[float], is_cut: list[bool]) -> Stations:
    """Stations of a mill of 12 mm that cuts half its diameter, 3 mm deep, or nothing."""
    cuts = np.array(is_cut)
    values = {
        "section": 18.0,
        "growth": 0.0,
        "axial_depth": 3.0,
        "radial_width": 6.0,
        "entry_angle": 0.0,
        "exit_angle": 0.5 * np.pi,
        "contact_angle": 0.5 * np.pi,
        "chip_ratio": 2.0 / np.pi,
        "diameter": 12.0,
    }
    return Stations(
        segment=np.zeros(len(ends), dtype=np.int64),
        station=np.array(ends),
        kind=np.where(cuts, int(StationKind.MILLING), int(StationKind.AIR)),
        **{name: np.where(cuts, value, 0.0) for name, value in values.items()},
    )


def stretch_of(segments: Segments) -> PathStretch:
    """Free stretch in air whose blocks may be split."""
    count = len(segments)
    return PathStretch(
        segments=segments,
        spindle=np.full(count, 50.0),
        per_revolution=np.full(count, np.nan),
        is_free=~segments.is_rapid,
        can_split=np.ones(count, dtype=np.bool_),
        met=air(np.arange(count), segments.length),
    )


def straight(lengths: Sequence[float], *, speed: float = 10.0) -> Segments:
    """Line along x in segments of given lengths, each a block."""
    places = np.concatenate(([0.0], np.cumsum(lengths)))
    return lines([(x, 0.0, 0.0) for x in places], speed=speed)


def places_of(segments: Segments, ends: Sequence[float], caps: Sequence[float]) -> PlaceCaps:
    """Process caps by place."""
    ends_ = np.asarray(ends, dtype=np.float64)
    middle = ends_ - 0.5 * np.diff(ends_, prepend=0.0)
    return PlaceCaps(
        ends=ends_,
        segment=np.searchsorted(np.cumsum(segments.length), middle),
        caps=capped(np.asarray(caps, dtype=np.float64), CapName.CUTTING_FORCE),
        is_cut=np.isfinite(np.asarray(caps)),
    )


def with_control(feeds: MachineFeeds, name: ControlModelName) -> MachineFeeds:
    """The same machine with another control."""
    return replace(feeds, control=control_model(name, feeds.limits))
