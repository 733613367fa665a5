"""Forces of every tooth of a milling cutter at given rotations, with runout.

The instantaneous side of :mod:`simulator.physics.milling_forces`, same angles and signs.
Straight edges, path of a tooth taken as a circle. Units mm, N, rad.

References
----------
.. [1] Y. Altintas, "Manufacturing Automation", Cambridge, 2012: forces of one tooth.
"""

from dataclasses import dataclass
from math import pi, sin

import numpy as np

from simulator.motion.segments import Floats
from simulator.physics.milling import MillingCut
from simulator.physics.milling_forces import ArcIntegrals, ToothLaw


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToothForces:
    """Forces of z teeth at M rotations."""

    angle: Floats
    """(M, z) rad, φ of each tooth, 0 to 2π"""
    tangential: Floats
    """(M, z) N, 0 out of cut"""
    radial: Floats
    """(M, z) N, in the plane of the feed"""

    @property
    def feed(self) -> Floats:
        """(M,) N of all teeth, against the feed."""
        forces = self.tangential * np.cos(self.angle) + self.radial * np.sin(self.angle)
        return np.asarray(forces.sum(axis=1))

    @property
    def normal(self) -> Floats:
        """(M,) N of all teeth, towards φ = 0."""
        forces = self.tangential * np.sin(self.angle) - self.radial * np.cos(self.angle)
        return np.asarray(forces.sum(axis=1))


def arcs_of(entry_angle: Floats, exit_angle: Floats) -> ArcIntegrals[Floats]:
    """Integrals over arcs of contact, (M,) angles in rad, as ``arc_integrals`` has them."""
    contact, both = exit_angle - entry_angle, entry_angle + exit_angle
    half = np.sin(0.5 * contact)
    return ArcIntegrals(
        contact=contact,
        sine=2.0 * np.sin(0.5 * both) * half,
        cosine=2.0 * np.cos(0.5 * both) * half,
        sine_squared=0.5 * (contact - np.cos(both) * np.sin(contact)),
        sine_cosine=0.5 * np.sin(both) * np.sin(contact),
    )


def tooth_angles(rotation: Floats, teeth: int) -> Floats:
    """(M, z) angles of evenly spaced teeth from 0 to 2π; each follows the one before it."""
    return np.mod(rotation[:, None] - 2.0 * pi / teeth * np.arange(teeth), 2.0 * pi)


def chip_thickness(angle: Floats, *, feed_per_tooth: Floats | float, runout: Floats) -> Floats:
    """Chip of each tooth on the surface that the teeth before it left.

    ``h_j = max(0, min over k = 1…z of k·f_z·sin φ + ρ_j − ρ_{j−k})``: a low tooth cuts less or
    nothing, and the next one cuts what it left, so that the chips of a revolution always add
    up to ``z·f_z·sin φ``.

    Parameters
    ----------
    angle : (M, z) array, rad
    feed_per_tooth : (M, 1) array or float, mm
    runout : (z,) array, mm
        ρ, radius of each tooth over the nominal one.

    Returns
    -------
    (M, z) array, mm
    """
    before = np.arange(1, len(runout) + 1)
    higher = np.array([runout - np.roll(runout, k) for k in before])
    feed = feed_per_tooth * np.sin(angle)
    above: Floats = (before[:, None, None] * feed + higher[:, None, :]).min(axis=0)
    return above.clip(min=0.0)


def tooth_forces(
    law: ToothLaw, cut: MillingCut, *, rotation: Floats, runout: Floats | None = None
) -> ToothForces:
    """Forces of every tooth while the cutter turns.

    Parameters
    ----------
    law : ToothLaw
    cut : MillingCut
        Feed, depth, arc of contact, number of teeth.
    rotation : (M,) array, rad
        Angle φ of the first tooth; may go on through many revolutions.
    runout : (z,) array, mm
        Radius of each tooth over the nominal one; none: all alike.

    Returns
    -------
    ToothForces

    Raises
    ------
    ValueError
        If there is not one runout for each tooth.
    """
    offsets = np.zeros(cut.teeth) if runout is None else runout
    if offsets.shape != (cut.teeth,):
        raise ValueError(f"runout has shape {offsets.shape} and must have ({cut.teeth},)")
    edge = sin(cut.cutting_edge_angle)
    angle = tooth_angles(rotation, cut.teeth)
    chip = edge * chip_thickness(angle, feed_per_tooth=cut.feed_per_tooth, runout=offsets)
    arc = cut.engagement
    in_cut = (chip > 0.0) & (angle >= arc.entry_angle) & (angle <= arc.exit_angle)
    shear = np.where(in_cut, chip ** (1.0 - law.m_c), 0.0)
    return ToothForces(
        angle=angle,
        tangential=cut.chip_width * (law.k_tc * shear + law.k_te * in_cut),
        radial=edge * cut.chip_width * (law.k_rc * shear + law.k_re * in_cut),
    )
