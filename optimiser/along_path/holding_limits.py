"""Limits of the work-holding at each station of a path.

The loads are those of :mod:`optimiser.bounds.holding`, at the engagement of the station. Units:
mm, rev/s, N.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, tan

import numpy as np

from optimiser.bounds.holding import chuck_limits
from optimiser.bounds.limits import force_factor
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.cuts.hardest_places import bending
from simulator.motion.segments import Floats
from simulator.physics.holding import holding_force
from simulator.removal.stations import StationKind, Stations
from simulator.spec import ToolKind
from simulator.work_holding import Chuck, Clamp

DIGITS = 1
"""Decimal places to which diameters, mm, and spindle speeds, rev/s, share a limit."""


def held_feeds(
    cut: Cut, at: CuttingConditions, stations: Stations, *, spindle: Floats, force: Floats
) -> Iterator[Floats]:
    """Feeds per tooth at which the work-holding is at its bounds, (M,), mm.

    Parameters
    ----------
    at : CuttingConditions
        With the holding, and with the grip of a chuck.
    spindle : (M,) array, rev/s
    force : (M,) array, N
        Mean tangential force at a feed per tooth of 1 mm, with its margin.
    """
    if isinstance(at.holding, Clamp) and cut.kind is CutKind.MILLING:
        yield from _held_feeds(cut, at, at.holding, stations, force)
    elif isinstance(at.holding, Chuck) and cut.kind is not CutKind.MILLING:
        yield _gripped(cut, at, stations, spindle)


def _held_feeds(
    cut: Cut, at: CuttingConditions, clamp: Clamp, stations: Stations, force: Floats
) -> Iterator[Floats]:
    """Feeds at which a vice or clamps hold a mill's force, across the spindle and upwards."""
    kienzle, bound = at.material.kienzle, holding_force(clamp)
    growth = 1.0 - kienzle.m_c
    # Any mill's force on the workpiece is found as that on the shank of an end mill.
    found = bending(replace(cut, tool_kind=ToolKind.ENDMILL), stations, kienzle, is_exact=True)
    across = np.zeros(len(stations))
    across[found.at] = force_factor(at) * at.safety_factor * kienzle.k_c11 * found.shank
    lift = np.where(stations.kind == StationKind.MILLING, force * tan(cut.helix_angle), 0.0)
    for load in (across, lift):
        share = np.full(len(stations), inf)
        np.divide(bound, load, out=share, where=load > 0.0)
        feeds: Floats = share ** (1.0 / growth)
        yield feeds


def _gripped(cut: Cut, at: CuttingConditions, stations: Stations, spindle: Floats) -> Floats:
    """Feeds at which a chuck holds the torque and the tilting moment of each station."""
    feeds = np.full(len(stations), inf)
    rows = np.flatnonzero((stations.peak_section > 0.0) & (spindle > 0.0))
    keys = np.round(np.stack((stations.diameter[rows], spindle[rows])), DIGITS)
    told, which = np.unique(keys, axis=1, return_inverse=True)
    for number, (diameter, speed) in enumerate(told.T.tolist()):
        turned = cut if cut.kind is CutKind.DRILLING else replace(cut, diameter=diameter)
        limits = [
            limit.with_safety(at.safety_factor)
            for limit in chuck_limits(turned, at, speed, speed)
        ]
        for row in rows[which.ravel() == number].tolist():
            depth = max(float(stations.axial_depth[row]), 1e-6)
            feeds[row] = min(limit.feed_at_bound(depth, speed) for limit in limits)
    return feeds
