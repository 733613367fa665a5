"""Input of tool path generation, and the builder of a path.

The input is the workingstep with its tool, its frame and its heights. The path builder keeps
running state, one object per workingstep.
"""

from dataclasses import dataclass, replace
from functools import cached_property

from stepnc_model.editing.record_edit import find_record
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.geometry import Block, ElementarySurface, RightCircularCylinder
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, PathError, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.programs.tool import Tool, tool_of
from stepnc_model.toolpath.frame import (
    Frame,
    feature_frame,
    frame_of,
    point_of,
    workpiece_frame,
)
from stepnc_model.toolpath.path import (
    FARTHEST,
    Arc,
    ArcPlane,
    CannedCycle,
    Dwell,
    Feed,
    Move,
    MoveType,
    Point,
    SpindleCommand,
    Step,
    ToolPath,
)

DEFAULT_CLEARANCE = 5.0
"""Default distance from the feature up to the retract plane, mm."""

ABOVE_STOCK = 1.0
"""Height above the stock at which the tool may move in rapid, mm."""

DEFAULT_SECURITY = 50.0
"""Default height of the security plane above zero, mm."""

SAME = 1e-9
"""Length below which a move is dropped, and two heights are the same, mm."""


@dataclass(frozen=True, kw_only=True)
class ToolPathTask:
    """Workingstep with everything needed to generate its tool path."""

    program: Program
    step: ResolvedWorkingstep
    security_z: float
    """Height z of the security plane in the setup, mm."""
    stock: Stock | None
    findings: tuple[Finding, ...] = ()

    @cached_property
    def tool(self) -> Tool:
        """Tool of the workingstep; a path that the file gives may not need it.

        Raises
        ------
        SchemaError
            If the file does not describe it.
        """
        return tool_of(self.program, self.step.tool_ref)

    @property
    def feed(self) -> Feed:
        """Programmed feed of the workingstep."""
        return Feed(technology=self.step.technology_ref)

    @property
    def plunge_feed(self) -> Feed:
        """Feed of downward moves into the material: the recorded plunge feed or else the feed.

        Raises
        ------
        PathError
            If the recorded plunge feed is not positive.
        """
        plunge = replace(self.feed, is_plunge=True)
        record = find_record(self.program, self.step)
        per_tooth = None if record is None else record.plunge_feed_per_tooth
        if per_tooth is None:
            return plunge
        if per_tooth <= 0.0:
            message = f"plunge feed {per_tooth:g} mm/tooth must be positive"
            raise self.fault(message, self.step.operation_ref, "plunge_feed_per_tooth")
        return replace(plunge, per_revolution=per_tooth * self.tool.teeth)

    def rapid_z(self, at: Point) -> float:
        """Lowest height in rapid above a point: its own height, or above the stock.

        Removed material is not tracked: the raw stock counts.
        """
        stock, half = self.stock, 0.5 * self.tool.diameter
        if stock is None:
            return at[2]
        is_beside = any(
            at[axis] + half < stock.low[axis] or at[axis] - half > stock.high[axis]
            for axis in (0, 1)
        )
        return at[2] if is_beside else max(at[2], stock.high[2] + ABOVE_STOCK)

    def frame(self, feature: Ref[Entity]) -> Frame:
        """Frame of a feature in the setup."""
        return feature_frame(self.program, self.step.setup, feature)

    def fault(self, message: str, ref: Ref[Entity], attribute: str = "") -> PathError:
        """Error that no path can be made because of one entity."""
        return self.program.path_error(message, ref, attribute)

    def note(
        self, message: str, ref: Ref[Entity] | None = None, attribute: str = ""
    ) -> Finding:
        """Create a finding that notes an assumption."""
        at = self.step.operation_ref if ref is None else ref
        return self.program.finding(Severity.NOTE, message, at, attribute)

    def warning(
        self, message: str, ref: Ref[Entity] | None = None, attribute: str = ""
    ) -> Finding:
        """Create a finding that warns the machinist."""
        at = self.step.operation_ref if ref is None else ref
        return self.program.finding(Severity.WARNING, message, at, attribute)


def job_of(program: Program, step: ResolvedWorkingstep) -> ToolPathTask:
    """Collect the input of a workingstep's tool path.

    Raises
    ------
    SchemaError, PathError
        If the security plane cannot be used.
    """
    with program.using(step.ref, step.operation_ref, step.setup):
        stock = stock_of(program, step.setup)
        security_z, findings = _security(program, step, stock)
        return ToolPathTask(
            program=program,
            step=step,
            security_z=security_z,
            stock=stock,
            findings=findings,
        )


def stock_of(program: Program, setup: Ref[Setup] | None) -> Stock | None:
    """Raw part given by the user, in the coordinates of every setup.

    Otherwise that of the file, from the bounding geometry of the raw piece or the workpiece.
    """
    return program.stock or drawn_stock(program, setup)


def drawn_stock(program: Program, setup: Ref[Setup] | None) -> Stock | None:
    """Raw part as given in the file; None if the file does not describe it.

    A raw part that holds none of the features is not used: they could not be cut from it.
    """
    stock = _described_stock(program, setup)
    return None if stock is None or _is_off(program, setup, stock) else stock


def unused_stock(program: Program, setup: Ref[Setup] | None) -> Finding | None:
    """Warning about a raw part that holds none of the features, and is not used."""
    stock = _described_stock(program, setup)
    body = _bounding_geometry(program) or raw_body(program)
    if stock is None or body is None or not _is_off(program, setup, stock):
        return None
    text = (
        f"the raw part from z = {stock.low[2]:g} to {stock.high[2]:g} mm holds none of the "
        "features, which lie below it: it is not used"
    )
    return program.finding(Severity.WARNING, text, body)


def _bounding_geometry(program: Program) -> Ref[Entity] | None:
    """Body that a file gives as its raw part."""
    workpiece = program.workpiece()
    if workpiece is None:
        return None
    raw = program.get(workpiece.its_rawpiece) if workpiece.its_rawpiece else workpiece
    return raw.its_bounding_geometry or workpiece.its_bounding_geometry


def _described_stock(program: Program, setup: Ref[Setup] | None) -> Stock | None:
    """Raw part as a file describes it, in the coordinates of a setup."""
    reference = _bounding_geometry(program)
    if reference is None or is_body(program, reference):
        return _around_body(program, setup)
    shape = program.get(reference)
    if not isinstance(shape, (Block, RightCircularCylinder)):
        return None
    frame = workpiece_frame(program, setup).inner(frame_of(program, shape.position))
    with program.using(reference):
        return _placed(_bounds(shape), frame)


def _is_off(program: Program, setup: Ref[Setup] | None, stock: Stock) -> bool:
    """True if the floors of all features lie at or below a stock, and one feature as a whole.

    The first feature that ends within the stock decides, so that large programs cost little.
    """
    bottom, is_one_outside = stock.low[2] + SAME, False
    for step in program.workingsteps:
        if setup is not None and step.setup != setup:
            continue
        for feature in step.features:
            span = _span(program, step.setup, feature)
            if span is None or span[0] > bottom:
                return False
            is_one_outside = is_one_outside or (span[1] <= bottom and span[0] < span[1] - SAME)
    return is_one_outside


def _span(
    program: Program, setup: Ref[Setup] | None, feature: Ref[Entity]
) -> tuple[float, float] | None:
    """Heights of a feature's floor and top, mm; None where a plane does not give the depth."""
    try:
        depth = getattr(program.get(feature), "depth", None)
        plane = None if depth is None else program.get(depth)
        if not isinstance(plane, ElementarySurface):
            return None
        frame = feature_frame(program, setup, feature)
        floor = frame.inner(frame_of(program, plane.position)).origin[2]
    except SchemaError:
        return None
    return min(floor, frame.origin[2]), max(floor, frame.origin[2])


def is_body(program: Program, representation: Ref[Entity]) -> bool:
    """True if a shape representation is that of a B-rep body."""
    return program.file.keyword(representation).endswith("BREP_SHAPE_REPRESENTATION")


def raw_body(program: Program) -> Ref[Entity] | None:
    """Representation of the raw part as a B-rep body; None if the file has none."""
    workpiece = program.workpiece()
    if workpiece is None:
        return None
    raw = program.get(workpiece.its_rawpiece) if workpiece.its_rawpiece else workpiece
    # The geometry of the workpiece itself is that of the finished part.
    shapes = (None if raw is workpiece else raw.its_geometry, raw.its_bounding_geometry)
    return next((each for each in shapes if each and is_body(program, each)), None)


def finished_body(program: Program) -> Ref[Entity] | None:
    """Representation of the finished part as a B-rep body; None if the file has none."""
    workpiece = program.workpiece()
    shape = None if workpiece is None else workpiece.its_geometry
    return shape if shape and is_body(program, shape) else None


def _around_body(program: Program, setup: Ref[Setup] | None) -> Stock | None:
    """Box or bar around the body of the raw part."""
    body = raw_body(program)
    if body is None or program.bodies is None:
        return None
    around = program.bodies.box(program.file, body)
    if around is None:
        return None
    with program.using(body):
        return _placed(around, workpiece_frame(program, setup))


def _bounds(shape: Block | RightCircularCylinder) -> Stock:
    """Box or bar in its own coordinates."""
    if isinstance(shape, Block):
        return Stock(low=(0.0, 0.0, 0.0), high=(shape.x, shape.y, shape.z))
    return Stock(
        low=(-shape.radius, -shape.radius, 0.0),
        high=(shape.radius, shape.radius, shape.height),
        radius=shape.radius,
    )


def _placed(shape: Stock, frame: Frame) -> Stock:
    """Bounding box of a body placed in a frame."""
    low, high = shape.low, shape.high
    if max(map(abs, (*low, *high))) > FARTHEST:
        raise ValueError(f"the stock is larger than {FARTHEST:g} mm")
    corners = [
        frame.point((x, y, z))
        for x in (low[0], high[0])
        for y in (low[1], high[1])
        for z in (low[2], high[2])
    ]
    columns = list(zip(*corners, strict=True))
    return Stock(
        low=(min(columns[0]), min(columns[1]), min(columns[2])),
        high=(max(columns[0]), max(columns[1]), max(columns[2])),
        radius=shape.radius,
        is_around=shape.is_around,
    )


def clamps_of(program: Program, setup: Ref[Setup] | None) -> tuple[Point, ...]:
    """Clamping positions of the workpiece, in the coordinates of the setup."""
    workpiece = program.workpiece()
    if workpiece is None:
        return ()
    frame = workpiece_frame(program, setup)
    return tuple(
        frame.point(point_of(program, point)) for point in workpiece.clamping_positions or ()
    )


def _security(
    program: Program, step: ResolvedWorkingstep, stock: Stock | None
) -> tuple[float, tuple[Finding, ...]]:
    """Height of the security plane: from the workingstep, the setup, or a default, mm.

    Files give it in the coordinates of the setup or of the feature. The first reading is used
    where it puts the plane above the feature.
    """
    entity = program.get(step.ref)
    planes = [getattr(entity, "its_secplane", None)]
    if step.setup is not None:
        setup = program.get(step.setup)
        planes.append(setup.its_secplane if isinstance(setup, Setup) else None)
    found = [plane for plane in planes if plane is not None]
    if not found:
        height = max(DEFAULT_SECURITY, (stock.high[2] if stock else 0.0) + DEFAULT_CLEARANCE)
        text = f"no security plane given: assuming z = {height:g} mm"
        return height, (program.finding(Severity.NOTE, text, step.ref, "its_secplane"),)
    height = frame_of(program, program.get(found[0]).position).origin[2]
    if isinstance(step.operation, TurningMachiningOperation) or not step.features:
        return height, ()
    return _raised(program, step, stock, height)


def _raised(
    program: Program, step: ResolvedWorkingstep, stock: Stock | None, height: float
) -> tuple[float, tuple[Finding, ...]]:
    """Raise a security plane above the feature and above the stock, with findings."""
    findings: list[Finding] = []
    top = feature_frame(program, step.setup, step.features[0]).origin[2]
    if 0.0 < height <= top:
        text = (
            f"security plane z = {height:g} mm is not above the feature, whose top is at "
            f"z = {top:g} mm: measured from there instead, z = {top + height:g} mm"
        )
        height += top
        findings.append(program.finding(Severity.WARNING, text, step.ref, "its_secplane"))
    if stock is not None and height < stock.high[2] + ABOVE_STOCK:
        safe = stock.high[2] + DEFAULT_CLEARANCE
        text = (
            f"security plane z = {height:g} mm is not above the stock, whose top is at "
            f"z = {stock.high[2]:g} mm: using z = {safe:g} mm"
        )
        height = safe
        findings.append(program.finding(Severity.WARNING, text, step.ref, "its_secplane"))
    return height, tuple(findings)


class PathBuilder:
    """Collect the steps of a tool path and track the tool position."""

    def __init__(self, job: ToolPathTask, start: Point, *, is_turning: bool = False) -> None:
        self._job = job
        self._start = start
        self._is_turning = is_turning
        self._steps: list[Step] = []
        self._cycles: list[CannedCycle] = []
        self._findings: list[Finding] = list(job.findings)
        self._plunge_feed = job.plunge_feed
        self.at = start
        """Current position of the tool."""

    @property
    def count(self) -> int:
        """Number of steps so far, the index of the next one."""
        return len(self._steps)

    def rapid(self, end: Point, type: MoveType = MoveType.RAPID) -> None:
        """Append a straight rapid move."""
        self.add(Move(end=end, type=type))

    def descend(self, end: Point, type: MoveType = MoveType.RAPID) -> None:
        """Move straight down: in rapid where no stock can be, then at the feed."""
        x, y, z = end
        safe_z = min(self._job.rapid_z(end), self.at[2])
        self.rapid((x, y, max(safe_z, z)), type)
        self.line(end, MoveType.NO_CONTACT)

    def line(self, end: Point, type: MoveType, feed: Feed | None = None) -> None:
        """Append a straight move at the programmed feed or a given feed."""
        self.add(Move(end=end, type=type, feed=feed or self._feed(end, type)))

    def arc(
        self,
        end: Point,
        type: MoveType,
        *,
        centre: Point,
        turn: float,
        plane: ArcPlane = ArcPlane.XY,
    ) -> None:
        """Append an arc about a centre at the programmed feed."""
        arc = Arc(centre=centre, turn=turn, plane=plane)
        self.add(Move(end=end, type=type, feed=self._feed(end, type), arc=arc))

    def _feed(self, end: Point, type: MoveType) -> Feed:
        """Programmed feed, or the plunge feed for an approach that goes down."""
        is_plunge = type is MoveType.APPROACH and end[2] < self.at[2] - SAME
        return self._plunge_feed if is_plunge else self._job.feed

    def add(self, move: Move) -> None:
        """Append a move, unless it has no length."""
        if move.arc is None and _is_same(self.at, move.end):
            return
        self._steps.append(move)
        self.at = move.end

    def dwell(self, *, seconds: float | None = None, revolutions: float | None = None) -> None:
        """Append a dwell in seconds or revolutions."""
        self._steps.append(Dwell(seconds=seconds, revolutions=revolutions))

    def spindle(self, command: SpindleCommand) -> None:
        """Append a spindle command: stop, start or reverse."""
        self._steps.append(command)

    def cycle(self, cycle: CannedCycle) -> None:
        """Record that a run of steps is a canned cycle of controls."""
        self._cycles.append(cycle)

    def find(self, finding: Finding) -> None:
        """Add a finding to the tool path, unless it is already there."""
        if finding not in self._findings:
            self._findings.append(finding)

    def warn(self, message: str, ref: Ref[Entity], attribute: str = "") -> None:
        """Add a warning to the tool path, unless it is already there."""
        self.find(self._job.warning(message, ref, attribute))

    def finished(self) -> ToolPath:
        """Tool path built from all collected steps."""
        step = self._job.step
        return ToolPath(
            workingstep=step.ref,
            id=step.id,
            operation_ref=step.operation_ref,
            tool_ref=step.tool_ref,
            technology_ref=step.technology_ref,
            functions_ref=step.functions_ref,
            is_turning=self._is_turning,
            start=self._start,
            steps=tuple(self._steps),
            cycles=tuple(self._cycles),
            findings=tuple(self._findings),
        )


def _is_same(one: Point, other: Point) -> bool:
    return (
        abs(one[0] - other[0]) < SAME
        and abs(one[1] - other[1]) < SAME
        and abs(one[2] - other[2]) < SAME
    )
