"""Forces of every tooth of a milling cutter while it turns, along its helix, with runout.

A tooth at the angle φ takes a chip ``h = f_z·sin φ·sin κ``; the edge at the height y over the
tip lags behind the tip by ``ψ = 2·y·tan λ/D``, [1]_. All forces of a Kienzle law are in
proportion to ``K·k_c1.1·f_z^q``, q = 1 − m_c: what is computed here is the rest, in
mm^(2−q)·mm^(q−1) = mm, for M places at once. Angles as in :mod:`simulator.physics.engagement`;
the path of a tooth is taken as a circle. Rounded ends are cut in bands of height. Units mm, N,
rad.

A tooth pushes the tool by F_t against its own motion and by F_r towards the axis, which gives

- the feed force ``F_t·cos φ + F_r·sin φ``, positive against the feed, and
- the normal force ``F_t·sin φ − F_r·cos φ``, positive towards φ = 0: to the left of the feed
  for a spindle that turns clockwise.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", 2nd ed., Cambridge, 2012, ch. 2: forces along a
   helix, and the surface that is left where the edge passes the wall.
.. [2] P. Lee and Y. Altintas, "Prediction of ball-end milling forces from orthogonal cutting
   data", Int. J. Mach. Tools Manuf. 36(9), 1996: constant lead, forces by slices.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import pi, sin

import numpy as np
from numpy.typing import NDArray

from simulator.physics import even_teeth, uneven_teeth
from simulator.physics.even_teeth import Bands
from simulator.physics.flutes import WALL, CuttingEdges, ForceLaw
from simulator.physics.uneven_teeth import Runout

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

CORNER_BANDS = 6
"""bands of a rounded end"""

STEPS = 8
"""between rotations at which an end of an edge enters or leaves; twice that about the best"""

ROUGH_STEPS = 2
"""the same for a rough look: the rotations themselves and the middles between them"""

STRAIGHT = 1e-7
"""rad, the least lag of a band: a straight edge is one of almost no helix"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Places:
    """M engagements of a cutter."""

    entry_angle: Floats
    """Entry angle, (M,) φ_st, rad"""
    exit_angle: Floats
    """Exit angle, (M,) φ_ex, rad"""
    axial_depth: Floats
    """Axial depth, (M,) a_p, mm"""

    def rows(self, rows: Ints) -> "Places":
        """Some of them."""
        return Places(
            entry_angle=self.entry_angle[rows],
            exit_angle=self.exit_angle[rows],
            axial_depth=self.axial_depth[rows],
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArcIntegrals:
    """Integrals over M arcs of contact, which mean forces are made of."""

    contact: Floats
    """Contact, (M,) ∫dφ, rad"""
    sine: Floats
    """Sine, (M,) ∫sin φ dφ = C"""
    cosine: Floats
    """Cosine, (M,) ∫cos φ dφ"""
    sine_squared: Floats
    """Sine squared, (M,) ∫sin² φ dφ"""
    sine_cosine: Floats
    """Sine cosine, (M,) ∫sin φ·cos φ dφ"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Forces:
    """Sums over all teeth at K rotations of M places, over ``K·k_c1.1·f_z^q``."""

    tangential: Floats
    """Tangential, (M, K) mm"""
    feed: Floats
    """Feed, (M, K) mm, against the feed"""
    normal: Floats
    """Normal, (M, K) mm, towards φ = 0"""

    @property
    def resultant(self) -> Floats:
        """(M, K) mm, across the axis."""
        across: Floats = np.hypot(self.feed, self.normal)
        return across


def one_place(entry_angle: float, exit_angle: float, *, axial_depth: float) -> Places:
    """A single engagement, rad and mm."""
    return Places(
        entry_angle=np.array([entry_angle]),
        exit_angle=np.array([exit_angle]),
        axial_depth=np.array([axial_depth]),
    )


def arcs_of(entry_angle: Floats, exit_angle: Floats) -> ArcIntegrals:
    """Integrals over arcs of contact in closed form, (M,) angles in rad."""
    # Products keep their digits on a narrow arc, where differences of sines lose them.
    contact, both = exit_angle - entry_angle, entry_angle + exit_angle
    half = np.sin(0.5 * contact)
    return ArcIntegrals(
        contact=contact,
        sine=2.0 * np.sin(0.5 * both) * half,
        cosine=2.0 * np.cos(0.5 * both) * half,
        sine_squared=0.5 * (contact - np.cos(both) * np.sin(contact)),
        sine_cosine=0.5 * np.sin(both) * np.sin(contact),
    )


def forces(
    edges: CuttingEdges,
    places: Places,
    law: ForceLaw,
    *,
    rotation: Floats,
    runout: Runout | None = None,
) -> Forces:
    """Forces while the cutter turns.

    Equal teeth are summed in closed form. With runout the edges in the cut are integrated by
    Gauss: exact but for the root of sin φ at the ends of the arc and corners of the chip.

    Parameters
    ----------
    edges : CuttingEdges
    places : Places
    law : ForceLaw
    rotation : (M, K) array, rad
        Angle φ of the tip of tooth 0; tooth j follows ``j·2π/z`` behind.
    runout : Runout in mm, optional

    Returns
    -------
    Forces

    Raises
    ------
    ValueError
        If there is not one offset for each tooth.

    Examples
    --------
    One straight tooth of a slot, 2 mm deep, at φ = 90°:

    >>> slot = Places(
    ...     entry_angle=np.zeros(1), exit_angle=np.array([pi]), axial_depth=np.array([2.0])
    ... )
    >>> one = CuttingEdges(teeth=1, diameter=10.0)
    >>> found = forces(one, slot, ForceLaw(exponent=1.0), rotation=np.array([[0.5 * pi]]))
    >>> round(float(found.tangential[0, 0]), 6), round(float(found.feed[0, 0]), 6)
    (2.0, 0.6)
    """
    if runout is not None and runout.offsets.shape != (edges.teeth,):
        shape = runout.offsets.shape
        raise ValueError(f"runout has shape {shape} and must have ({edges.teeth},)")
    arc = places.entry_angle, places.exit_angle
    bands = _bands(edges, places.axial_depth, law)
    if runout is None:
        teeth = edges.teeth
        found = even_teeth.sums(rotation, arc, bands, teeth=teeth, exponent=law.exponent)
    else:
        found = uneven_teeth.sums(rotation, arc, bands, runout, exponent=law.exponent)
    return Forces(tangential=found[0], feed=found[1], normal=found[2])


def peak_resultant(
    edges: CuttingEdges, places: Places, law: ForceLaw, *, is_rough: bool = False
) -> Floats:
    """Greatest force across the axis within a revolution, (M,) mm over ``K·k_c1.1·f_z^q``.

    Between the rotations at which an end of an edge enters or leaves the arc the force is
    smooth: it is looked for at those, between them, and finer about the best. Roughly: at those
    and in the middles between them only, never above and seldom a quarter below.
    """
    corners = np.sort(np.mod(_corners(edges, places), edges.pitch), axis=1)
    corners = np.concatenate((corners, corners[:, :1] + edges.pitch), axis=1)

    def across(rotation: Floats) -> Floats:
        return forces(edges, places, law, rotation=rotation).resultant

    return _greatest(across, corners, is_rough=is_rough)


def wall_force(
    edges: CuttingEdges, places: Places, law: ForceLaw, *, is_rough: bool = False
) -> Floats:
    """Greatest force normal to a wall while an edge makes it, (M,) mm over ``K·k_c1.1·f_z^q``.

    The edge at the height y makes the wall at the moment when it passes φ = 0 or π, [1]_: what
    the tool gives way then stays in the part. 0 where the arc reaches no wall. Roughly: as
    :func:`peak_resultant`.
    """
    greatest = np.zeros(len(places.axial_depth))
    for angle, is_wall in (
        (0.0, places.entry_angle <= WALL),
        (pi, places.exit_angle >= pi - WALL),
    ):
        rows = np.flatnonzero(is_wall)
        if len(rows):
            normal = _at_wall(edges, places.rows(rows), law, angle, is_rough=is_rough)
            greatest[rows] = np.maximum(greatest[rows], normal)
    return greatest


def _at_wall(
    edges: CuttingEdges, places: Places, law: ForceLaw, angle: float, *, is_rough: bool
) -> Floats:
    """Greatest normal force while one edge passes an angle from its lower end to its upper."""
    span = np.minimum(edges.lag * places.axial_depth, edges.pitch)[:, None]
    inner = np.minimum(np.mod(_corners(edges, places) - angle, edges.pitch), span)
    corners = np.sort(np.concatenate((np.zeros_like(span), inner, span), axis=1), axis=1)

    def normal(rotation: Floats) -> Floats:
        found = forces(edges, places, law, rotation=angle + rotation).normal
        size: Floats = np.abs(found)
        return size

    return _greatest(normal, corners, is_rough=is_rough)


def _corners(edges: CuttingEdges, places: Places) -> Floats:
    """(M, 4) rotations at which the ends of an edge enter and leave the arc."""
    lag = np.maximum(edges.lag * places.axial_depth, STRAIGHT)
    entry, exit_ = places.entry_angle, places.exit_angle
    return np.stack((entry, entry + lag, exit_, exit_ + lag), axis=1)


def _greatest(of: Callable[[Floats], Floats], corners: Floats, *, is_rough: bool) -> Floats:
    """(M,) greatest value of what is smooth between ascending corners."""
    steps = ROUGH_STEPS if is_rough else STEPS
    step = np.arange(steps) / steps
    inner = corners[:, :-1, None] + np.diff(corners, axis=1)[:, :, None] * step
    rotation = np.concatenate((inner.reshape(len(corners), -1), corners[:, -1:]), axis=1)
    found = of(rotation)
    if is_rough:
        rough: Floats = found.max(axis=1)
        return rough
    best = found.argmax(axis=1)[:, None]
    last = rotation.shape[1] - 1
    before = np.take_along_axis(rotation, np.maximum(best - 1, 0), axis=1)
    after = np.take_along_axis(rotation, np.minimum(best + 1, last), axis=1)
    finer = of(before + (after - before) * (np.arange(2 * STEPS) + 0.5) / (2 * STEPS))
    greatest: Floats = np.maximum(found.max(axis=1), finer.max(axis=1))
    return greatest


def _bands(edges: CuttingEdges, depth: Floats, law: ForceLaw) -> Bands:
    """Bands of the edges down to which each place reaches, rounded end first."""
    corner = np.minimum(depth, edges.corner_radius)
    heights, weights, sines = [np.zeros_like(depth)], [], []
    if edges.corner_radius > 0.0:
        # By the angle of the edge, so that bands are finest where it is flattest.
        steepest = np.arccos(1.0 - corner / edges.corner_radius)
        for band in range(CORNER_BANDS):
            ends = steepest * band / CORNER_BANDS, steepest * (band + 1) / CORNER_BANDS
            sine = np.sin(0.5 * (ends[0] + ends[1]))
            heights.append(edges.corner_radius * (1.0 - np.cos(ends[1])))
            weights.append(edges.corner_radius * (ends[1] - ends[0]) * sine**law.exponent)
            sines.append(sine)
    slope = sin(edges.cutting_edge_angle)
    heights.append(depth)
    weights.append((depth - corner) * slope ** (law.exponent - 1.0))
    sines.append(np.full(len(depth), slope))
    lag = edges.lag * np.stack(heights, axis=1)
    low = np.ascontiguousarray(lag[:, :-1])
    high = np.maximum(lag[:, 1:], low + STRAIGHT)
    # The radial force acts in the plane by the slope of the edge.
    radial = law.radial_share * np.stack(sines, axis=1)
    return Bands(low=low, high=high, weight=np.stack(weights, axis=1), radial=radial)
