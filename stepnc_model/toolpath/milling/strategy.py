"""Cutter shape and milling strategy of an operation, resolved to numbers and directions.

ISO 14649-11. A rotation direction and a cut mode together determine whether rings go from the
inside out or from the outside in: the material must lie on the side that the mode requires. In
climb milling with a right-hand tool it lies on the right of the path.
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
from stepnc_model.programs.tool import body_of, hand_of
from stepnc_model.toolpath.frame import direction_of
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.units import rad_from_deg

RUN_OUT = 2.0
"""Default run-out beyond an open side where no overcut length is given, mm."""

LONGEST = 1000.0
"""Greatest overcut length accepted, mm."""

STEEPEST_DEG = 80.0
"""Greatest angle between the side of a tapered tool and its axis, degrees."""


@dataclass(frozen=True, slots=True, kw_only=True)
class EndMillShape:
    """Flat, ball, bull-nose or tapered end mill."""

    radius: float
    """Nominal radius, at the widest place of the tool's end, mm."""
    corner: float = 0.0
    """Corner radius, mm; equal to the radius for a ball end mill."""
    taper: float = 0.0
    """Tangent of the taper angle of the side."""

    def reach(self, height: float) -> float:
        """Radius of the cutter at a height above its tip, mm."""
        if height < self.corner:
            below = self.corner - height
            return self.radius - self.corner + sqrt(self.corner**2 - below**2)
        return self.radius + (height - self.corner) * self.taper


def cutter_of(job: ToolPathTask) -> EndMillShape:
    """Shape of the cutter of a milling workingstep.

    Raises
    ------
    PathError
        If the tool has no diameter, or a corner radius larger than its radius.
    """
    tool = job.tool
    radius, corner = 0.5 * tool.diameter, tool.corner_radius or 0.0
    if radius <= 0.0:
        raise job.fault(
            "the tool has no diameter: it cannot be used for milling", job.step.tool_ref
        )
    if corner > radius * (1.0 + 1e-9):
        raise job.fault(
            f"corner radius {corner:g} mm on a tool of {tool.diameter:g} mm diameter: "
            "it must be at most half the diameter",
            job.step.tool_ref,
        )
    return EndMillShape(radius=radius, corner=corner, taper=_taper(job))


def run_out(job: ToolPathTask) -> float:
    """Distance of the tool's rim beyond an open side, mm: the overcut length, if given.

    Raises
    ------
    PathError
        If the overcut length is negative or too large.
    """
    overcut = getattr(job.step.operation, "overcut_length", None)
    if overcut is not None and not 0.0 <= overcut < LONGEST:
        raise job.fault(
            f"{overcut:g} mm: the overcut length must be at least 0 and below {LONGEST:g} mm",
            job.step.operation_ref,
            "overcut_length",
        )
    return RUN_OUT if overcut is None else float(overcut)


def _taper(job: ToolPathTask) -> float:
    """Tangent of the taper angle of the tool's side; 0 where the file gives no taper."""
    angle = getattr(body_of(job.program, job.step.tool_ref), "taper_angle", None)
    if not angle:
        return 0.0
    if not 0.0 < angle < STEEPEST_DEG:
        raise job.fault(
            f"taper angle {angle:g}° must lie between 0° and {STEEPEST_DEG:g}°",
            job.step.tool_ref,
        )
    return tan(rad_from_deg(angle))


WIDEST = 0.95
"""Greatest step between passes, as a fraction of the tool diameter."""

LEAST = 0.002
"""Least step between passes, as a fraction of the tool diameter."""


class Covering(StrEnum):
    """Pattern of the passes over a milling area."""

    DEFAULT = auto()
    """Strokes to and fro over faces, rings in pockets."""
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
    """Milling strategy of an operation, resolved to numbers and directions."""

    covering: Covering
    step: float
    """Step between neighbouring passes, mm."""
    along: complex
    """Unit vector of the first stroke in the setup."""
    steps_left: bool
    """Whether strokes progress to the left of the first stroke."""
    is_lifted: bool
    """Whether the tool is lifted between strokes."""
    is_counter_clockwise: bool
    """Whether outer rings run counter-clockwise."""
    is_inside_out: bool
    has_wall_on_right: bool
    """Whether passes along a wall have it on their right."""
    findings: tuple[Finding, ...] = ()


def way_of(job: ToolPathTask, cutter: EndMillShape) -> ResolvedStrategy:
    """Resolve the strategy of a milling workingstep.

    Raises
    ------
    PathError
        If the overlap or radial depth leaves no progress, or the strategy asks for an explicit
        path that is not given.
    """
    ref = getattr(job.step.operation, "its_machining_strategy", None)
    strategy = job.program.get(ref) if ref is not None else None
    if ref is not None and isinstance(strategy, ExplicitStrategy):
        raise job.fault(
            "the strategy asks for an explicit tool path, but the operation has none", ref
        )
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
        # In one-way climb milling the uncut material lies on the right.
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
    """Step between neighbouring passes, mm: from the overlap, at most the radial depth."""
    diameter = 2.0 * cutter.radius
    findings = []
    overlap = strategy.overlap if isinstance(strategy, Two5dMillingStrategy) else None
    radial = getattr(job.step.operation, "radial_cutting_depth", None)
    at = job.step.operation_ref
    if radial is not None and not 0.0 < radial < float("inf"):
        raise job.fault(
            f"{radial:g} mm: the width of cut must be positive", at, "radial_cutting_depth"
        )
    if overlap is None and radial is None:
        text = f"no overlap or radial depth given: assuming {WIDEST:.0%} of the tool diameter"
        findings.append(job.note(text))
    ratio = overlap or 0.0
    if ratio > 1.0:
        ratio /= 100.0
    if not 0.0 <= ratio < 1.0:
        raise job.fault(
            f"overlap {overlap:g} must be at least 0 and below 1, or below 100 in percent",
            strategy_ref,
            "overlap",
        )
    step = min(diameter * min(1.0 - ratio, WIDEST), radial or diameter)
    if step < LEAST * diameter:
        raise job.fault(
            f"step of {step:g} mm: must be at least {LEAST * diameter:g} mm for this tool",
            at if radial == step else strategy_ref,
            "radial_cutting_depth" if radial == step else "overlap",
        )
    return step, findings


def _along(job: ToolPathTask, strategy: Entity | None) -> complex:
    """Direction of the strokes in the setup; along x if not given."""
    ref = getattr(strategy, "feed_direction", None)
    if ref is None:
        return 1.0 + 0.0j
    # ISO 14649-11 gives the direction in the coordinates of the feature.
    direction = direction_of(job.program, ref)
    x, y, _ = job.frame(job.step.features[0]).direction(direction)
    size = abs(complex(x, y))
    if size < 1e-6:
        raise job.fault(
            "the feed direction points along the tool axis: it must lie across it", ref
        )
    return complex(x, y) / size
