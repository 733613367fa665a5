"""Cutter and strategy of an operation on an area, as numbers and directions.

ISO 14649-11. A rotation and a cut mode together say whether rings go from the inside out or
from the outside in: the material must lie on the side that the mode asks for. With a right-hand
tool climb milling has it on the right of the way.
"""

from dataclasses import dataclass
from enum import StrEnum, auto
from math import sqrt, tan

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.enums import (
    CutmodeType,
    Hand,
    LeftOrRight,
    RotDirection,
    StrokeConnectionStrategy,
)
from stepnc_model.entities.milling import (
    BidirectionalContour,
    BidirectionalMilling,
    CenterMilling,
    ContourBidirectional,
    ContourParallel,
    ContourSpiral,
    ExplicitStrategy,
    Two5dMillingStrategy,
    UnidirectionalMilling,
)
from stepnc_model.errors import Finding
from stepnc_model.part21.values import Ref
from stepnc_model.tool import body_of, hand_of
from stepnc_model.toolpath.frame import direction_of
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.units import rad_from_deg

RUN_OUT = 2.0
"""mm beyond an open side where no overcut length is given"""

LONGEST = 1000.0
"""mm of overcut; more is a slip"""

STEEPEST_DEG = 80.0
"""degrees between the side of a tapered tool and its axis"""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndMillShape:
    """Flat, ball, bull-nose or tapered end mill."""

    radius: float
    """Radius, mm, where it is widest at the end: the nominal one"""
    corner: float = 0.0
    """Corner, mm, radius of the corner; the radius itself for a ball"""
    taper: float = 0.0
    """tangent of the angle of the side"""

    def reach(self, height: float) -> float:
        """Radius at a height above the tip."""
        if height < self.corner:
            below = self.corner - height
            return self.radius - self.corner + sqrt(self.corner**2 - below**2)
        return self.radius + (height - self.corner) * self.taper


def cutter_of(job: ToolPathTask) -> EndMillShape:
    """Cutter of a milling workingstep.

    Raises
    ------
    PathError
        When the tool has no diameter, or corners larger than itself.
    """
    tool = job.tool
    radius, corner = 0.5 * tool.diameter, tool.corner_radius or 0.0
    if radius <= 0.0:
        raise job.fault("is no rotating tool: nothing can be milled with it", job.step.tool_ref)
    if corner > radius * (1.0 + 1e-9):
        raise job.fault(
            f"corner radius {corner:g} mm on a tool of {tool.diameter:g} mm: "
            "it is at most half the diameter",
            job.step.tool_ref,
        )
    return EndMillShape(radius=radius, corner=corner, taper=_taper(job))


def run_out(job: ToolPathTask) -> float:
    """Distance of the tool's rim beyond an open side: the overcut length, if given.

    Raises
    ------
    PathError
        When it is negative.
    """
    overcut = getattr(job.step.operation, "overcut_length", None)
    if overcut is not None and not 0.0 <= overcut < LONGEST:
        raise job.fault(
            f"{overcut:g} mm: it must be at least 0, below {LONGEST:g} mm",
            job.step.operation_ref,
            "overcut_length",
        )
    return RUN_OUT if overcut is None else float(overcut)


def _taper(job: ToolPathTask) -> float:
    """Tangent of the side's angle to the axis; most tapered end mills of files have none."""
    angle = getattr(body_of(job.program, job.step.tool_ref), "taper_angle", None)
    if not angle:
        return 0.0
    if not 0.0 < angle < STEEPEST_DEG:
        raise job.fault(
            f"taper of {angle:g}°: it must lie between 0° and {STEEPEST_DEG:g}°",
            job.step.tool_ref,
        )
    return tan(rad_from_deg(angle))


WIDEST = 0.95
"""of the diameter: neighbouring passes overlap by the rest at least"""

LEAST = 0.002
"""of the diameter: smaller steps than this are a slip"""


class Covering(StrEnum):
    """Pattern of the passes in an area."""

    DEFAULT = auto()
    """strokes to and fro over faces, rings in pockets"""
    RINGS = auto()
    SPIRAL = auto()
    ONE_WAY = auto()
    TO_AND_FRO = auto()
    STROKES_THEN_WALL = auto()
    WALL_THEN_STROKES = auto()
    MIDDLE = auto()


COVERINGS: tuple[tuple[type[Entity], Covering], ...] = (
    (ContourParallel, Covering.RINGS),
    (ContourSpiral, Covering.SPIRAL),
    (UnidirectionalMilling, Covering.ONE_WAY),
    (BidirectionalMilling, Covering.TO_AND_FRO),
    (BidirectionalContour, Covering.STROKES_THEN_WALL),
    (ContourBidirectional, Covering.WALL_THEN_STROKES),
    (CenterMilling, Covering.MIDDLE),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedStrategy:
    """A strategy, resolved."""

    covering: Covering
    step: float
    """Step, mm between neighbouring passes"""
    along: complex
    """unit vector of the first stroke in the setup"""
    steps_left: bool
    """strokes progress to the left of the first one"""
    is_lifted: bool
    """the tool is lifted between strokes"""
    is_counter_clockwise: bool
    """outer rings"""
    is_inside_out: bool
    has_wall_on_right: bool
    """of passes along a wall"""
    findings: tuple[Finding, ...] = ()


def way_of(job: ToolPathTask, cutter: EndMillShape) -> ResolvedStrategy:
    """Strategy of a milling workingstep.

    Raises
    ------
    PathError
        When its overlap or radial depth leaves no progress, or it asks for a path that is not
        given.
    """
    ref = getattr(job.step.operation, "its_machining_strategy", None)
    strategy = job.program.get(ref) if ref is not None else None
    if ref is not None and isinstance(strategy, ExplicitStrategy):
        raise job.fault("asks for an explicit tool path, and none is given", ref)
    step, findings = _step(job, cutter, strategy, ref or job.step.operation_ref)
    along = _along(job, strategy)
    mode = getattr(strategy, "cutmode", None) or getattr(strategy, "spiral_cutmode", None)
    rotation = getattr(strategy, "rotation_direction", None)
    is_left = hand_of(job.program, job.step.tool_ref) is Hand.LEFT
    on_right = (mode is not CutmodeType.CONVENTIONAL) is not is_left
    is_ccw = on_right if rotation is None else rotation is RotDirection.CCW
    side = getattr(strategy, "stepover_direction", None)
    connection = getattr(strategy, "its_stroke_connection_strategy", None)
    return ResolvedStrategy(
        covering=next(
            (covering for kind, covering in COVERINGS if isinstance(strategy, kind)),
            Covering.DEFAULT,
        ),
        step=step,
        along=along,
        # One way and climbing, the uncut material lies on the right.
        steps_left=side is LeftOrRight.LEFT if side is not None else not on_right,
        is_lifted=connection is StrokeConnectionStrategy.LIFT_SHIFT_PLUNGE
        or isinstance(strategy, UnidirectionalMilling),
        is_counter_clockwise=is_ccw,
        is_inside_out=mode is None or is_ccw == on_right,
        has_wall_on_right=on_right if mode is not None else is_ccw,
        findings=tuple(findings),
    )


def _step(
    job: ToolPathTask, cutter: EndMillShape, strategy: Entity | None, strategy_ref: Ref[Entity]
) -> tuple[float, list[Finding]]:
    """Distance of neighbouring passes in mm: from the overlap, at most the radial depth."""
    diameter = 2.0 * cutter.radius
    findings = []
    overlap = strategy.overlap if isinstance(strategy, Two5dMillingStrategy) else None
    radial = getattr(job.step.operation, "radial_cutting_depth", None)
    at = job.step.operation_ref
    if radial is not None and not 0.0 < radial < float("inf"):
        raise job.fault(
            f"{radial:g} mm: a width of cut is positive", at, "radial_cutting_depth"
        )
    if overlap is None and radial is None:
        text = f"neither overlap nor radial depth: steps of {WIDEST:.0%} of the tool assumed"
        findings.append(job.note(text))
    ratio = overlap or 0.0
    if ratio > 1.0:
        ratio /= 100.0
    if not 0.0 <= ratio < 1.0:
        raise job.fault(
            f"overlap {overlap:g}: it must be at least 0 and below 1, or 100 in percent",
            strategy_ref,
            "overlap",
        )
    step = min(diameter * min(1.0 - ratio, WIDEST), radial or diameter)
    if step < LEAST * diameter:
        raise job.fault(
            f"steps of {step:g} mm: at least {LEAST * diameter:g} mm for this tool",
            at if radial == step else strategy_ref,
            "radial_cutting_depth" if radial == step else "overlap",
        )
    return step, findings


def _along(job: ToolPathTask, strategy: Entity | None) -> complex:
    """Direction of the strokes in the setup; along x where none is given."""
    ref = getattr(strategy, "feed_direction", None)
    if ref is None:
        return 1.0 + 0.0j
    # ISO 14649-11 gives it in the coordinates of the feature.
    direction = direction_of(job.program, ref)
    x, y, _ = job.frame(job.step.features[0]).direction(direction)
    size = abs(complex(x, y))
    if size < 1e-6:
        raise job.fault("points along the tool: strokes lie across it", ref)
    return complex(x, y) / size
