"""The bar before a workingstep, as earlier workingsteps left it.

Everything outside the features of earlier workingsteps is gone, but for their allowance and
for what their noses left in corners. What no feature of the program removes is the part.
"""

from dataclasses import replace

from stepnc_model.entities.turning import Contouring, Facing, Grooving
from stepnc_model.entities.turning_features import Groove
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.program import Workingstep
from stepnc_model.toolpath.job import Job, job_of
from stepnc_model.toolpath.turning.offset import cut, grown, lowered
from stepnc_model.toolpath.turning.outline import Outline, outline_of
from stepnc_model.toolpath.turning.piece import Piece
from stepnc_model.toolpath.turning.plane import HalfPlane
from stepnc_model.toolpath.turning.profile import JOINT, Profile, highest, level_line
from stepnc_model.toolpath.turning.region import region_of
from stepnc_model.toolpath.turning.setting import DEFAULT_OVERCUT
from stepnc_model.toolpath.turning.stock import Bar, surface_of

FACING_STOCK = 5.0
"""mm of bar in front of a contour that is waste even where no feature faces it off"""

Known = dict[int, Outline | None]
"""outlines by the number of their feature; None where one cannot be read"""


def bar_of(job: Job, outlines: tuple[Outline, ...]) -> Bar:
    """The bar before a workingstep; where the file has none, as large as the features."""
    raw, findings = _raw(job, outlines)
    reach = raw.top(raw.low, raw.high)
    known: Known = {}
    part = raw
    for step in job.program.workingsteps:
        surfaces = _outlines(job, step, reach, known)
        if surfaces:
            part = lowered(part, surface_of(surfaces, HalfPlane()))
    bar = Bar(raw=raw, left=raw, part=_trimmed(job, part, known), findings=findings)
    for step in job.program.workingsteps[: job.step.index]:
        surfaces = _outlines(job, step, reach, known)
        if surfaces:
            bar = replace(bar, left=_after(job, step, surfaces, bar))
    return bar


def _after(job: Job, step: Workingstep, outlines: tuple[Outline, ...], bar: Bar) -> Profile:
    """What an earlier workingstep leaves; the bar as it is where that step makes no sense."""
    allowance = max(0.0, getattr(step.operation, "allowance", None) or 0.0)
    if isinstance(step.operation, Facing):
        return _faced(outlines, allowance, bar.left)
    if isinstance(step.operation, Grooving):
        surface = surface_of(outlines, HalfPlane())
        rest = grown(surface, allowance).within(surface.low, surface.high)
        return lowered(bar.left, rest)
    try:
        earlier = job_of(job.program, step)
        region = region_of(
            earlier,
            bar,
            outlines,
            plane=HalfPlane(),
            allowance=allowance,
            overcut=DEFAULT_OVERCUT,
        )
    except SchemaError:
        return bar.left
    chain = region.chain(allowance)
    if region.nose <= 0.0:
        return lowered(bar.left, highest(chain))
    return cut(bar.left, chain, region.nose)


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


def _outlines(job: Job, step: Workingstep, reach: float, known: Known) -> tuple[Outline, ...]:
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


def _trimmed(job: Job, part: Profile, known: Known) -> Profile:
    """A part without the bar in front of its foremost feature; a groove's walls are none."""
    outlines = [outline for outline in known.values() if outline is not None]
    fronts = [o.high for o in outlines if not isinstance(job.program.get(o.ref), Groove)]
    front = max(fronts, default=part.high)
    return part.within(part.low, front) if front > part.high - FACING_STOCK else part


def _without_front(left: Profile) -> Profile:
    """A bar without the front that has no radius any more."""
    pieces: list[Piece] = list(left.pieces)
    while pieces and max(pieces[-1].start[1], pieces[-1].end[1]) <= JOINT:
        pieces.pop()
    return Profile(pieces=tuple(pieces))
