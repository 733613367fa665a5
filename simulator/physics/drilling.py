"""Torque and thrust of tools that cut with their end: drills, reamers, boring bars, sinks.

Each lip cuts a chip of thickness ``h = f/z·sin κ`` and width ``b = (D − d)/(2·sin κ)``, where κ
is half the point angle and d the diameter of the existing hole. Between the lips a drill has a
chisel edge of length c, which displaces material rather than cutting it. Its contribution to
torque and thrust follows the factors tabulated over c/D in [1]_; it vanishes if an existing
hole is wider than the chisel edge. Units mm, N, N·mm and rad.

References
----------
.. [1] Machinery's Handbook, 31st ed., pp. 1152-1153, "Machining power", tables 7 to 9:
   ``T = 0.05·K_d·F_f·F_T·B + 0.007·K_d·D²·J`` in N and ``M = 0.000025·K_d·F_f·F_M·A`` in N·m,
   with F_f = f^0.8, F_T = D^0.8 and F_M = D^1.8 in mm.
.. [2] Sandvik Coromant, technical guide, drilling formulae:
   ``P_c = f·v_c·D·k_c/(240·10³)`` in kW and ``F_f ≈ 0.5·k_c·D/2·f·sin κ``.
.. [3] Tungaloy, general catalogue 2020-2021, p. L068: ``M_c = K·D²·(0.630 + 16.84·f)/100`` in
   N·m and ``T_c = 570·K·D·f^0.85`` in N, twist drills.
.. [4] "Common drilling formulas", a page of workshop formulae: ``F_f = 0.7·D/2·f·k_c``.
"""

from bisect import bisect_left
from dataclasses import dataclass
from math import pi, sin

from simulator.physics.cutting import specific_cutting_force
from simulator.physics.domain import (
    require_edge_angle,
    require_hole,
    require_positive,
    require_teeth,
)
from simulator.physics.drive import Value
from simulator.spec import Kienzle, ToolKind
from simulator.tool_windows import DrillPoint
from stepnc_model.units import rad_from_deg

CUSTOMARY_EDGE_ANGLE = rad_from_deg(59.0)  # half of the customary point angle of 118°

LIPS_ONLY = DrillPoint(thrust_share=0.5 / sin(CUSTOMARY_EDGE_ANGLE), chisel_ratio=0.0)
"""Point geometry for tools of unknown type. The share, 0.583, follows from [1]_ without
chisel edge: ``0.05·K_d·F_f·F_T`` is half of the lips' tangential force at a 118° point."""

REFERENCE_FEED = 0.2
"""Feed f₀ at which K_d of [1]_ is derived from k_c, mm: the middle of its table 8."""


def edge_angle(kind: ToolKind, point_angle: float | None) -> float:
    """Lip angle κ of a tool that cuts with its end, rad: half its point angle.

    Parameters
    ----------
    point_angle : float, rad, or None
        None: customary value for a drill, flat for a reamer or a counterbore.
    """
    if point_angle:
        return 0.5 * point_angle
    return CUSTOMARY_EDGE_ANGLE if kind is ToolKind.DRILL else 0.5 * pi


@dataclass(frozen=True, slots=True, kw_only=True)
class ChiselFactors:
    """Factors of a chisel edge, [1]_ table 7."""

    torque: float
    """Factor A on the torque of the lips."""
    thrust: float
    """Factor B on the thrust of the lips."""
    constant: float
    """Factor J of the thrust that does not depend on the feed."""


NO_CHISEL = ChiselFactors(torque=1.0, thrust=1.0, constant=0.0)

CHISEL_RATIOS = (0.0, 0.03, 0.05, 0.08, 0.10, 0.13, 0.15, 0.18, 0.20, 0.25, 0.30, 0.35, 0.40)
"""Ratios c/D of [1]_ table 7, with 0 added; 0.18 for standard drills, 0.03 for split points."""

CHISEL_FACTORS = (
    NO_CHISEL,
    ChiselFactors(torque=1.000, thrust=1.100, constant=0.001),
    ChiselFactors(torque=1.005, thrust=1.140, constant=0.003),
    ChiselFactors(torque=1.015, thrust=1.200, constant=0.006),
    ChiselFactors(torque=1.020, thrust=1.235, constant=0.010),
    ChiselFactors(torque=1.040, thrust=1.270, constant=0.017),
    ChiselFactors(torque=1.080, thrust=1.310, constant=0.022),
    ChiselFactors(torque=1.085, thrust=1.355, constant=0.030),
    ChiselFactors(torque=1.105, thrust=1.380, constant=0.040),
    ChiselFactors(torque=1.155, thrust=1.445, constant=0.065),
    ChiselFactors(torque=1.235, thrust=1.500, constant=0.090),
    ChiselFactors(torque=1.310, thrust=1.575, constant=0.120),
    ChiselFactors(torque=1.395, thrust=1.620, constant=0.160),
)
"""Factors A, B and J of [1]_ table 7, one row for each of ``CHISEL_RATIOS``."""

_CONSTANT_SCALE = 0.007 * 5.0 * REFERENCE_FEED**0.2  # see constant_thrust
_CONSTANT_EXPONENT = 2.2


@dataclass(frozen=True, slots=True, kw_only=True)
class DrillingCut:
    """Cut of a drill, reamer or boring bar."""

    feed_per_revolution: float
    """Feed per revolution f, mm."""
    tool_diameter: float
    """Diameter of the tool D, mm."""
    previous_diameter: float = 0.0
    """Diameter of the existing hole d, mm; 0 in solid material."""
    teeth: int = 2
    """Number of lips z."""
    cutting_edge_angle: float = CUSTOMARY_EDGE_ANGLE
    """Lip angle κ, half the point angle, rad; π/2 for a boring bar."""
    point: DrillPoint = LIPS_ONLY

    def __post_init__(self) -> None:
        require_positive(self.feed_per_revolution, "feed per revolution", "mm")
        require_hole(self.tool_diameter, self.previous_diameter)
        require_teeth(self.teeth)
        require_edge_angle(self.cutting_edge_angle)
        require_positive(self.point.thrust_share, "thrust share", "")

    @property
    def chip_thickness(self) -> float:
        """Chip thickness ``h = f/z · sin κ``, mm."""
        return self.feed_per_revolution / self.teeth * sin(self.cutting_edge_angle)

    @property
    def chisel(self) -> ChiselFactors:
        """Factors of the chisel edge if it meets material, otherwise of no chisel edge."""
        if self.previous_diameter > self.point.chisel_ratio * self.tool_diameter:
            return NO_CHISEL
        return chisel_factors(self.point.chisel_ratio)


def chisel_factors(chisel_ratio: float) -> ChiselFactors:
    """Factors of a chisel edge, interpolated linearly in [1]_ table 7.

    Parameters
    ----------
    chisel_ratio : float
        Length of the chisel edge over the diameter, c/D, 0 to 0.4.

    Returns
    -------
    ChiselFactors

    Raises
    ------
    ValueError
        If the ratio is outside the table.

    Examples
    --------
    >>> chisel_factors(0.18)
    ChiselFactors(torque=1.085, thrust=1.355, constant=0.03)
    """
    if not 0.0 <= chisel_ratio <= CHISEL_RATIOS[-1]:
        raise ValueError(
            f"chisel ratio {chisel_ratio:g} must be at least 0 and at most "
            f"{CHISEL_RATIOS[-1]:g}"
        )
    row = bisect_left(CHISEL_RATIOS, chisel_ratio)
    above = CHISEL_FACTORS[row]
    if CHISEL_RATIOS[row] == chisel_ratio:
        return above
    below = CHISEL_FACTORS[row - 1]
    step = CHISEL_RATIOS[row] - CHISEL_RATIOS[row - 1]
    part = (chisel_ratio - CHISEL_RATIOS[row - 1]) / step
    return ChiselFactors(
        torque=below.torque + part * (above.torque - below.torque),
        thrust=below.thrust + part * (above.thrust - below.thrust),
        constant=below.constant + part * (above.constant - below.constant),
    )


def drilling_specific_force(
    kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0
) -> float:
    """Specific cutting force on the lips, ``K · k_c1.1 · h^(−m_c)``.

    Parameters
    ----------
    factor : float
        Factor K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N/mm²

    Raises
    ------
    ValueError
        If the factor is not positive.
    """
    require_positive(factor, "force factor", "")
    return factor * specific_cutting_force(
        cut.chip_thickness, k_c11=kienzle.k_c11, m_c=kienzle.m_c
    )


def drilling_torque(kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0) -> float:
    """Drilling torque about the axis.

    ``M_c = A · k_c · f · (D² − d²) / 8``: z chips of area ``b·h`` at the middle of their lips,
    ``(D + d)/4`` from the axis, plus the chisel edge. Multiplied by ``2π·n`` it gives
    ``A·k_c·Q``, which for d = 0 and A = 1 is the power of [2]_.

    Parameters
    ----------
    factor : float
        Factor K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N·mm

    Raises
    ------
    ValueError
        If the factor is not positive.

    Examples
    --------
    >>> hole = DrillingCut(feed_per_revolution=0.2, tool_diameter=10.0)
    >>> drilling_torque(Kienzle(k_c11=2000.0, m_c=0.0), hole)
    5000.0
    """
    k_c = drilling_specific_force(kienzle, cut, factor=factor)
    section = cut.tool_diameter**2 - cut.previous_diameter**2
    return cut.chisel.torque * k_c * cut.feed_per_revolution * section / 8.0


def lip_thrust(kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0) -> float:
    """Part of the thrust that increases with the feed.

    ``s · B · k_c · f · (D − d)/2 · sin κ``, in the form of [2]_ with the factors of [1]_.

    Parameters
    ----------
    factor : float
        Factor K of :class:`~simulator.physics.cutting.ForceCorrection`.

    Returns
    -------
    float, N

    Raises
    ------
    ValueError
        If the factor is not positive.
    """
    k_c = drilling_specific_force(kienzle, cut, factor=factor)
    depth = 0.5 * (cut.tool_diameter - cut.previous_diameter)
    share = cut.point.thrust_share * cut.chisel.thrust * sin(cut.cutting_edge_angle)
    return share * k_c * cut.feed_per_revolution * depth


def constant_thrust(
    kienzle: Kienzle, diameter: Value, *, lip_sine: Value, teeth: int, constant: float
) -> Value:
    """Part of the thrust caused by the chisel edge, independent of the feed.

    ``0.007 · K_d · D² · J`` of [1]_, where ``K_d = 5·k_c·(f₀·D)^0.2`` is chosen such that its
    torque ``0.000025·K_d·f^0.8·D^1.8`` N·m equals ``k_c·f·D²/8`` at the feed f₀. Arithmetic
    only.

    Parameters
    ----------
    diameter : float or array, mm
        Diameter D; while the tool enters, at most its own.
    lip_sine : float or array
        Sine of the lip angle, sin κ.
    teeth : int
        Number of lips.
    constant : float
        Factor J of :class:`ChiselFactors`.

    Returns
    -------
    float or array, N
    """
    chip = REFERENCE_FEED / teeth * lip_sine
    k_c = kienzle.k_c11 * chip ** (-kienzle.m_c)
    force: Value = _CONSTANT_SCALE * constant * k_c * diameter**_CONSTANT_EXPONENT
    return force


def chisel_thrust(kienzle: Kienzle, cut: DrillingCut, *, factor: float = 1.0) -> float:
    """Part of the thrust independent of the feed, N: :func:`constant_thrust` of a cut.

    Raises
    ------
    ValueError
        If the factor is not positive.
    """
    require_positive(factor, "force factor", "")
    return factor * constant_thrust(
        kienzle,
        cut.tool_diameter,
        lip_sine=sin(cut.cutting_edge_angle),
        teeth=cut.teeth,
        constant=cut.chisel.constant,
    )
