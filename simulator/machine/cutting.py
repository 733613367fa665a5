"""Force and power of the cut where the tool is, for all processes alike.

``P_c = k_c(h_m) · Q``: specific force times removal rate, exact for milling, drilling and
turning, so that only the section of the cut and the ratio of the mean chip need to be known. A
drill in the solid takes more by its chisel edge. The wear land of an edge adds a force of its
own, which no chip changes, on the width of all teeth that are in the cut on average.
Forces are means over a revolution; those of single teeth are in
:mod:`simulator.machine.tooth_loads`. Units mm, s, N, W, rev/s.

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
from simulator.spec import DrillPoint, Kienzle

NMM_S_PER_WATT = 1000.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CuttingEdge:
    """Cutting edge and the material that it cuts."""

    teeth: int
    kienzle: Kienzle
    factor: float = 1.0
    """on k_c: rake, speed, and what calibration found"""
    flutes: CuttingEdges | None = None
    """Flutes of a milling cutter; None: straight edges, upright"""
    compliance: float = 0.0
    """mm/N, of the tip of an end mill; 0: it does not bend"""
    point: DrillPoint = LIPS_ONLY
    """Point of a tool that cuts on its end"""
    feed_force: Kienzle | None = None
    """(k_f1.1, m_f) of turning; None: the usual share of the cutting force"""
    back_force: Kienzle | None = None
    """(k_p1.1, m_p) of turning"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CuttingLoads:
    """Loads of the cut at M times."""

    removal_rate: Floats
    """Removal rate, (M,) mm³/s"""
    chip_thickness: Floats
    """Chip thickness, (M,) mm, mean over the contact"""
    power: Floats
    """Power, (M,) W at the edge"""
    force: Floats
    """Force, (M,) N, tangential"""
    feed_force: Floats
    """Feed force, (M,) N, against the feed"""
    back_force: Floats
    """Back force, (M,) N, across the feed, from the surface"""
    thrust: Floats
    """Thrust, (M,) N, along the axis, of a drill or of a mill that goes straight down"""
    deflection: Floats
    """(M,) mm that the tip gives way, normal to the wall that it makes, at most in a turn"""
    filled: Floats
    """Filled, (M,) section over the greatest of its station"""


def no_loads(count: int) -> CuttingLoads:
    """Nothing is cut."""
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
    """Loads of a sharp edge at M places of a path.

    Parameters
    ----------
    stations : Stations
    rows : (M,) array of int
        Which station holds.
    speed : (M,) array, mm/s
        Along the path.
    spindle_speed : (M,) array, rev/s
        Magnitude; a cut with a standing spindle has no model: its force is 0.
    edge : CuttingEdge
    beyond : (M,) array or float
        Place beyond the middle of the stretch over its length, -1/2 to 1/2.
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
    """Loads of a sharp edge and of its wear land, :mod:`simulator.physics.flank`.

    Parameters
    ----------
    sharp : CuttingLoads
        At M places.
    stations : Stations
    rows : (M,) array of int
        Which station holds.
    spindle_speed : (M,) array, rev/s
        Magnitude.
    edge : CuttingEdge
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
    """Width of the edges in the cut, all teeth, mean of a revolution, at each station, mm.

    ``z · a_p · φ/2π`` of a mill, the lips of a drill, the depth of a turning tool; all counted
    across the depth. ``z·A/(π·D)`` is it for a chip as thick as the feed, A the section.
    """
    is_milling = stations.kind == StationKind.MILLING
    met = stations.diameter > 0.0
    width = teeth * stations.section / (pi * np.where(met, stations.diameter, 1.0))
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    whole = np.where(arc.sine > 0.0, arc.sine, 1.0)
    thicker = np.where(is_milling, arc.contact / whole, 1.0)
    return np.where(met, width * thicker, 0.0)


def land_coefficients(stations: Stations) -> tuple[Floats, Floats]:
    """Force of a wear land against and across the feed, at each station, N/mm².

    Of what is square to a leaning edge of a mill ``sin κ`` is across the axis.
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
    """Force of a mill against and across the feed over the tangential one, at each station.

    Means over a revolution of one tooth on its arc, [2]_; a radial force that is a share of the
    tangential one.
    """
    arc = arcs_of(stations.entry_angle, stations.exit_angle)
    whole = np.where(arc.sine > 0.0, arc.sine, 1.0)
    radial = RADIAL_SHARE * _edge_sine(stations)
    feed = (arc.sine_cosine + radial * arc.sine_squared) / whole
    back = (arc.sine_squared - radial * arc.sine_cosine) / whole
    return feed, back


def _edge_sine(stations: Stations) -> Floats:
    """Sin κ of the edge of a mill at each station, from the mean chip."""
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
    """Whether the chisel edge of a drill meets material: the hole before is not wider."""
    # The middle of a lip and its width tell the diameters inside and outside.
    inside = stations.diameter - stations.axial_depth
    outside = stations.diameter + stations.axial_depth
    is_drill = (stations.kind == StationKind.DRILLING) & (point.chisel_ratio > 0.0)
    is_solid: Bools = is_drill & (inside <= point.chisel_ratio * outside)
    return is_solid
