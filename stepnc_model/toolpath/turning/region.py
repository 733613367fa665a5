"""Removal volume of a turning workingstep: allowed nose centre positions and the stock.

Steps 1 and 2 of Shin et al. (2016), section 3.2.2: the volume between feature and bar, and its
offset by the nose. Behind its features, a workingstep respects the finished part. In front of
them the tool may pass: the surface is extended there, first tangentially and then straight.

The bar is taken as earlier workingsteps left it. Everything outside their features is gone,
except for their allowance and the material that their noses left in corners. Whatever no
feature of the program removes is the part.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, pi

from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.entities.turning import (
    Contouring,
    Facing,
    Groove,
    Grooving,
)
from stepnc_model.entities.turning_tools import TurningMachineCuttingTool
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.programs.program import ResolvedWorkingstep
from stepnc_model.toolpath.task import ToolPathTask, job_of
from stepnc_model.toolpath.turning.offset import (
    InsertFlanks,
    cut,
    excess,
    grown,
    lowered,
    reachable,
)
from stepnc_model.toolpath.turning.outline import FeatureOutline, outline_of
from stepnc_model.toolpath.turning.profile import (
    JOINT,
    HalfPlane,
    ProfilePiece,
    RadiusProfile,
    Spot,
    highest,
    level_line,
    lowest,
)
from stepnc_model.toolpath.turning.setting import DEFAULT_OVERCUT
from stepnc_model.units import rad_from_deg


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningBlank:
    """Bar in the chuck, as profiles of radius over z at three stages of the program."""

    raw: RadiusProfile
    """Bar before the program."""
    left: RadiusProfile
    """Bar before the workingstep."""
    part: RadiusProfile
    """Part after the program, as far as its features can be read."""
    findings: tuple[Finding, ...] = ()

    @property
    def radius(self) -> float:
        """Outside radius of the raw bar, mm."""
        return self.raw.top(self.raw.low, self.raw.high)


def surface_of(outlines: tuple[FeatureOutline, ...], plane: HalfPlane) -> RadiusProfile:
    """Surface that features leave, seen from outside; the deepest where features overlap."""
    surfaces = [highest(plane.seen(outline.pieces)) for outline in outlines]
    return lowest([piece for surface in surfaces for piece in surface.pieces])


SEEN = 1e-3
"""Least height of remaining material that is reported, mm."""

CLEAR = 1.0
"""Clearance in front of the overcut, mm."""

NEAR = 1e-3
"""Distance from the end of a piece at which its slope is sampled, mm."""

FLAT = 1e-9
"""Greatest sine of a surface angle that counts as parallel to the passes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TurningRegion:
    """Region to be turned, in the half plane of the passes, mm."""

    plane: HalfPlane
    nose: float
    """Nose radius, mm."""
    surface: RadiusProfile
    """Surface that remains after turning, without allowance."""
    stock: RadiusProfile
    low: float
    """Position u of the end of the features, mm."""
    front: float
    """Position u beyond which no material stands, mm."""
    own_high: float
    """Position u of the start of the features, mm."""
    floor: float
    """Least height v of the features (radius, or z in facing), mm."""
    wall: float | None
    """Height v of the wall at the end of the features, mm; None without a wall."""

    def centres(self, allowance: float) -> RadiusProfile:
        """Lowest allowed path of the nose centre, with an allowance in mm."""
        rolled = grown(self.surface, self.nose + allowance)
        return rolled.within(self._low(allowance), self.front)

    def chain(self, allowance: float) -> tuple[ProfilePiece, ...]:
        """Path of the nose centre along the surface, towards −u and up the wall at the end."""
        forward = self.centres(allowance).chain()
        backward = [piece.reversed() for piece in reversed(forward)]
        if backward and self.wall is not None and self.wall > backward[-1].end[1] + JOINT:
            end = backward[-1].end
            backward.append(ProfilePiece(start=end, end=(end[0], self.wall)))
        return tuple(backward)

    def _low(self, allowance: float) -> float:
        """Lowest position u of the nose centre: over the feature end, or at the wall."""
        reach = self.nose + allowance
        end = self.surface.within(self.low, self.low + reach).pieces
        foot = end[0].start[1] if end else -inf
        is_stopped = self.wall is not None and self.wall > foot + reach
        return self.low + reach if is_stopped else self.low


def region_of(
    job: ToolPathTask,
    bar: TurningBlank,
    outlines: tuple[FeatureOutline, ...],
    *,
    plane: HalfPlane,
    allowance: float,
    overcut: float,
) -> TurningRegion:
    """Region to be turned for a set of features.

    Parameters
    ----------
    allowance, overcut : float, mm
        Material that remains on the surface, and the feed length in front of the cut.
    """
    nose = job.tool.corner_radius or 0.0
    own = surface_of(outlines, plane)
    stock, part = plane.material(bar.left), plane.material(bar.part)
    ends = [s for o in outlines for p in plane.seen(o.pieces) for s in (p.start, p.end)]
    low, high = min(u for u, _ in ends), max(u for u, _ in ends)
    starts = [v for u, v in ends if high - u < JOINT]
    reach = nose + allowance
    front = max(stock.high, high) + reach + overcut + CLEAR
    continued = _continued(
        own, (high, max(starts)), min(starts), length=reach, front=front + reach
    )
    beyond = highest([*continued, *part.within(high, inf).pieces])
    pieces = [
        *part.within(-inf, low).pieces,
        *own.pieces,
        *_gaps(part, own),
        *beyond.pieces,
    ]
    beside = part.within(low - 10.0 * JOINT, low)
    foot = own.at(low) if own.pieces else min(starts)
    return TurningRegion(
        plane=plane,
        nose=nose,
        surface=reachable(
            RadiusProfile(pieces=tuple(sorted(pieces, key=lambda piece: piece.low))),
            edges_of(job, plane),
        ),
        stock=stock,
        low=low,
        front=front,
        own_high=high,
        floor=min(v for _, v in ends),
        wall=beside.top(-inf, inf) if beside.top(-inf, inf) > foot + JOINT else None,
    )


def edges_of(job: ToolPathTask, plane: HalfPlane) -> InsertFlanks:
    """Angles of the insert edges, from the ISO 3002-1 angles of the file.

    The major edge stands at the cutting edge angle from the feed to the chuck; the minor edge
    stands at 180° minus that angle and the included angle from the turned surface. Without an
    included angle the tool cannot follow a falling wall.
    """
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, TurningMachineCuttingTool):
        raise job.fault("is not a turning tool", job.step.tool_ref)
    edge = job.program.get(tool.cutting_edge)
    major = rad_from_deg(edge.tool_cutting_edge_angle or 90.0)
    minor = max(0.0, pi - major - rad_from_deg(edge.tool_included_angle or 90.0))
    if plane.is_across:
        return InsertFlanks(behind=min(max(0.0, major - 0.5 * pi), 0.5 * pi))
    ahead = min(major, 0.5 * pi)
    if tool.hand_of_tool is HandOfToolType.LEFT:
        return InsertFlanks(ahead=minor, behind=ahead)
    if tool.hand_of_tool is HandOfToolType.NEUTRAL:
        return InsertFlanks(ahead=ahead, behind=ahead)
    return InsertFlanks(ahead=ahead, behind=minor)


def leftovers(
    job: ToolPathTask, region: TurningRegion, outlines: tuple[FeatureOutline, ...]
) -> Iterator[Finding]:
    """Report material of the features that the insert's shape cannot reach."""
    seen = [piece for outline in outlines for piece in region.plane.seen(outline.pieces)]
    left = excess(region.surface, [piece for piece in seen if not piece.is_upright])
    if left > SEEN:
        text = f"the insert edges cannot reach an undercut: up to {left:.3g} mm remain"
        yield job.warning(text, outlines[0].ref)
    tight = [
        p.radius for p in seen if p.centre and p.side < 0 and p.radius < region.nose - SEEN
    ]
    if tight:
        text = (
            f"an inside radius of {min(tight):.3g} mm is smaller than the nose radius of "
            f"{region.nose:.3g} mm: material remains in the corner"
        )
        yield job.warning(text, outlines[0].ref)


def _gaps(part: RadiusProfile, own: RadiusProfile) -> Iterator[ProfilePiece]:
    """Surface of the finished part in the gaps between features."""
    for one, other in pairwise(own.pieces):
        if other.low - one.high > JOINT:
            yield from part.within(one.high, other.low).pieces


def _continued(
    surface: RadiusProfile, foremost: Spot, lowest_start: float, *, length: float, front: float
) -> Iterator[ProfilePiece]:
    """Extension of the surface in front of its start: along its tangent, then flat."""
    u, v = foremost
    level = min(v, lowest_start)
    if lowest_start < v - JOINT:
        level = lowest_start - length
    elif surface.pieces:
        last = surface.pieces[-1]
        inside = last.high - min(NEAR, 0.5 * (last.high - last.low))
        along = last.tangent(foremost)
        if last.at(inside) > v and abs(along[1]) > FLAT:
            # An upright tangent has no direction in u: fall towards the front.
            end = (u + length * abs(along[0]), v - length * abs(along[1]))
            if end[0] - u > JOINT:
                yield ProfilePiece(start=foremost, end=end)
            u, level = end
    yield level_line(level, u, front)


FACING_STOCK = 5.0
"""Bar in front of a contour that counts as waste even if no feature faces it off, mm."""

Known = dict[int, FeatureOutline | None]
"""Outlines by feature number; None for a feature that cannot be read."""


def bar_of(job: ToolPathTask, outlines: tuple[FeatureOutline, ...]) -> TurningBlank:
    """Bar before a workingstep; without stock in the file, a bar around the features."""
    raw, findings = _raw(job, outlines)
    reach = raw.top(raw.low, raw.high)
    known: Known = {}
    part = raw
    for step in job.program.workingsteps:
        surfaces = _outlines(job, step, reach, known)
        if surfaces:
            part = lowered(part, surface_of(surfaces, HalfPlane()))
    bar = TurningBlank(raw=raw, left=raw, part=_trimmed(job, part, known), findings=findings)
    for step in job.program.workingsteps[: job.step.index]:
        surfaces = _outlines(job, step, reach, known)
        if surfaces:
            bar = replace(bar, left=_after(job, step, surfaces, bar))
    return bar


def _after(
    job: ToolPathTask,
    step: ResolvedWorkingstep,
    outlines: tuple[FeatureOutline, ...],
    bar: TurningBlank,
) -> RadiusProfile:
    """Bar after an earlier workingstep; unchanged if that step cannot be evaluated."""
    allowance = max(0.0, getattr(step.operation, "allowance", None) or 0.0)
    if isinstance(step.operation, Facing):
        # A bar that is only assumed is faced as a whole.
        whole = 0.0 if job.stock is not None else bar.raw.top(bar.raw.low, bar.raw.high)
        return _faced(outlines, allowance, bar.left, reach=whole)
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


def _raw(
    job: ToolPathTask, outlines: tuple[FeatureOutline, ...]
) -> tuple[RadiusProfile, tuple[Finding, ...]]:
    """Raw bar of the file, or an assumed bar around the features, with findings."""
    stock = job.stock
    if stock is not None and stock.high[2] > stock.low[2]:
        radius = stock.radius or max(map(abs, (*stock.low[:2], *stock.high[:2])))
        return _cylinder(radius, stock.low[2], stock.high[2]), ()
    radius = max(outline.radii[1] for outline in outlines)
    radius = max((outline.radii[1] for outline in _around(job, radius)), default=radius)
    low, high = min(o.low for o in outlines), max(o.high for o in outlines)
    text = f"no stock given: assuming a bar of {2.0 * radius:g} mm diameter, as the features"
    length = _to_face(job)
    if length > 0.0:
        high += length
        text += f", and {length:g} mm to face off"
    finding = job.program.finding(Severity.WARNING, text, job.step.ref)
    return _cylinder(radius, min(low, high - JOINT), high), (finding,)


def _cylinder(radius: float, low: float, high: float) -> RadiusProfile:
    return RadiusProfile(pieces=(level_line(radius, low, high),))


def _outlines(
    job: ToolPathTask, step: ResolvedWorkingstep, reach: float, known: Known
) -> tuple[FeatureOutline, ...]:
    """Readable outlines of the features that another workingstep turns."""
    if not isinstance(step.operation, (Contouring, Facing, Grooving)):
        return ()
    for ref in step.features:
        if int(ref) not in known:
            try:
                known[int(ref)] = outline_of(job, ref, reach)
            except SchemaError:
                # That workingstep reports its own error; here the bar just stays unchanged.
                known[int(ref)] = None
    found = (known[int(ref)] for ref in step.features)
    return tuple(outline for outline in found if outline is not None)


def _faced(
    outlines: tuple[FeatureOutline, ...],
    allowance: float,
    left: RadiusProfile,
    *,
    reach: float,
) -> RadiusProfile:
    """Bar after everything in front of faced features is removed, if they face all of it.

    Parameters
    ----------
    allowance : float, mm
    left : RadiusProfile
        Bar before.
    reach : float, mm
        Radius up to which is faced, where the features themselves are smaller.
    """
    for outline in outlines:
        z = max(outline.low, outline.high) + allowance
        inner, outer = outline.radii
        front = left.within(z, left.high)
        if front.pieces and front.top(z, left.high) <= max(outer, reach) + JOINT:
            surface = [level_line(inner, z, left.high)]
            surface += grown(highest(outline.pieces), allowance).pieces
            left = lowered(left, highest(surface))
    return _without_front(left)


def _around(job: ToolPathTask, reach: float) -> Iterator[FeatureOutline]:
    """Outlines of all turned features, which a bar that is faced is to hold."""
    if isinstance(job.step.operation, Facing):
        known: Known = {}
        for step in job.program.workingsteps:
            yield from _outlines(job, step, reach, known)


def _to_face(job: ToolPathTask) -> float:
    """Length in front of a face that its facing takes off: one pass, and what it leaves, mm."""
    lengths = [0.0]
    for step in job.program.workingsteps:
        operation = step.operation
        is_here = isinstance(job.step.operation, Facing) and step.features == job.step.features
        if not is_here or not isinstance(operation, Facing):
            continue
        reference = operation.its_machining_strategy
        strategy = None if reference is None else job.program.get(reference)
        depths = getattr(strategy, "cutting_depth", None) or (0.0,)
        lengths.append(float(depths[0]) + (operation.allowance or 0.0))
    return max(lengths)


def _trimmed(job: ToolPathTask, part: RadiusProfile, known: Known) -> RadiusProfile:
    """Part without the bar in front of its foremost feature, not counting grooves."""
    outlines = [outline for outline in known.values() if outline is not None]
    fronts = [o.high for o in outlines if not isinstance(job.program.get(o.ref), Groove)]
    front = max(fronts, default=part.high)
    return part.within(part.low, front) if front > part.high - FACING_STOCK else part


def _without_front(left: RadiusProfile) -> RadiusProfile:
    """Bar without front pieces of zero radius."""
    pieces: list[ProfilePiece] = list(left.pieces)
    while pieces and max(pieces[-1].start[1], pieces[-1].end[1]) <= JOINT:
        pieces.pop()
    return RadiusProfile(pieces=tuple(pieces))
