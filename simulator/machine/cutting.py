"""Cutting force and power at the tool position, in one form for all processes.

``P_c = k_c(h_m) · Q``: specific force times removal rate, exact for milling, drilling and
turning, so that only the section of the cut and the ratio of the mean chip need to be known. A
drill in solid material needs more because of its chisel edge. The wear land of an edge adds a
force that is independent of the chip, on the mean engaged width of all teeth. Forces are means
over a revolution; forces of single teeth are in :mod:`simulator.machine.tooth_loads`. Units mm,
s, N, W, rev/s.

References
----------
.. [1] F. Klocke, "Manufacturing Processes 1: Cutting", 2011, ch. 3: Kienzle's law.
.. [2] Y. Altintas, "Manufacturing Automation", Cambridge, 2012, ch. 2: mean milling forces.
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from simulator.motion.segments import Bools, Floats, Ints
from simulator.physics import flank
from simulator.physics.drilling import (
    LIPS_ONLY,
    NO_CHISEL,
    chisel_factors,
    constant_thrust,
)
from simulator.physics.flutes import CuttingEdges
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.tooth_forces import arcs_of
from simulator.physics.turning import turning_forces
from simulator.removal.stations import StationKind, Stations
from simulator.spec import Kienzle
from simulator.tool_windows import DrillPoint
from stepnc_model.units import NMM_S_PER_WATT

STOPPED = "cut with a stopped spindle: its force is not modelled"
"""Finding on such a cut."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingEdge:
    """Cutting edge of a tool and the material that it cuts."""

    teeth: int
    kienzle: Kienzle
    factor: float = 1.0
    """Factor on k_c for rake angle, cutting speed and calibration."""
    flutes: CuttingEdges | None = None
    """Flutes of a milling cutter; None for straight edges without helix."""
    compliance: float = 0.0
    """Compliance of the tip of an end mill, mm/N; 0 for a rigid tool."""
    point: DrillPoint = LIPS_ONLY
    """Point geometry of a tool that cuts with its end."""
    feed_force: Kienzle | None = None
    """Kienzle constants (k_f1.1, m_f) in turning; None: usual share of the cutting force."""
    back_force: Kienzle | None = None
    """Kienzle constants (k_p1.1, m_p) of the back force in turning; None: usual share."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CuttingLoads:
    """Cutting loads at M times."""

    removal_rate: Floats
    """Removal rate, (M,), mm³/s."""
    chip_thickness: Floats
    """Mean chip thickness over the contact, (M,), mm."""
    power: Floats
    """Cutting power at the edge, (M,), W."""
    force: Floats
    """Tangential cutting force, (M,), N."""
    feed_force: Floats
    """Force against the feed, (M,), N."""
    back_force: Floats
    """Force across the feed, away from the surface, (M,), N."""
    thrust: Floats
    """Thrust along the axis of a drill or a plunging mill, (M,), N."""
    deflection: Floats
    """Greatest deflection of the tip in a revolution, normal to the wall cut, (M,), mm."""
    filled: Floats
    """Section over the greatest section of its station, (M,)."""


def no_loads(count: int) -> CuttingLoads:
    """Zero loads for a number of times without cutting."""
    nothing = np.zeros(count)
    return CuttingLoads(
        removal_rate=nothing,
        chip_thickness=nothing,
        power=nothing,
        force=nothing,
        feed_force=nothing,
        back_force=nothing,
        thrust=nothing,
        deflection=nothing,
        filled=nothing,
    )


def cutting_loads(
    stations: Stations,
    rows: Ints,
    *,
    speed: Floats,
    spindle_speed: Floats,
    edge: CuttingEdge,
    beyond: Floats | float = 0.0,
) -> CuttingLoads:
    """Loads of a sharp edge at M points of a path.

    Parameters
    ----------
    rows : (M,) array of int
        Index of the station that applies.
    speed : (M,) array, mm/s
        Speed along the path.
    spindle_speed : (M,) array, rev/s
        Magnitude; cutting with a stopped spindle is not modelled: the force is 0.
    beyond : (M,) array or float
        Distance from the middle of the stretch over its length, -1/2 to 1/2.
    """
    is_met = stations.section * stations.chip_ratio * stations.diameter > 0.0
    cuts: Bools = is_met[rows] & (speed > 0.0) & (spindle_speed > 0.0)
    section = stations.section[rows] + beyond * stations.growth[rows]
    rate = np.where(cuts, section * speed, 0.0)
    per_tooth = np.where(cuts, speed, 1.0) / (edge.teeth * np.where(cuts, spindle_speed, 1.0))
    chip = np.where(cuts, per_tooth * stations.chip_ratio[rows], 1.0)
    is_solid = _is_solid(stations, edge.point)[rows]
    chisel = chisel_factors(edge.point.chisel_ratio)
    specific = edge.factor * edge.kienzle.k_c11 * chip**-edge.kienzle.m_c
    power = np.where(is_solid, chisel.torque, 1.0) * specific * rate / NMM_S_PER_WATT
    around = pi * np.where(cuts, stations.diameter[rows] * spindle_speed, 1.0)
    force = power * NMM_S_PER_WATT / around
    feed, back = _across(stations, rows, force, chip=chip, edge=edge)
    return CuttingLoads(
        removal_rate=rate,
        chip_thickness=np.where(cuts, chip, 0.0),
        power=power,
        force=force,
        feed_force=feed,
        back_force=back,
        thrust=np.where(stations.kind[rows] == StationKind.DRILLING, feed, 0.0),
        deflection=np.zeros(len(rows)),
        filled=np.where(cuts, section / np.where(cuts, stations.peak_section[rows], 1.0), 0.0),
    )


def worn_loads(
    sharp: CuttingLoads,
    stations: Stations,
    rows: Ints,
    *,
    spindle_speed: Floats,
    edge: CuttingEdge,
    flank_wear: Floats,
) -> CuttingLoads:
    """Add the loads of the wear land to those of a sharp edge; :mod:`simulator.physics.flank`.

    Parameters
    ----------
    sharp : CuttingLoads
        Loads of the sharp edge at M points.
    rows : (M,) array of int
        Index of the station that applies.
    spindle_speed : (M,) array, rev/s
        Magnitude of the spindle speed.
    flank_wear : (M,) array, mm
    """
    width = np.where(sharp.removal_rate > 0.0, engaged_width(stations, edge.teeth)[rows], 0.0)
    land = flank.land_force(flank.CUTTING, flank_wear, width)
    feed, back = (
        flank.land_force(1.0, flank_wear, width) * each[rows]
        for each in land_coefficients(stations)
    )
    around = pi * stations.diameter[rows] * spindle_speed
    return replace(
        sharp,
        power=sharp.power + land * around / NMM_S_PER_WATT,
        force=sharp.force + land,
        feed_force=sharp.feed_force + feed,
        back_force=sharp.back_force + back,
    )


def engaged_width(stations: Stations, teeth: int) -> Floats:
    """Mean width of engaged edges of all teeth over a revolution at each station, mm.

    The width is ``z · a_p · φ/2π`` for a mill, the lips of a drill, or the depth of a turning
    tool, always measured across the depth. For a chip as thick as the feed it equals
    ``z·A/(π·D)``, where A is the section.
    """
    is_milling = stations.kind == StationKind.MILLING
    met = stations.diameter > 0.0
    width = teeth * stations.section / (pi * np.where(met, stations.diameter, 1.0))
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    whole = np.where(arc.sine > 0.0, arc.sine, 1.0)
    thicker = np.where(is_milling, arc.contact / whole, 1.0)
    return np.where(met, width * thicker, 0.0)


def land_coefficients(stations: Stations) -> tuple[Floats, Floats]:
    """Force of a wear land against and across the feed at each station, N/mm².

    Of the force normal to an inclined edge of a mill, the share ``sin κ`` acts across the axis.
    """
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    kind, along = stations.kind, flank.CUTTING
    normal = flank.NORMAL * _edge_sine(stations)
    contact = np.where(arc.contact > 0.0, arc.contact, 1.0)
    feed = (along * arc.cosine + normal * arc.sine) / contact
    back = (along * arc.sine - normal * arc.cosine) / contact
    is_drilling, is_turning = kind == StationKind.DRILLING, kind == StationKind.TURNING
    return (
        np.where(is_drilling | is_turning, flank.FEED, feed),
        np.where(is_turning, flank.BACK, np.where(is_drilling, 0.0, back)),
    )


def milling_shares(stations: Stations) -> tuple[Floats, Floats]:
    """Mill forces against and across the feed over the tangential force, at each station.

    Means over a revolution of one tooth on its arc, [2]_, with a radial force that is a
    constant share of the tangential force.
    """
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    whole = np.where(arc.sine > 0.0, arc.sine, 1.0)
    radial = RADIAL_SHARE * _edge_sine(stations)
    feed = (arc.sine_cosine + radial * arc.sine_squared) / whole
    back = (arc.sine_squared - radial * arc.sine_cosine) / whole
    return feed, back


def _edge_sine(stations: Stations) -> Floats:
    """Sine of the cutting edge angle κ of a mill at each station, from the mean chip."""
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    whole = np.where(arc.sine > 0.0, arc.sine, 1.0)
    sine: Floats = np.minimum(stations.chip_ratio * arc.contact / whole, 1.0)
    return sine


def _across(
    stations: Stations, rows: Ints, force: Floats, *, chip: Floats, edge: CuttingEdge
) -> tuple[Floats, Floats]:
    """Forces against and across the feed, N."""
    kind = stations.kind[rows]
    feed_share, back_share = milling_shares(stations)
    turning = turning_forces(
        force, chip, cutting=edge.kienzle, feed=edge.feed_force, back=edge.back_force
    )
    is_drilling, is_turning = kind == StationKind.DRILLING, kind == StationKind.TURNING
    feed = np.where(is_turning, turning.feed, feed_share[rows] * force)
    back = np.where(is_turning, turning.back, back_share[rows] * force)
    if not is_drilling.any():
        return feed, back
    thrust = _thrust(stations, rows, force, edge=edge)
    return np.where(is_drilling, thrust, feed), np.where(is_drilling, 0.0, back)


def _thrust(stations: Stations, rows: Ints, force: Floats, *, edge: CuttingEdge) -> Floats:
    """Thrust of a drill, N: lips and chisel edge of :mod:`simulator.physics.drilling`."""
    point, ratio = edge.point, stations.chip_ratio[rows]
    is_solid = _is_solid(stations, point)[rows]
    chisel = chisel_factors(point.chisel_ratio)
    raised = np.where(is_solid, chisel.thrust / chisel.torque, NO_CHISEL.thrust)
    lips = point.thrust_share * ratio * raised * force
    outside = (stations.diameter + stations.axial_depth)[rows]
    constant = edge.factor * constant_thrust(
        edge.kienzle,
        outside,
        lip_sine=np.where(ratio > 0.0, ratio, 1.0),
        teeth=edge.teeth,
        constant=chisel.constant,
    )
    return lips + np.where(is_solid & (force > 0.0), constant, 0.0)


def _is_solid(stations: Stations, point: DrillPoint) -> Bools:
    """True if the chisel edge of a drill meets material: any existing hole is narrower."""
    # The middle of a lip and its width give the inner and outer diameter of the cut.
    inside = stations.diameter - stations.axial_depth
    outside = stations.diameter + stations.axial_depth
    is_drill = (stations.kind == StationKind.DRILLING) & (point.chisel_ratio > 0.0)
    is_solid: Bools = is_drill & (inside <= point.chisel_ratio * outside)
    return is_solid
