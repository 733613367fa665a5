"""How far an end mill may bend: what the tolerance or the allowance of its wall permits.

The operation that leaves a wall must keep its tolerance. Its bending counts twice, as the walls
on both sides of a size move alike, and may use half of the deviation that is permitted; the
rest is for machine, clamping, heat, wear and measuring. So the bound is a quarter of the
half-width. An earlier operation may bend into its allowance: a third of it, so that two thirds
are left to clean up, and the finish never meets more than four thirds of what it was planned
for. Lengths in mm.
"""

from dataclasses import dataclass

from optimiser.conditions import GREATEST_DEFLECTION, PermittedDeflection
from optimiser.estimate import DEFAULT_SIDE_ALLOWANCE, FINISHING
from optimiser.wall import WallSize, bar_sizes, wall_sizes
from stepnc_model.entities.drilling import Boring, Reaming
from stepnc_model.entities.features import PlanarFace
from stepnc_model.entities.milling import (
    BottomAndSideMilling,
    FreeformOperation,
    PlaneMilling,
    SideMilling,
)
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, Severity
from stepnc_model.program import Program, Workingstep
from stepnc_model.tolerance import (
    Tolerance,
    Written,
    general_tolerance,
    written_tolerance,
)

SHARE_OF_TOLERANCE = 0.25
"""deflection over the half-width of the tolerance; why is told above"""

SHARE_OF_ALLOWANCE = 1.0 / 3.0
"""deflection over the allowance; why is told above"""

GREATEST_AT_WALL = 0.05
"""mm where the wall stays as it is cut, however wide the tolerance: customary"""

WALL_OPERATIONS = (SideMilling, BottomAndSideMilling, FreeformOperation, Boring, Reaming)
"""operations that take an allowance off a wall"""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Toleranced:
    """A size between walls with the tolerance that holds for it."""

    wall: WallSize
    tolerance: Tolerance


def permitted_deflection(
    program: Program, step: Workingstep
) -> tuple[PermittedDeflection, list[Finding]]:
    """How far the end mill of a milling workingstep may bend, and what was assumed.

    Parameters
    ----------
    program : Program
    step : Workingstep
        One that mills.

    Returns
    -------
    PermittedDeflection, findings

    Raises
    ------
    SchemaError
        When the feature lacks a size.
    """
    return _permitted(program, step, _walls(program, step), _allowance(program, step))


def permitted_bar_deflection(
    program: Program, step: Workingstep
) -> tuple[PermittedDeflection, list[Finding]]:
    """How far the bar of a turning workingstep may bend, and what was assumed.

    A bar that gives way is thicker by twice as much. Parameters, result and errors as those of
    :func:`permitted_deflection`.
    """
    diameters = [size for feature in step.features for size in bar_sizes(program, feature)]
    allowance = getattr(step.operation, "allowance", None) or 0.0
    return _permitted(program, step, diameters, max(0.0, allowance))


def _permitted(
    program: Program, step: Workingstep, walls: list[WallSize], allowance: float
) -> tuple[PermittedDeflection, list[Finding]]:
    """What sizes, and the thickness that is left on them, permit."""
    forgiven = SHARE_OF_ALLOWANCE * allowance
    if not walls or forgiven >= GREATEST_DEFLECTION:
        return PermittedDeflection(), []
    tightest, findings = _tightest(program, walls)
    permitted = _within_tolerance(tightest)
    # An allowance that forgives less than the tolerance does is no reason to bend less.
    if forgiven > permitted.value:
        origin = f"a third of the {allowance:g} mm that it leaves on the wall"
        return PermittedDeflection(value=forgiven, origin=origin), findings
    left = f"{allowance:g} mm on " if allowance > 0.0 else ""
    what = "bar" if isinstance(step.operation, TurningMachiningOperation) else "tool"
    bound = f"{what} deflection at most {permitted.value:.3g} mm"
    text = f"leaves {left}the wall: {bound}, {permitted.origin}"
    return permitted, [*findings, program.finding(Severity.NOTE, text, step.operation_ref)]


def _tightest(program: Program, walls: list[WallSize]) -> tuple[_Toleranced, list[Finding]]:
    """The size with the tightest tolerance, and which tolerances cannot be read."""
    toleranced = []
    findings: list[Finding] = []
    for wall in walls:
        written = Written(tolerance=None)
        if wall.ref is not None:
            written = written_tolerance(program, wall.ref)
        if written.finding is not None and written.finding not in findings:
            findings.append(written.finding)
        tolerance = written.tolerance or general_tolerance(wall.size)
        toleranced.append(_Toleranced(wall=wall, tolerance=tolerance))
    return min(toleranced, key=lambda each: each.tolerance.half_width), findings


def _walls(program: Program, step: Workingstep) -> list[WallSize]:
    """Sizes of the walls that an operation cuts; a face has none but those of its bosses."""
    if not step.features:
        return []
    feature = step.features[0]
    is_face = isinstance(program.get(feature), PlanarFace)
    if isinstance(step.operation, PlaneMilling) and not is_face:
        return []
    return wall_sizes(program, feature)


def _allowance(program: Program, step: Workingstep) -> float:
    """Thickness in mm that is left on the wall for a later operation; 0: this one leaves it."""
    operation = step.operation
    written: float | None = getattr(operation, "allowance_side", None)
    if written is not None:
        return max(0.0, written)
    # A given tool path says nothing of what it leaves: it is taken to leave the wall.
    if isinstance(operation, (*FINISHING, FreeformOperation)):
        return 0.0
    later = (each.operation for each in program.after(step))
    is_followed = any(isinstance(each, WALL_OPERATIONS) for each in later)
    return DEFAULT_SIDE_ALLOWANCE if is_followed else 0.0


def _within_tolerance(size: _Toleranced) -> PermittedDeflection:
    """A share of the tolerance, at most what any wall takes."""
    tolerance, wall = size.tolerance, size.wall
    share = SHARE_OF_TOLERANCE * tolerance.half_width
    places = [str(wall.ref)] if wall.ref is not None else []
    if tolerance.code != f"±{tolerance.half_width:g} mm":
        places.insert(0, tolerance.code)
    origin = (
        f"a quarter of the ±{tolerance.half_width:.4g} mm of its {wall.name} "
        f"of {wall.size:.4g} mm ({', '.join(places)})"
    )
    if share > GREATEST_AT_WALL:
        origin = f"the most for any wall: {origin} is more"
    return PermittedDeflection(value=min(share, GREATEST_AT_WALL), origin=origin)
