"""Removal volume of a turning workingstep: where the centre of the nose may be, and the stock.

Steps 1 and 2 of Shin et al. (2016), section 3.2.2: the volume between feature and bar, and its
offset by the nose. Beside its features a workingstep keeps to what the part will be there. In
front of them it may pass: the surface is continued there, tangentially and then straight.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import inf, pi

from stepnc_model.entities.enums import HandOfToolType
from stepnc_model.entities.turning_tools import TurningMachineCuttingTool
from stepnc_model.errors import Finding
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.offset import Edges, excess, grown, reachable
from stepnc_model.toolpath.turning.outline import Outline
from stepnc_model.toolpath.turning.piece import Piece, Spot
from stepnc_model.toolpath.turning.plane import HalfPlane
from stepnc_model.toolpath.turning.profile import JOINT, Profile, highest, level_line
from stepnc_model.toolpath.turning.stock import Bar, surface_of
from stepnc_model.units import rad_from_deg

SEEN = 1e-3
"""mm of material left behind that is worth a word"""

CLEAR = 1.0
"""mm of room in front of the overcut"""

NEAR = 1e-3
"""mm beside an end at which its piece is looked at"""

FLAT = 1e-9
"""sine of a surface that is parallel to the passes"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Region:
    """What is to be turned, in the half plane of the passes."""

    plane: HalfPlane
    nose: float
    """mm, radius"""
    surface: Profile
    """what stays, without allowance"""
    stock: Profile
    low: float
    """mm, u where the features end"""
    front: float
    """mm, u beyond which nothing stands"""
    own_high: float
    """mm, u where the features begin"""
    floor: float
    """mm, least v of the features"""
    wall: float | None
    """mm, v up to which something stands at their end"""

    def centres(self, allowance: float) -> Profile:
        """Where the centre of the nose may be at the lowest."""
        rolled = grown(self.surface, self.nose + allowance)
        return rolled.within(self._low(allowance), self.front)

    def chain(self, allowance: float) -> tuple[Piece, ...]:
        """The way of the centre along the surface, towards −u and up the wall at the end."""
        forward = self.centres(allowance).chain()
        backward = [piece.reversed() for piece in reversed(forward)]
        if backward and self.wall is not None and self.wall > backward[-1].end[1] + JOINT:
            end = backward[-1].end
            backward.append(Piece(start=end, end=(end[0], self.wall)))
        return tuple(backward)

    def _low(self, allowance: float) -> float:
        """Where the centre stops: over the end, or beside the wall."""
        reach = self.nose + allowance
        end = self.surface.within(self.low, self.low + reach).pieces
        foot = end[0].start[1] if end else -inf
        is_stopped = self.wall is not None and self.wall > foot + reach
        return self.low + reach if is_stopped else self.low


def region_of(
    job: Job,
    bar: Bar,
    outlines: tuple[Outline, ...],
    *,
    plane: HalfPlane,
    allowance: float,
    overcut: float,
) -> Region:
    """Removal volume of features.

    Parameters
    ----------
    job : Job
    bar : Bar
    outlines : tuple of Outline
    plane : HalfPlane
    allowance, overcut : float, mm
        Material that stays, and the way in front of the cut.
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
    return Region(
        plane=plane,
        nose=nose,
        surface=reachable(
            Profile(pieces=tuple(sorted(pieces, key=lambda piece: piece.low))),
            edges_of(job, plane),
        ),
        stock=stock,
        low=low,
        front=front,
        own_high=high,
        floor=min(v for _, v in ends),
        wall=beside.top(-inf, inf) if beside.top(-inf, inf) > foot + JOINT else None,
    )


def edges_of(job: Job, plane: HalfPlane) -> Edges:
    """How steeply the edges of the insert rise, by ISO 3002-1 angles of the file.

    The major edge stands at the cutting edge angle from the feed to the chuck, the minor one
    at 180° less that and the included angle from the turned surface. An included angle that
    is not given lets the tool go along no falling wall.
    """
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, TurningMachineCuttingTool):
        raise job.fault("is no turning tool", job.step.tool_ref)
    edge = job.program.get(tool.cutting_edge)
    major = rad_from_deg(edge.tool_cutting_edge_angle or 90.0)
    minor = max(0.0, pi - major - rad_from_deg(edge.tool_included_angle or 90.0))
    if plane.is_across:
        return Edges(behind=min(max(0.0, major - 0.5 * pi), 0.5 * pi))
    ahead = min(major, 0.5 * pi)
    if tool.hand_of_tool is HandOfToolType.LEFT:
        return Edges(ahead=minor, behind=ahead)
    if tool.hand_of_tool is HandOfToolType.NEUTRAL:
        return Edges(ahead=ahead, behind=ahead)
    return Edges(ahead=ahead, behind=minor)


def leftovers(job: Job, region: Region, outlines: tuple[Outline, ...]) -> Iterator[Finding]:
    """What the shape of the insert leaves of the features."""
    seen = [piece for outline in outlines for piece in region.plane.seen(outline.pieces)]
    left = excess(region.surface, [piece for piece in seen if not piece.is_upright])
    if left > SEEN:
        text = (
            f"an undercut that the edges of the insert cannot reach: up to {left:.3g} mm stay"
        )
        yield job.warning(text, outlines[0].ref)
    tight = [
        p.radius for p in seen if p.centre and p.side < 0 and p.radius < region.nose - SEEN
    ]
    if tight:
        text = (
            f"an inside radius of {min(tight):.3g} mm is smaller than the nose, "
            f"{region.nose:.3g} mm: what the nose leaves stays"
        )
        yield job.warning(text, outlines[0].ref)


def _gaps(part: Profile, own: Profile) -> Iterator[Piece]:
    """The part between features."""
    for one, other in pairwise(own.pieces):
        if other.low - one.high > JOINT:
            yield from part.within(one.high, other.low).pieces


def _continued(
    surface: Profile, foremost: Spot, lowest_start: float, *, length: float, front: float
) -> Iterator[Piece]:
    """The surface in front of its start: along its tangent, then flat."""
    u, v = foremost
    level = min(v, lowest_start)
    if lowest_start < v - JOINT:
        level = lowest_start - length
    elif surface.pieces:
        last = surface.pieces[-1]
        inside = last.high - min(NEAR, 0.5 * (last.high - last.low))
        along = last.tangent(foremost)
        if last.at(inside) > v and abs(along[1]) > FLAT:
            # Upright tangents have no sign of their own: it falls towards the front.
            end = (u + length * abs(along[0]), v - length * abs(along[1]))
            if end[0] - u > JOINT:
                yield Piece(start=foremost, end=end)
            u, level = end
    yield level_line(level, u, front)
