"""Forces of every tooth of a rotating milling cutter, along its helix, with runout.

A tooth at the angle φ cuts a chip ``h = f_z·sin φ·sin κ``; the edge at the height y above the
tip lags behind the tip by ``ψ = 2·y·tan λ/D``, [1]_. All forces of a Kienzle law are
proportional to ``K·k_c1.1·f_z^q``, q = 1 − m_c; this module computes the remaining factor, in
mm^(2−q)·mm^(q−1) = mm, for M engagements at once. Angles are defined as in
:mod:`simulator.physics.engagement`; the path of a tooth is approximated by a circle. Rounded
ends are divided into bands by height. Units mm, N, rad.

A tooth pushes the tool with F_t against the tooth's motion and with F_r towards the axis. The
results are

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
"""Number of bands of a rounded end."""

STEPS = 8
"""Number of steps between rotations at which an edge enters or exits; doubled at the peak."""

ROUGH_STEPS = 2
"""Number of steps for a rough search: the rotations themselves and their midpoints."""

STRAIGHT = 1e-7
"""Least lag of a band, rad: a straight edge is treated as one with almost no helix."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Places:
    """M engagements of a milling cutter."""

    entry_angle: Floats
    """Entry angle φ_st, (M,), rad."""
    exit_angle: Floats
    """Exit angle φ_ex, (M,), rad."""
    axial_depth: Floats
    """Axial depth of cut a_p, (M,), mm."""

    def rows(self, rows: Ints) -> "Places":
        """Select some of the engagements."""
        return Places(
            entry_angle=self.entry_angle[rows],
            exit_angle=self.exit_angle[rows],
            axial_depth=self.axial_depth[rows],
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArcIntegrals:
    """Integrals over M contact arcs, from which mean forces follow."""

    contact: Floats
    """Contact angle ∫dφ, (M,), rad."""
    sine: Floats
    """Integral ∫sin φ dφ = C, (M,)."""
    cosine: Floats
    """Integral ∫cos φ dφ, (M,)."""
    sine_squared: Floats
    """Integral ∫sin² φ dφ, (M,)."""
    sine_cosine: Floats
    """Integral ∫sin φ·cos φ dφ, (M,)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Forces:
    """Forces of all teeth at K rotations of M engagements, over ``K·k_c1.1·f_z^q``."""

    tangential: Floats
    """Tangential force, (M, K), mm."""
    feed: Floats
    """Force against the feed, (M, K), mm."""
    normal: Floats
    """Force towards φ = 0, (M, K), mm."""

    @property
    def resultant(self) -> Floats:
        """Resultant force across the axis, (M, K), mm."""
        across: Floats = np.hypot(self.feed, self.normal)
        return across


def one_place(entry_angle: float, exit_angle: float, *, axial_depth: float) -> Places:
    """Create a single engagement from angles in rad and a depth in mm."""
    return Places(
        entry_angle=np.array([entry_angle]),
        exit_angle=np.array([exit_angle]),
        axial_depth=np.array([axial_depth]),
    )


def arcs_of(entry_angle: Floats, exit_angle: Floats) -> ArcIntegrals:
    """Integrals over contact arcs in closed form, for angles (M,) in rad."""
    # Products stay accurate on a narrow arc, where differences of sines lose digits.
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
    """Forces of a rotating cutter at given rotations.

    Equal teeth are summed in closed form. With runout the engaged edges are integrated by Gauss
    quadrature: exact but for the root of sin φ at the ends of the arc and corners of the chip.

    Parameters
    ----------
    rotation : (M, K) array, rad
        Angle φ of the tip of tooth 0; tooth j follows at ``j·2π/z`` behind.
    runout : Runout in mm, optional

    Returns
    -------
    Forces

    Raises
    ------
    ValueError
        If the number of offsets differs from the number of teeth.

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
    if runout is None:
        return _of_even_teeth(edges, places, law)(rotation)
    arc = places.entry_angle, places.exit_angle
    bands = _bands(edges, places.axial_depth, law)
    found = uneven_teeth.sums(rotation, arc, bands, runout, exponent=law.exponent)
    return Forces(tangential=found[0], feed=found[1], normal=found[2])


def _of_even_teeth(
    edges: CuttingEdges, places: Places, law: ForceLaw
) -> Callable[[Floats], Forces]:
    """Function that returns the forces of equal teeth at rotations, (M, K) in rad."""
    arc = places.entry_angle, places.exit_angle
    bands = _bands(edges, places.axial_depth, law)

    def at(rotation: Floats) -> Forces:
        found = even_teeth.sums(rotation, arc, bands, teeth=edges.teeth, exponent=law.exponent)
        return Forces(tangential=found[0], feed=found[1], normal=found[2])

    return at


def peak_resultant(
    edges: CuttingEdges, places: Places, law: ForceLaw, *, is_rough: bool = False
) -> Floats:
    """Greatest force across the axis within a revolution, (M,), mm, over ``K·k_c1.1·f_z^q``.

    The force is smooth between the rotations at which an end of an edge enters or exits the
    arc: it is sampled at these, between them, and more finely around the maximum. The rough
    search samples only these rotations and their midpoints; it is never too high and seldom 25
    % too low.
    """
    corners = np.sort(np.mod(_corners(edges, places), edges.pitch), axis=1)
    corners = np.concatenate((corners, corners[:, :1] + edges.pitch), axis=1)

    forces_at = _of_even_teeth(edges, places, law)

    def across(rotation: Floats) -> Floats:
        return forces_at(rotation).resultant

    return _greatest(across, corners, is_rough=is_rough)


def wall_force(
    edges: CuttingEdges, places: Places, law: ForceLaw, *, is_rough: bool = False
) -> Floats:
    """Greatest force normal to a wall while an edge cuts it, (M,), mm, over ``K·k_c1.1·f_z^q``.

    The edge at the height y generates the wall at the moment when it passes φ = 0 or π, [1]_:
    the deflection at this moment remains in the part. 0 where the arc reaches no wall. The
    rough search is that of :func:`peak_resultant`.
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
    """Greatest normal force while one edge passes an angle from its lower to its upper end."""
    span = np.minimum(edges.lag * places.axial_depth, edges.pitch)[:, None]
    inner = np.minimum(np.mod(_corners(edges, places) - angle, edges.pitch), span)
    corners = np.sort(np.concatenate((np.zeros_like(span), inner, span), axis=1), axis=1)

    forces_at = _of_even_teeth(edges, places, law)

    def normal(rotation: Floats) -> Floats:
        size: Floats = np.abs(forces_at(angle + rotation).normal)
        return size

    return _greatest(normal, corners, is_rough=is_rough)


def _corners(edges: CuttingEdges, places: Places) -> Floats:
    """Rotations at which the ends of an edge enter and exit the arc, (M, 4), rad."""
    lag = np.maximum(edges.lag * places.axial_depth, STRAIGHT)
    entry, exit_ = places.entry_angle, places.exit_angle
    return np.stack((entry, entry + lag, exit_, exit_ + lag), axis=1)


def _greatest(of: Callable[[Floats], Floats], corners: Floats, *, is_rough: bool) -> Floats:
    """Greatest value of a function that is smooth between ascending corners, (M,)."""
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
    """Bands of the edges within the depth of each engagement, rounded end first."""
    corner = np.minimum(depth, edges.corner_radius)
    heights, weights, sines = [np.zeros_like(depth)], [], []
    if edges.corner_radius > 0.0:
        # Spaced by the angle of the edge, so that bands are finest where it is flattest.
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
    # The component of the radial force in the plane depends on the slope of the edge.
    radial = law.radial_share * np.stack(sines, axis=1)
    return Bands(low=low, high=high, weight=np.stack(weights, axis=1), radial=radial)
