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

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import ceil, pi, sin

import numpy as np
from numpy.typing import NDArray

from simulator.physics.domain import require_teeth
from simulator.physics.flutes import WALL, CuttingEdges, Law

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

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(6)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Places:
    """M engagements of a cutter."""

    entry_angle: Floats
    """(M,) φ_st, rad"""
    exit_angle: Floats
    """(M,) φ_ex, rad"""
    axial_depth: Floats
    """(M,) a_p, mm"""

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
    """(M,) ∫dφ, rad"""
    sine: Floats
    """(M,) ∫sin φ dφ = C"""
    cosine: Floats
    """(M,) ∫cos φ dφ"""
    sine_squared: Floats
    """(M,) ∫sin² φ dφ"""
    sine_cosine: Floats
    """(M,) ∫sin φ·cos φ dφ"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Forces:
    """Sums over all teeth at K rotations of M places, over ``K·k_c1.1·f_z^q``."""

    tangential: Floats
    """(M, K) mm"""
    feed: Floats
    """(M, K) mm, against the feed"""
    normal: Floats
    """(M, K) mm, towards φ = 0"""

    @property
    def resultant(self) -> Floats:
        """(M, K) mm, across the axis."""
        across: Floats = np.hypot(self.feed, self.normal)
        return across


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Runout:
    """Unequal teeth."""

    offsets: Floats
    """(z,) mm, ρ: radius of each tooth over the nominal one"""
    feed_per_tooth: Floats
    """(M,) f_z, mm"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Band:
    """A stretch of the edge by its height, as seen at M places."""

    low: Floats
    """(M, 1) rad, lag of its lower end"""
    high: Floats
    """(M, 1) rad"""
    weight: Floats
    """(M, 1) mm, ∫sin^(q−1) κ dy"""
    sine: Floats
    """(M, 1) mean sin κ: the radial force acts in the plane by it"""


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


def eccentric_runout(eccentricity: float, teeth: int) -> Floats:
    """Radius of each tooth over the nominal one when a cutter's axis is off the spindle's.

    ``ρ_j = ρ·cos(2π·j/z)``, tooth 0 the highest.

    Parameters
    ----------
    eccentricity : float, mm
        ρ; 0.005 to 0.01 mm as a rule.
    teeth : int

    Returns
    -------
    (z,) array, mm

    Raises
    ------
    ValueError
        When the eccentricity is negative or there is no tooth.
    """
    if not eccentricity >= 0.0:
        raise ValueError(f"eccentricity {eccentricity:g} mm must not be negative")
    require_teeth(teeth)
    return eccentricity * np.cos(2.0 * pi / teeth * np.arange(teeth, dtype=np.float64))


def forces(
    edges: CuttingEdges,
    places: Places,
    law: Law,
    *,
    rotation: Floats,
    runout: Runout | None = None,
) -> Forces:
    """Forces while the cutter turns.

    The edges in the cut are integrated by Gauss between the ends of the arc: exact but for the
    root of sin φ at its ends and the corners that runout makes.

    Parameters
    ----------
    edges : CuttingEdges
    places : Places
    law : Law
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
    >>> found = forces(one, slot, Law(exponent=1.0), rotation=np.array([[0.5 * pi]]))
    >>> round(float(found.tangential[0, 0]), 6), round(float(found.feed[0, 0]), 6)
    (2.0, 0.6)
    """
    if runout is not None and runout.offsets.shape != (edges.teeth,):
        shape = runout.offsets.shape
        raise ValueError(f"runout has shape {shape} and must have ({edges.teeth},)")
    bands = list(_bands(edges, places.axial_depth, law.exponent))
    turns = ceil((pi + max(float(band.high.max(initial=0.0)) for band in bands)) / (2.0 * pi))
    tooth = np.repeat(np.arange(edges.teeth), turns)
    tip = np.mod(rotation[..., None] - tooth * edges.pitch, 2.0 * pi)
    tip += 2.0 * pi * np.tile(np.arange(turns), edges.teeth)
    entry, exit_ = places.entry_angle[:, None, None], places.exit_angle[:, None, None]
    totals = np.zeros((3, rotation.size))
    for band in bands:
        bottom = np.maximum(tip - band.high[..., None], entry)
        length = np.minimum(tip - band.low[..., None], exit_) - bottom
        at = np.nonzero(length > 0.0)
        row, within = at[0], length[at]
        angle = bottom[at][:, None] + within[:, None] * _NODES
        sine, cosine = np.sin(angle), np.cos(angle)
        chip = np.maximum(sine, 0.0)
        if runout is not None:
            chip = _uneven(sine, runout, row=row, tooth=tooth[at[2]])
        share = (band.weight / (band.high - band.low))[row, 0] * within
        shear = share[:, None] * chip**law.exponent
        radial = law.radial_share * band.sine[row]
        # Several teeth may be in the cut at one rotation.
        target = np.ravel_multi_index(at[:2], rotation.shape)
        parts = (
            shear,
            shear * (cosine + radial * sine),
            shear * (sine - radial * cosine),
        )
        for index, part in enumerate(parts):
            totals[index] += np.bincount(target, part @ _WEIGHTS, minlength=rotation.size)
    tangential, feed, normal = totals.reshape(3, *rotation.shape)
    return Forces(tangential=tangential, feed=feed, normal=normal)


def _uneven(sine: Floats, runout: Runout, *, row: Ints, tooth: Ints) -> Floats:
    """Chips of N stretches of edge over f_z on the surface that the teeth before them left.

    ``h_j = max(0, min over k = 1…z of k·f_z·sin φ + ρ_j − ρ_{j−k})``: a low tooth cuts less or
    nothing, and the next one cuts what it left, so that the chips of a revolution always add
    up to ``z·f_z·sin φ``.
    """
    offsets = runout.offsets
    chip = np.full(sine.shape, np.inf)
    for before in range(1, len(offsets) + 1):
        higher = (offsets - np.roll(offsets, before))[tooth] / runout.feed_per_tooth[row]
        np.minimum(chip, before * sine + higher[:, None], out=chip)
    return chip.clip(min=0.0)


def peak_resultant(
    edges: CuttingEdges, places: Places, law: Law, *, is_rough: bool = False
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
    edges: CuttingEdges, places: Places, law: Law, *, is_rough: bool = False
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
    edges: CuttingEdges, places: Places, law: Law, angle: float, *, is_rough: bool
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


def _bands(edges: CuttingEdges, depth: Floats, exponent: float) -> Iterator[_Band]:
    """Bands of the edges down to which each place reaches, rounded end first."""
    corner = np.minimum(depth, edges.corner_radius)
    if edges.corner_radius > 0.0:
        # By the angle of the edge, so that bands are finest where it is flattest.
        steepest = np.arccos(1.0 - corner / edges.corner_radius)
        for band in range(CORNER_BANDS):
            ends = steepest * band / CORNER_BANDS, steepest * (band + 1) / CORNER_BANDS
            sine = np.sin(0.5 * (ends[0] + ends[1]))
            yield _band(
                edges,
                *(edges.corner_radius * (1.0 - np.cos(end)) for end in ends),
                weight=edges.corner_radius * (ends[1] - ends[0]) * sine**exponent,
                sine=sine,
            )
    slope = sin(edges.cutting_edge_angle)
    rest = depth - corner
    yield _band(
        edges,
        corner,
        depth,
        weight=rest * slope ** (exponent - 1.0),
        sine=np.full(len(depth), slope),
    )


def _band(
    edges: CuttingEdges, bottom: Floats, top: Floats, *, weight: Floats, sine: Floats
) -> _Band:
    low = edges.lag * bottom
    high = np.maximum(edges.lag * top, low + STRAIGHT)
    return _Band(
        low=low[:, None], high=high[:, None], weight=weight[:, None], sine=sine[:, None]
    )
