"""Chatter stability of a cut: the measured modes that apply, and the depth they allow.

Only measured modes limit the depth: by zero-order lobes in milling, by the orthogonal limit at
any speed in turning. Without them, the tool's overhang gives an estimate of the depth that is
stable at any speed, with its band; it limits nothing, because it would forbid nearly every
slot. The zero-order model is not used for thin cuts and for speeds with process damping; a
message says so.

Selection of the measured modes of a machine that apply to a cut.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from math import inf, sin, sqrt
from typing import TYPE_CHECKING

from optimiser.bounds.chip_load import least_chip, least_feed
from optimiser.bounds.limits import force_factor
from optimiser.bounds.speed_limits import speed_range
from optimiser.cuts.conditions import CuttingConditions
from optimiser.cuts.cut import Cut, CutKind
from optimiser.solver.problem import Limit, LimitName, Monomial, SpeedCurve
from simulator.physics.cutting import chip_stiffness
from simulator.physics.engagement import mean_chip_ratio
from simulator.physics.milling import RADIAL_SHARE
from simulator.physics.strength import customary_overhang, deflection, equivalent_diameter
from simulator.spec import (
    Machine,
    ModeDirection,
    ToolGrade,
    ToolKind,
    VibratingPart,
    VibrationMode,
)
from stepnc_model.plurals import counted
from stepnc_model.programs.tool import Tool
from stepnc_model.units import n_um_from_n_mm, rpm_from_rev_s

if TYPE_CHECKING:
    from simulator.physics.stability import DynamicCut, ModalStructure


SAME_DIAMETER = 1e-3
"""Tolerance within which tool diameters are equal, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredModes:
    """Measured vibration modes that apply to one cut, along the axes of the machine."""

    x: tuple[VibrationMode, ...]
    y: tuple[VibrationMode, ...]
    z: tuple[VibrationMode, ...]

    @property
    def in_plane(self) -> tuple[VibrationMode, ...]:
        """Modes that affect milling, each once."""
        return tuple(dict.fromkeys((*self.x, *self.y)))

    @property
    def along_axis(self) -> tuple[VibrationMode, ...]:
        """Modes that affect turning, each once."""
        return tuple(dict.fromkeys((*self.x, *self.z)))


def measured_modes(cut: Cut, machine: Machine) -> MeasuredModes | None:
    """Measured modes that apply to a cut: those that name its tool, or else its diameter."""
    if cut.kind not in {CutKind.MILLING, CutKind.TURNING}:
        return None
    fitting = [mode for mode in machine.modes if _is_of(mode, cut.tool)]
    named = [mode for mode in fitting if mode.tool]
    work = [mode for mode in machine.modes if mode.part is VibratingPart.WORKPIECE]
    kept = (*(named or fitting), *work)
    found = MeasuredModes(
        x=tuple(mode for mode in kept if mode.direction in {ModeDirection.X, ModeDirection.XY}),
        y=tuple(mode for mode in kept if mode.direction in {ModeDirection.Y, ModeDirection.XY}),
        z=tuple(mode for mode in kept if mode.direction is ModeDirection.Z),
    )
    felt = found.in_plane if cut.kind is CutKind.MILLING else found.along_axis
    return found if felt else None


def _is_of(mode: VibrationMode, tool: Tool) -> bool:
    """True if a mode was measured on a given tool."""
    if mode.part is not VibratingPart.TOOL:
        return False
    if mode.tool and mode.tool.casefold() != tool.id.strip().casefold():
        return False
    diameter = mode.tool_diameter
    return diameter is None or abs(diameter - tool.diameter) <= SAME_DIAMETER


def what_is_measured(cut: Cut, measured: MeasuredModes) -> str:
    """Describe the number of modes and the directions assumed to be rigid."""
    modes = measured.in_plane if cut.kind is CutKind.MILLING else measured.along_axis
    text = counted(len(modes), "measured mode")
    if not any(mode.part is VibratingPart.TOOL for mode in modes):
        text += " of the workpiece, the tool taken as rigid"
    if cut.kind is CutKind.MILLING and not (measured.x and measured.y):
        text += f", {'x' if measured.y else 'y'} taken as rigid"
    return text


FREQUENCY_TOLERANCE = 0.01
"""Relative uncertainty of a natural frequency; no advised speed is closer to a lobe's edge.

It covers the resolution of a tap test, a few Hz, and the drift of a warm spindle.
"""

SPEED_STEP = 1e-3
"""Relative step between two speeds of a stability lobe diagram."""

LEAST_SPEED_SHARE = 0.1
"""Least speed of the lobes over the greatest, where machine and tool state no least one."""

RISK = "risk of chatter"
"""First words on a depth beyond the optimistic end of an estimate."""

STIFFNESS_BAND = (5_000.0, 20_000.0)
"""Stiffness at the tip of usual end mills, N/mm: band of the estimate."""

DAMPING_BAND = (0.02, 0.05)
"""Damping ratio ζ of tools in their holders: band of the estimate."""

TOOL_SHARE = 0.5
"""Share of the stiffness of the tool alone that remains at its tip.

Holder and spindle often deflect as much as the tool.
"""


class Basis(StrEnum):
    """Basis of a statement on chatter stability."""

    MEASURED = "measured"
    """Modes from a tap test: the depth is limited."""
    ESTIMATED = "estimated"
    """Overhang of the tool: nothing is limited."""
    NOT_USED = "not_used"
    """The model does not apply to this cut: nothing is limited."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Stability:
    """Chatter stability of a cut: its basis and the stable depth."""

    basis: Basis
    reason: str
    """What was measured or assumed, or why the model is not used."""
    least: float | None = None
    """Depth of one pass that is stable at any speed, mm."""
    band: tuple[float, float] | None = None
    """Uncertainty band of an estimated stable depth, mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChatterRisk:
    """Depth of cut beyond the optimistic end of the estimated stable depth."""

    depth: float
    """Depth of a pass, mm."""
    stable: float
    """Optimistic end of the depth that is stable at any speed, mm."""

    @property
    def words(self) -> str:
        """Depth and stable depth in words."""
        return f"{self.depth:.3g} mm, stable {self.stable:.2g}"


def risk_of(stability: Stability, depth: float) -> ChatterRisk | None:
    """Risk of chatter at a depth in mm; None within the band, or without an estimate."""
    if (
        stability.basis is not Basis.ESTIMATED
        or stability.band is None
        or depth <= stability.band[1]
    ):
        return None
    return ChatterRisk(depth=depth, stable=stability.band[1])


def stability_limits(cut: Cut, at: CuttingConditions) -> tuple[Limit, ...]:
    """Limit on the depth of one pass from measured modes; empty without measured modes."""
    measured = measured_modes(cut, at.machine)
    if measured is None or _why_not_used(cut, at, measured):
        return ()
    if cut.kind is CutKind.TURNING:
        depth = _turning_depth(cut, at, measured)
        return (_limit(cut, bound=depth, curve=None),) if depth < inf else ()
    return (_limit(cut, bound=1.0, curve=_lobes(cut, at, measured)),)


def stability_of(cut: Cut, at: CuttingConditions) -> Stability | None:
    """Chatter stability of a cut; None where it does not depend on the depth."""
    if cut.kind not in {CutKind.MILLING, CutKind.TURNING} or cut.is_air:
        return None
    measured = measured_modes(cut, at.machine)
    if measured is not None:
        why = _why_not_used(cut, at, measured)
        if why:
            return Stability(basis=Basis.NOT_USED, reason=why)
        return Stability(
            basis=Basis.MEASURED,
            reason=what_is_measured(cut, measured),
            least=_least_measured(cut, at, measured) / cut.depth_share,
        )
    if cut.kind is not CutKind.MILLING or at.grade is None or cut.engagement is None:
        return None
    if at.machine.only_stated_limits:
        return None
    why = _why_thin(cut)
    if why:
        return Stability(basis=Basis.NOT_USED, reason=why)
    return _estimated(cut, at, at.grade)


def estimate_texts(
    estimates: Iterable[tuple[Tool, Stability, float]],
) -> Iterator[tuple[str, str]]:
    """Id of each tool without measured modes, with the estimate for its hardest cut.

    Parameters
    ----------
    estimates : iterable of (Tool, Stability, float)
        Tool, stability and depth of the passes in mm of each workingstep.
    """
    hardest: dict[str, tuple[Stability, float]] = {}
    for tool, found, depth in estimates:
        if found.basis is not Basis.ESTIMATED or found.least is None:
            continue
        before = hardest.get(tool.id)
        if before is None or depth / found.least > before[1] / (before[0].least or inf):
            hardest[tool.id] = (found, depth)
    for tool_id, (found, depth) in hardest.items():
        low, high = found.band or (0.0, 0.0)
        stiff, soft = n_um_from_n_mm(STIFFNESS_BAND[1]), n_um_from_n_mm(STIFFNESS_BAND[0])
        yield (
            tool_id,
            f"{f'{RISK}: it' if risk_of(found, depth) else 'chatter'} does not limit "
            f"the depth of tool '{tool_id}': no modes are measured; "
            f"estimated from {found.reason}, {found.least:.2g} mm would be stable at any speed "
            f"({low:.2g} to {high:.2g} mm for {soft:g} to {stiff:g} N/µm and "
            f"ζ {DAMPING_BAND[0]:g} to {DAMPING_BAND[1]:g}); {depth:.3g} mm are cut: "
            "tap-test the tool and import its modes with `stepnc taptest`",
        )


def _limit(cut: Cut, *, bound: float, curve: SpeedCurve | None) -> Limit:
    """Limit on the depth where the cut is deepest, against chatter."""
    return Limit(
        name=LimitName.STABILITY,
        load=Monomial(coefficient=cut.depth_share, depth_exponent=1.0),
        bound=bound,
        unit="mm",
        curve=curve,
    )


def _why_not_used(cut: Cut, at: CuttingConditions, measured: MeasuredModes) -> str:
    """Reason why measured modes do not limit the depth; empty where they do."""
    if cut.kind is CutKind.MILLING:
        why = _why_thin(cut)
        if why:
            return why
        modes, highest = measured.in_plane, _speeds(cut, at)[1]
    else:
        modes, highest = measured.along_axis, cut.programmed.speed
    from simulator.physics.stability import damped_speed  # noqa: PLC0415 (numpy)

    damped = damped_speed(modes, cut.diameter)
    if highest > damped:
        return ""
    return (
        f"process damping below {rpm_from_rev_s(damped):.0f} rpm: the zero-order model "
        "does not apply"
    )


def _why_thin(cut: Cut) -> str:
    """Reason why the zero-order model does not apply to an engagement; empty where it does."""
    from simulator.physics.stability import LEAST_IMMERSION  # noqa: PLC0415 (numpy)

    if cut.engagement is None:
        return "the engagement is not known"
    immersion = 0.5 * cut.engagement.cosine_difference
    if immersion >= LEAST_IMMERSION:
        return ""
    return (
        f"a_e/D {immersion:.2g} is below {LEAST_IMMERSION:g}, where the zero-order model "
        "is not used"
    )


def _cutting_stiffness(cut: Cut, at: CuttingConditions) -> tuple[float, float]:
    """Cutting coefficients K_t, N/mm², and K_r of the chip alone, without edge rubbing.

    They follow from the linear-edge law where it was measured, otherwise from the slope of
    Kienzle's force at the mean chip of the least recommended feed: a thinner chip is stiffer,
    and the bound must not move with the feed that is sought under it.
    """
    factor, edge = force_factor(at), at.material.linear_edge
    sine = sin(cut.tool.cutting_edge_angle)
    if edge is not None:
        ratio = edge.k_rc / edge.k_tc if edge.k_rc > 0.0 else RADIAL_SHARE
        return factor * edge.k_tc, sine * ratio
    kienzle = at.material.kienzle
    chip = (least_feed(cut, at) or cut.programmed.feed) * _chip_ratio(cut)
    chip = max(chip, least_chip(cut, at))
    stiffness = chip_stiffness(chip, k_c11=kienzle.k_c11, m_c=kienzle.m_c)
    return factor * stiffness, sine * RADIAL_SHARE


def _chip_ratio(cut: Cut) -> float:
    """Mean chip thickness over the feed per tooth or revolution."""
    if cut.engagement is None:
        return sin(cut.tool.cutting_edge_angle)
    return mean_chip_ratio(cut.engagement, cutting_edge_angle=cut.tool.cutting_edge_angle)


def _speeds(cut: Cut, at: CuttingConditions) -> tuple[float, float]:
    """Speed range of the lobes, permitted and programmed speeds included, rev/s."""
    given = cut.programmed.speed
    low, high = speed_range(cut, at)
    if not low < high < inf:
        return given, given
    low = max(low, LEAST_SPEED_SHARE * high)
    return min(low, given), max(high, given)


def _lobes(cut: Cut, at: CuttingConditions, measured: MeasuredModes) -> SpeedCurve:
    """Greatest stable depth by speed, above the speeds with process damping."""
    from simulator.physics.stability import ModalStructure, damped_speed  # noqa: PLC0415 (numpy)

    low, high = _speeds(cut, at)
    low = max(low, damped_speed(measured.in_plane, cut.diameter))
    structure = ModalStructure(x=measured.x, y=measured.y)
    return _drawn(_dynamic_cut(cut, at), structure, low, high)


def _least_measured(cut: Cut, at: CuttingConditions, measured: MeasuredModes) -> float:
    """Depth that is stable at any speed according to measured modes, mm."""
    from simulator.physics.stability import ModalStructure  # noqa: PLC0415 (numpy)

    if cut.kind is CutKind.TURNING:
        return _turning_depth(cut, at, measured)
    return _least(_dynamic_cut(cut, at), ModalStructure(x=measured.x, y=measured.y))


def _turning_depth(cut: Cut, at: CuttingConditions, measured: MeasuredModes) -> float:
    """Depth of cut in turning that is stable at any speed, mm."""
    from simulator.physics.stability import MOST_DEPTH  # noqa: PLC0415 (numpy)
    from simulator.physics.turning_stability import orthogonal_limit  # noqa: PLC0415 (numpy)

    stiffness, ratio = _cutting_stiffness(cut, at)
    angle = cut.tool.cutting_edge_angle
    depth = orthogonal_limit(
        measured.x,
        measured.z,
        stiffness=stiffness * ratio / sin(angle),
        cutting_edge_angle=angle,
    )
    return depth if depth < MOST_DEPTH else inf


def _dynamic_cut(cut: Cut, at: CuttingConditions) -> "DynamicCut":
    """Dynamic milling cut at the place of greatest engagement."""
    from simulator.physics.stability import DynamicCut  # noqa: PLC0415 (numpy)

    if cut.engagement is None:
        raise ValueError("the milling cut has no engagement")
    stiffness, ratio = _cutting_stiffness(cut, at)
    return DynamicCut(
        engagement=cut.engagement,
        teeth=cut.tool.teeth,
        stiffness=stiffness,
        radial_ratio=ratio,
    )


@lru_cache(maxsize=256)
def _drawn(
    cut: "DynamicCut", structure: "ModalStructure", low: float, high: float
) -> SpeedCurve:
    """Stability lobes between two speeds, cached because they are requested repeatedly."""
    from simulator.physics.stability import lobes  # noqa: PLC0415 (numpy)

    speeds, depths = lobes(
        cut, structure, between=(low, high), step=SPEED_STEP, tolerance=FREQUENCY_TOLERANCE
    )
    return SpeedCurve(speeds=speeds, bounds=depths)


@lru_cache(maxsize=256)
def _least(cut: "DynamicCut", structure: "ModalStructure") -> float:
    """Depth of cut that is stable at any spindle speed, mm."""
    from simulator.physics.stability import least_stable_depth  # noqa: PLC0415 (numpy)

    return least_stable_depth(cut, structure)


def _estimated(cut: Cut, at: CuttingConditions, grade: ToolGrade) -> Stability:
    """Stability estimated from the overhang of the tool, with equal compliance in x and y."""
    diameter, softest, stiffest = cut.tool.diameter, *STIFFNESS_BAND
    stiffness, of = sqrt(softest * stiffest), "usual tools"
    if cut.tool_kind is ToolKind.ENDMILL:
        usual = customary_overhang(diameter, cut.tool.cutting_edge_length)
        overhang = cut.tool.overhang or usual
        compliance = deflection(
            1.0,
            overhang=overhang,
            diameter=equivalent_diameter(diameter),
            youngs_modulus=grade.youngs_modulus,
        )
        stiffness = min(max(TOOL_SHARE / compliance, softest), stiffest)
        of = f"an overhang of {overhang:.3g} mm"
    damping = sqrt(DAMPING_BAND[0] * DAMPING_BAND[1])
    found = [
        _expected(cut, at, stiffness=k, damping=zeta)
        for k, zeta in (
            (stiffness, damping),
            (softest, DAMPING_BAND[0]),
            (stiffest, DAMPING_BAND[1]),
        )
    ]
    return Stability(
        basis=Basis.ESTIMATED,
        reason=f"{of} ({n_um_from_n_mm(stiffness):.2g} N/µm, ζ {damping:.2g})",
        least=found[0],
        band=(found[1], found[2]),
    )


def _expected(cut: Cut, at: CuttingConditions, *, stiffness: float, damping: float) -> float:
    """Depth of one pass stable at any speed, mm, for one mode along x and y."""
    from simulator.physics.stability import ModalStructure  # noqa: PLC0415 (numpy)

    mode = VibrationMode(
        part=VibratingPart.TOOL,
        direction=ModeDirection.XY,
        # The lowest point of all lobes does not depend on the natural frequency.
        natural_frequency=1_000.0,
        damping_ratio=damping,
        stiffness=stiffness,
        source="estimate",
    )
    structure = ModalStructure(x=(mode,), y=(mode,))
    return _least(_dynamic_cut(cut, at), structure) / cut.depth_share
