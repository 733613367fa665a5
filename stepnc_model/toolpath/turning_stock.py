"""The bar before a workingstep: radii over the spindle axis, as earlier workingsteps left it.

Everything outside the features of earlier workingsteps is gone, but for their allowance and
for what their noses left in corners. What lies between and beside features is the part.
"""

from dataclasses import dataclass

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.turning import (
    Contouring,
    Facing,
    Grooving,
    TurningMachiningOperation,
)
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.program import Workingstep
from stepnc_model.tool import tool_of
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning_offset import cut, grown, lowered
from stepnc_model.toolpath.turning_outline import Outline, outline_of
from stepnc_model.toolpath.turning_piece import Piece
from stepnc_model.toolpath.turning_plane import HalfPlane
from stepnc_model.toolpath.turning_profile import JOINT, Profile, highest, level_line, lowest

FACING_STOCK = 5.0
"""mm of bar in front of a contour that is waste even where no feature faces it off"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bar:
    """What stands in the chuck, as profiles of radii over z."""

    raw: Profile
    """before the program"""
    left: Profile
    """before the workingstep"""
    part: Profile
    """after the program, as far as its features can be read"""
    findings: tuple[Finding, ...] = ()

    @property
    def radius(self) -> float:
        """Outside radius of the raw bar, mm."""
        return self.raw.top(self.raw.low, self.raw.high)


def bar_of(job: Job, outlines: tuple[Outline, ...]) -> Bar:
    """The bar before a workingstep; where the file has none, as large as the features."""
    raw, findings = _raw(job, outlines)
    radius = raw.top(raw.low, raw.high)
    left = part = raw
    known: dict[int, Outline | None] = {}
    for step in job.program.workingsteps:
        surfaces = _outlines(job, step, radius, known)
        if step.index < job.step.index and surfaces:
            left = _after(job, step, surfaces, left)
        part = _less(part, surfaces)
    return Bar(raw=raw, left=left, part=_trimmed(part, known), findings=findings)


def surface_of(outlines: tuple[Outline, ...], plane: HalfPlane) -> Profile:
    """Surface that features leave, seen from outside; the deeper one where they overlap."""
    surfaces = [highest(plane.seen(outline.pieces)) for outline in outlines]
    return lowest([piece for surface in surfaces for piece in surface.pieces])


def allowance_of(job: Job, ref: Ref[Entity], operation: MachiningOperation) -> float:
    """Material that an operation leaves on the feature, mm."""
    allowance = getattr(operation, "allowance", None) or 0.0
    if not 0.0 <= allowance < 1e3:
        message = f"an allowance of {allowance:g} mm: it must not be negative"
        raise job.fault(message, ref, "allowance")
    return float(allowance)


def _raw(job: Job, outlines: tuple[Outline, ...]) -> tuple[Profile, tuple[Finding, ...]]:
    """The bar of the file, or one around the features."""
    stock = job.stock
    if stock is not None and stock.high[2] > stock.low[2]:
        radius = stock.radius or max(map(abs, (*stock.low[:2], *stock.high[:2])))
        return _cylinder(radius, stock.low[2], stock.high[2]), ()
    radius = max(outline.radii[1] for outline in outlines)
    low, high = min(o.low for o in outlines), max(o.high for o in outlines)
    text = f"no bar is known: a diameter of {2.0 * radius:g} mm, that of the features, assumed"
    finding = job.program.finding(Severity.WARNING, text, job.step.ref)
    return _cylinder(radius, min(low, high - JOINT), high), (finding,)


def _cylinder(radius: float, low: float, high: float) -> Profile:
    return Profile(pieces=(level_line(radius, low, high),))


def _outlines(
    job: Job, step: Workingstep, reach: float, known: dict[int, Outline | None]
) -> tuple[Outline, ...]:
    """Outlines of the features that another workingstep turns and that can be read."""
    if not isinstance(step.operation, (Contouring, Facing, Grooving)):
        return ()
    for ref in step.features:
        if int(ref) not in known:
            try:
                known[int(ref)] = outline_of(job, ref, reach)
            except SchemaError:
                # Its own workingstep says what is wrong; here the bar just stays as it was.
                known[int(ref)] = None
    found = (known[int(ref)] for ref in step.features)
    return tuple(outline for outline in found if outline is not None)


def _after(
    job: Job, step: Workingstep, outlines: tuple[Outline, ...], left: Profile
) -> Profile:
    """What an earlier workingstep leaves."""
    allowance = max(0.0, getattr(step.operation, "allowance", None) or 0.0)
    if isinstance(step.operation, Facing):
        return _faced(outlines, allowance, left)
    surface = surface_of(outlines, HalfPlane())
    if isinstance(step.operation, Grooving):
        return lowered(left, grown(surface, allowance).within(surface.low, surface.high))
    try:
        nose = tool_of(job.program, step.tool_ref).corner_radius or 0.0
    except SchemaError:
        nose = 0.0
    centre = grown(surface, nose + allowance).within(surface.low, surface.high)
    if nose <= 0.0:
        return lowered(left, centre)
    return cut(left, centre.chain(), nose)


def _faced(outlines: tuple[Outline, ...], allowance: float, left: Profile) -> Profile:
    """A bar without what stood in front of faces."""
    for outline in outlines:
        z = max(outline.low, outline.high) + allowance
        inner, outer = outline.radii
        front = left.within(z, left.high)
        if front.pieces and front.top(z, left.high) <= outer + JOINT:
            surface = [level_line(inner, z, left.high)]
            surface += grown(highest(outline.pieces), allowance).pieces
            left = lowered(left, highest(surface))
    return _without_front(left)


def _less(part: Profile, outlines: tuple[Outline, ...]) -> Profile:
    """A part without what its features remove; faces are for :func:`_trimmed`."""
    if not outlines:
        return part
    return lowered(part, surface_of(outlines, HalfPlane()))


def _trimmed(part: Profile, known: dict[int, Outline | None]) -> Profile:
    """A part without the bar in front of its foremost feature."""
    fronts = [outline.high for outline in known.values() if outline is not None]
    front = max(fronts, default=part.high)
    return part.within(part.low, front) if front > part.high - FACING_STOCK else part


def _without_front(left: Profile) -> Profile:
    """A bar without the front that has no radius any more."""
    pieces: list[Piece] = list(left.pieces)
    while pieces and max(pieces[-1].start[1], pieces[-1].end[1]) <= JOINT:
        pieces.pop()
    return Profile(pieces=tuple(pieces))


def operation_of(job: Job) -> TurningMachiningOperation:
    """The operation of a turning workingstep."""
    operation = job.step.operation
    if not isinstance(operation, TurningMachiningOperation):
        raise job.fault("is no operation of a lathe", job.step.operation_ref)
    return operation
