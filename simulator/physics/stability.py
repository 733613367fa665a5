"""Regenerative chatter in milling: stable depth of cut from the modes of the structure.

Uses the zero-order solution of [1]_: only the mean of the directional coefficients over a tooth
period is kept, which gives the stability border in closed form over the chatter frequency. This
is accurate while the cut is nearly continuous; below a radial width of a tenth of the diameter
the neglected harmonics add further lobes (period doubling, [2]_). Contact between flank and
wave, which adds damping at low speed, is neglected.

The feed is along x, and the angle φ of a tooth is defined as in
:mod:`simulator.physics.engagement`. The structure is flexible in the plane of the cut and rigid
along the spindle. Units mm, s, N, rad, rev/s.

Receptance of a structure over frequency, from the modes of a tap test.

Units mm, N, rad/s; natural frequencies in Hz, as measured.

References
----------
.. [1] Y. Altintas and E. Budak, "Analytical prediction of stability lobes in milling", CIRP
   Annals 44(1), 1995, 357-362, doi:10.1016/S0007-8506(07)62342-7; also Y. Altintas,
   "Manufacturing Automation", Cambridge, 2012, ch. 4.
.. [2] S. D. Merdol and Y. Altintas, "Multi frequency solution of chatter stability for low
   immersion milling", J. Manuf. Sci. Eng. 126 (2004), 459-466.
.. [3] R. L. Sisson and R. L. Kegg, "An explanation of low-speed chatter effects", J. Eng. Ind.
   91 (1969), 951-958: the flank of the tool meets the slope of the wave.
.. [4] Y. Altintas, "Manufacturing Automation", Cambridge, 2012, ch. 3: modes of a machine tool.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, cos, pi, sin

import numpy as np
from numpy.typing import NDArray

from simulator.physics.domain import (
    require_not_negative,
    require_positive,
    require_teeth,
)
from simulator.physics.engagement import Engagement
from simulator.spec import VibrationMode

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

SAMPLES = 240
"""Number of sampled chatter frequencies on either side of a mode."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModalStructure:
    """Measured modes in the plane of the cut; a direction without modes is rigid."""

    x: tuple[VibrationMode, ...]
    y: tuple[VibrationMode, ...]

    def __post_init__(self) -> None:
        if not self.x and not self.y:
            raise ValueError("a structure needs at least one mode")


def receptance(modes: Sequence[VibrationMode], frequency: Floats) -> Complex:
    """Receptance over frequency: deflection per force, summed over the modes.

    ``Φ = Σ (ω_n²/k) / (ω_n² − ω² + 2iζ·ω_n·ω)``, [4]_.

    Parameters
    ----------
    frequency : (N,) array, rad/s

    Returns
    -------
    (N,) complex array, mm/N
    """
    total = np.zeros(frequency.shape, dtype=np.complex128)
    for mode in modes:
        natural = 2.0 * pi * mode.natural_frequency
        damping = 2j * mode.damping_ratio * natural * frequency
        total += natural**2 / mode.stiffness / (natural**2 - frequency**2 + damping)
    return total


def chatter_frequencies(modes: Sequence[VibrationMode]) -> Floats:
    """Frequencies at which chatter is searched: dense around each mode, sparse elsewhere.

    Returns
    -------
    (N,) array, rad/s
        Ascending.
    """
    reach = np.sinh(np.linspace(-8.0, 8.0, 2 * SAMPLES + 1))
    natural = np.array([2.0 * pi * mode.natural_frequency for mode in modes])
    damping = np.array([mode.damping_ratio for mode in modes])
    near = (natural[:, None] * (1.0 + damping[:, None] * reach[None, :])).ravel()
    low, high = 0.05 * natural.min(), 10.0 * natural.max()
    found = np.concatenate([near, np.geomspace(low, high, 2 * SAMPLES)])
    return np.unique(found[(found >= low) & (found <= high)])


LEAST_IMMERSION = 0.1
"""Least a_e/D for which zero order is used; [2]_ shows its error for small immersions."""

DAMPED_WAVELENGTH = 0.5
"""Wavelength on the surface, mm, below which the flank damps: at an amplitude of 14 µm its
slope equals a clearance angle of 10°, [3]_; conservative, as waves grow until the chip is
lost."""

MOST_LOBES = 150
"""Number of lobes, counted from the fastest; at lower speeds the least depth applies."""

MOST_DEPTH = 1e4
"""Depth, mm, that stands for a depth not limited by any mode."""

FEED_ANGLES = 12
"""Number of feed directions tried between 0 and π."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DynamicCut:
    """Milling cut as needed for its dynamic response to a wave on the surface."""

    engagement: Engagement
    teeth: int
    stiffness: float
    """Cutting stiffness K_t: tangential force per mm of depth and mm of chip, N/mm²."""
    radial_ratio: float
    """Ratio K_r of radial to tangential force."""

    def __post_init__(self) -> None:
        require_teeth(self.teeth)
        require_positive(self.stiffness, "cutting stiffness", "N/mm²")
        require_not_negative(self.radial_ratio, "radial ratio", "")


@dataclass(frozen=True, slots=True, kw_only=True)
class Border:
    """Stability border over the chatter frequency; NaN where there is none."""

    frequency: Floats
    """Chatter frequency ω_c, (N,), rad/s, ascending."""
    depth: Floats
    """Limit of the depth of cut, (N,), mm."""
    phase: Floats
    """Phase ε between two successive waves, (N,), rad, 0 to 2π."""


def directional_coefficients(engagement: Engagement, radial_ratio: float) -> Floats:
    """Mean directional coefficients of a cut, times 2π over the number of teeth.

    ``α_xx = ½·[cos 2φ − 2K_r·φ + K_r·sin 2φ]``, ``α_xy = ½·[−sin 2φ − 2φ + K_r·cos 2φ]``,
    ``α_yx = ½·[−sin 2φ + 2φ + K_r·cos 2φ]``, ``α_yy = ½·[−cos 2φ − 2K_r·φ − K_r·sin 2φ]``
    from φ_st to φ_ex, [1]_.

    Parameters
    ----------
    radial_ratio : float
        Ratio K_r.

    Returns
    -------
    (2, 2) array

    Examples
    --------
    In a slot only the radial force acts along its own deflection.

    >>> from simulator.physics.engagement import full_immersion
    >>> (directional_coefficients(full_immersion(), 0.3) / pi).round(6) + 0.0
    array([[-0.3, -1. ],
           [ 1. , -0.3]])
    """
    k_r = radial_ratio

    def primitive(angle: float) -> Floats:
        s, c = sin(2.0 * angle), cos(2.0 * angle)
        return 0.5 * np.array([
            [c - 2.0 * k_r * angle + k_r * s, -s - 2.0 * angle + k_r * c],
            [-s + 2.0 * angle + k_r * c, -c - 2.0 * k_r * angle - k_r * s],
        ])

    return primitive(engagement.exit_angle) - primitive(engagement.entry_angle)


def borders(
    cut: DynamicCut, structure: ModalStructure, *, feed_angle: float = 0.0
) -> tuple[Border, Border]:
    """Stability border for each of the two eigenvalues, over the chatter frequency.

    ``a_lim = −2π·Λ_R/(z·K_t)·(1 + (Λ_I/Λ_R)²)`` with Λ from
    ``det(I + Λ·[α][Φ(iω_c)]) = 0``, and ``ε = π − 2·atan(Λ_I/Λ_R)``, [1]_.

    Parameters
    ----------
    structure : ModalStructure
        Modes along x and y of the machine.
    feed_angle : float, rad
        Angle from x of the machine to the feed.

    Returns
    -------
    tuple of two Border
    """
    frequency = chatter_frequencies((*structure.x, *structure.y))
    along, across = (receptance(modes, frequency) for modes in (structure.x, structure.y))
    c, s = cos(feed_angle), sin(feed_angle)
    # Symmetric receptance in feed coordinates: R·diag(Φ_x, Φ_y)·Rᵀ.
    xx = c * c * along + s * s * across
    yy = s * s * along + c * c * across
    xy = c * s * (across - along)
    alpha = directional_coefficients(cut.engagement, cut.radial_ratio)
    trace = alpha[0, 0] * xx + (alpha[0, 1] + alpha[1, 0]) * xy + alpha[1, 1] * yy
    product = (alpha[0, 0] * alpha[1, 1] - alpha[0, 1] * alpha[1, 0]) * along * across
    root = np.sqrt(trace**2 - 4.0 * product)
    one, other = _continuous(0.5 * (trace + root), 0.5 * (trace - root))
    return _border(cut, frequency, one), _border(cut, frequency, other)


def least_stable_depth(cut: DynamicCut, structure: ModalStructure) -> float:
    """Depth of cut that is stable at any spindle speed and in any feed direction, mm."""
    least = min(
        float(np.nanmin(border.depth, initial=MOST_DEPTH))
        for angle in _feed_angles(structure)
        for border in borders(cut, structure, feed_angle=angle)
    )
    return min(least, MOST_DEPTH)


def stable_depths(
    cut: DynamicCut, structure: ModalStructure, speeds: Floats, *, tolerance: float = 0.0
) -> Floats:
    """Greatest stable depth at each spindle speed: the minimum over all lobes, [1]_.

    Lobe k is ``n = ω_c / (z·(ε + 2kπ))``. All lobes are evaluated at the given speeds; the
    least depth counts, in the worst feed direction.

    Parameters
    ----------
    speeds : (N,) array, rev/s
        Ascending, positive.
    tolerance : float
        Relative uncertainty of the natural frequencies: scaling all of them scales the speeds
        of the lobes, so the least depth within this share of a speed counts.

    Returns
    -------
    (N,) array, mm
        :data:`MOST_DEPTH` where no lobe is a limit.

    Examples
    --------
    >>> from simulator.physics.engagement import full_immersion
    >>> from simulator.spec import ModeDirection, VibratingPart, VibrationMode
    >>> mode = VibrationMode(
    ...     part=VibratingPart.TOOL, direction=ModeDirection.XY, natural_frequency=600.0,
    ...     damping_ratio=0.03, stiffness=10_000.0, source="example",
    ... )
    >>> slot = DynamicCut(
    ...     engagement=full_immersion(), teeth=4, stiffness=800.0, radial_ratio=0.3
    ... )
    >>> speeds = np.array([100.0, 150.0])  # the tooth period is the mode's at 150 rev/s
    >>> stable_depths(slot, ModalStructure(x=(mode,), y=(mode,)), speeds).round(2)
    array([0.37, 4.18])
    """
    drawn = np.full(speeds.shape, MOST_DEPTH)
    for angle in _feed_angles(structure):
        for border in borders(cut, structure, feed_angle=angle):
            _draw(drawn, speeds, border, teeth=cut.teeth)
    slowest = speeds < _slowest_lobe((*structure.x, *structure.y), cut.teeth)
    if slowest.any():
        drawn[slowest] = least_stable_depth(cut, structure)
    if tolerance <= 0.0:
        return drawn
    low = np.searchsorted(speeds, speeds * (1.0 - tolerance), side="left")
    high = np.searchsorted(speeds, speeds * (1.0 + tolerance), side="right")
    return np.array([drawn[a:b].min() for a, b in zip(low, high, strict=True)])


def lobes(
    cut: DynamicCut,
    structure: ModalStructure,
    *,
    between: tuple[float, float],
    step: float,
    tolerance: float,
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Geometrically spaced speeds in a range, and the stable depth at each, as plain numbers.

    Parameters
    ----------
    between : (float, float), rev/s
        Lowest and highest speed; they may be equal.
    step : float
        Relative distance between neighbouring speeds.
    tolerance : float
        As in :func:`stable_depths`.

    Returns
    -------
    tuple of float, rev/s, and tuple of float, mm
    """
    low, high = between
    beyond = np.log1p(tolerance) + 2.0 * step
    count = ceil((np.log(high / low) + 2.0 * beyond) / step) + 1
    speeds = np.geomspace(low * np.exp(-beyond), high * np.exp(beyond), count)
    depths = stable_depths(cut, structure, speeds, tolerance=tolerance)
    ends = np.array([low, high])
    inner = (speeds > low) & (speeds < high)
    found = np.concatenate([ends[:1], speeds[inner], ends[1:]])
    at_ends = np.interp(ends, speeds, depths)
    shown = np.concatenate([at_ends[:1], depths[inner], at_ends[1:]])
    return tuple(found.tolist()), tuple(shown.tolist())


def damped_speed(modes: Sequence[VibrationMode], diameter: float) -> float:
    """Spindle speed below which contact of the flank damps every mode, rev/s.

    The wavelength on the surface is ``v_c/f``; below :data:`DAMPED_WAVELENGTH` the flank meets
    the slope of the wave, [3]_. The slowest mode decides: all others are damped before it.

    Parameters
    ----------
    diameter : float, mm
        Diameter at which the cutting speed is taken.

    Raises
    ------
    ValueError
        If the diameter is not positive.
    """
    require_positive(diameter, "diameter", "mm")
    slowest = min(mode.natural_frequency for mode in modes)
    return DAMPED_WAVELENGTH * slowest / (pi * diameter)


def _continuous(one: Complex, other: Complex) -> tuple[Complex, Complex]:
    """Order two eigenvalues continuously over frequency: the branch of the root may change."""
    stays = np.abs(np.diff(one)) + np.abs(np.diff(other))
    crosses = np.abs(one[1:] - other[:-1]) + np.abs(other[1:] - one[:-1])
    swapped = np.concatenate([[False], np.cumsum(crosses < stays) % 2 == 1])
    return np.where(swapped, other, one), np.where(swapped, one, other)


def _border(cut: DynamicCut, frequency: Floats, eigenvalue: Complex) -> Border:
    """Stability border of one eigenvalue μ of [α][Φ]; ``Λ = −1/μ``."""
    with np.errstate(divide="ignore", invalid="ignore"):
        root = -1.0 / eigenvalue
        ratio = root.imag / root.real
        depth = -2.0 * pi * root.real / (cut.teeth * cut.stiffness) * (1.0 + ratio**2)
        exists = (root.real < 0.0) & np.isfinite(depth)
    return Border(
        frequency=frequency,
        depth=np.where(exists, depth, np.nan),
        phase=np.where(exists, pi - 2.0 * np.arctan(ratio), np.nan),
    )


def _feed_angles(structure: ModalStructure) -> tuple[float, ...]:
    """Feed directions to be tried; a single one if the structure is the same along x and y."""
    alike = [(m.natural_frequency, m.damping_ratio, m.stiffness) for m in structure.x] == [
        (m.natural_frequency, m.damping_ratio, m.stiffness) for m in structure.y
    ]
    return (0.0,) if alike else tuple(pi * i / FEED_ANGLES for i in range(FEED_ANGLES))


def _slowest_lobe(modes: Sequence[VibrationMode], teeth: int) -> float:
    """Speed below which lobes beyond ``MOST_LOBES`` begin, rev/s."""
    fastest = max(mode.natural_frequency for mode in modes)
    return fastest / (teeth * MOST_LOBES)


def _draw(drawn: Floats, speeds: Floats, border: Border, *, teeth: int) -> None:
    """Lower the depths to all lobes of a border, linear between chatter frequencies."""
    slowest = float(speeds[0]) * teeth
    count = min(MOST_LOBES, ceil(float(border.frequency[-1]) / (2.0 * pi * slowest)) + 1)
    turns = 2.0 * pi * np.arange(count)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        n = border.frequency / (teeth * (border.phase + turns))
    depth = np.broadcast_to(border.depth, n.shape)
    n1, n2, d1, d2 = (
        part.ravel() for part in (n[:, :-1], n[:, 1:], depth[:, :-1], depth[:, 1:])
    )
    kept = np.isfinite(n1) & np.isfinite(n2)
    n1, n2, d1, d2 = n1[kept], n2[kept], d1[kept], d2[kept]
    first = np.searchsorted(speeds, np.minimum(n1, n2), side="left")
    counts = np.searchsorted(speeds, np.maximum(n1, n2), side="right") - first
    # One row for each speed that a piece of a lobe passes.
    row = np.repeat(np.arange(len(n1)), counts)
    start = np.cumsum(counts) - counts
    at = first[row] + np.arange(len(row)) - start[row]
    span = np.where(n2 == n1, 1.0, n2 - n1)
    share = np.clip((speeds[at] - n1[row]) / span[row], 0.0, 1.0)
    np.minimum.at(drawn, at, d1[row] + share * (d2[row] - d1[row]))
