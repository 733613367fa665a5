"""Turning passes: scan lines down to a surface, passes along it, and the moves between them.

Steps 3 and 4 of Shin et al. (2016), section 3.2.2. A scan line is cut where the nose centre
is allowed at its level and where it touches the stock; where a line starts behind remaining
material, the tool descends along that material.

The approach to the first cut and the retract from the last one follow the operation:
ISO 14649-11 ``ap_retract_angle`` (straight, at an angle to the path) and
``ap_retract_tangent`` (a quarter of a circle tangential to the path). The other strategies
plunge, which a lathe does anyway.
"""

from collections.abc import Sequence
from math import cos, dist, pi, sin

from stepnc_model.entities.milling import (
    ApproachRetractStrategy,
    ApRetractAngle,
    ApRetractTangent,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.path_builder import (
    RAPID_CLEARANCE,
    TOUCH,
    TurningPathBuilder,
    split,
)
from stepnc_model.toolpath.turning.profile import (
    NARROW,
    ProfilePiece,
    RadiusProfile,
    Spot,
    arc_pieces,
)
from stepnc_model.toolpath.turning.setting import (
    ALONG,
    DEFAULT_OVERCUT,
    PassLink,
    TurningSetting,
    operation_of,
)
from stepnc_model.units import rad_from_deg

LEAST_LIFT = 0.05
"""Least lift off the surface for a rapid return over it, mm."""

BLOCKED = "would hit the remaining stock: the tool takes a clear route along the axes"


def lift_off(walk: TurningPathBuilder, link: PassLink) -> None:
    """Lift off the surface after a pass; straight out where the lift direction would cut."""
    direction = link.lift or _customary(link)
    end = _moved(walk.at, direction, link.lift_height)
    if walk.meets(ProfilePiece(start=walk.at, end=end)):
        if link.lift is not None:
            _warn(
                walk,
                link,
                "lift_direction",
                "the lift would hit the remaining stock: lifting straight out",
            )
        direction = (0.0, 1.0)
    walk.lift(direction, link.lift_height)


def onward(walk: TurningPathBuilder, link: PassLink, start: Spot) -> None:
    """Lift, return and step over to the start of the next pass."""
    if not walk.has_cut:
        walk.travel(start)
        return
    lift_off(walk, link)
    back, stepover = link.back, link.stepover
    is_ahead = (start[0] - walk.at[0]) * link.ahead[0] > TOUCH
    if back is None or stepover is None or is_ahead:
        walk.travel(start)
        return
    gain = link.lift_height * (link.lift or _customary(link))[1]
    if gain < LEAST_LIFT:
        text = (
            f"{gain:g} mm off the surface is too little for a rapid: the tool retracts further"
        )
        _warn(walk, link, "lift_height", text)
        walk.travel(start)
        return
    corner = meeting((walk.at, back), (start, stepover))
    if corner is None:
        if not (_is_straight(back) and _is_straight(stepover)):
            text = "does not lead to the next pass: the tool moves along the axes"
            _warn(walk, link, "back_path_direction", text)
        walk.travel(start)
    elif walk.meets(ProfilePiece(start=walk.at, end=corner)):
        _warn(walk, link, "back_path_direction", f"the return path {BLOCKED}")
        walk.travel(start)
    elif walk.meets(ProfilePiece(start=corner, end=start)):
        _warn(walk, link, "stepover_direction", f"the stepover {BLOCKED}")
        walk.travel(start)
    else:
        walk.rush(corner, min(gain, RAPID_CLEARANCE))
        _step(walk, link, start)


def step_over(walk: TurningPathBuilder, link: PassLink, start: Spot, ahead: float) -> Spot:
    """Step over to the next pass without a lift; return where that pass starts."""
    if link.stepover is None or not walk.has_cut:
        walk.travel(start)
        return start
    end = meeting((walk.at, link.stepover), (start, (-ahead, 0.0)))
    if end is None or walk.meets(ProfilePiece(start=walk.at, end=end)):
        if not _is_straight(link.stepover):
            _warn(walk, link, "stepover_direction", f"the stepover {BLOCKED}")
        walk.travel(start)
        return start
    _step(walk, link, end)
    return end


def meeting(one: tuple[Spot, Spot], other: tuple[Spot, Spot]) -> Spot | None:
    """Corner of an L-shaped route: leave a point in one direction, arrive in another.

    Examples
    --------
    >>> meeting(((0.0, 1.0), (1.0, 0.0)), ((5.0, 0.0), (0.0, -1.0)))
    (5.0, 1.0)
    """
    (at, along), (end, into) = one, other
    u, v = end[0] - at[0], end[1] - at[1]
    cross = along[0] * into[1] - along[1] * into[0]
    if abs(cross) < ALONG:
        return None
    first = (u * into[1] - v * into[0]) / cross
    second = (along[0] * v - along[1] * u) / cross
    if first < -TOUCH or second < -TOUCH:
        return None
    return _moved(at, along, max(0.0, first))


def _step(walk: TurningPathBuilder, link: PassLink, end: Spot) -> None:
    """Make the stepover at its feed, or in rapid where no feed is given and there is room."""
    if link.is_stepover_fed:
        walk.step([ProfilePiece(start=walk.at, end=end)] if dist(walk.at, end) > TOUCH else [])
    else:
        walk.rush(end, RAPID_CLEARANCE)


def _customary(link: PassLink) -> Spot:
    return -link.ahead[0] * 0.5**0.5, 0.5**0.5


def _is_straight(direction: Spot) -> bool:
    return min(abs(direction[0]), abs(direction[1])) < ALONG


def _moved(spot: Spot, direction: Spot, by: float) -> Spot:
    return spot[0] + by * direction[0], spot[1] + by * direction[1]


def _warn(walk: TurningPathBuilder, link: PassLink, attribute: str, text: str) -> None:
    walk.course.warn(text, link.ref, attribute)


LEAST_CUT = 1e-3
"""Least contact length for which a pass is made, mm."""


def scan(
    walk: TurningPathBuilder,
    centres: RadiusProfile,
    level: float,
    setting: TurningSetting,
    *,
    towards: int,
) -> None:
    """Cut all material at one level.

    Parameters
    ----------
    centres : RadiusProfile
        Lowest allowed path of the nose centre.
    level : float, mm
        Height v of the nose centre.
    towards : int
        −1 for passes to the chuck or the axis, +1 for passes in the other direction.
    """
    spans = centres.below(level + TOUCH)
    for low, high in spans if towards > 0 else reversed(spans):
        touched = [
            (max(low, a), min(high, b))
            for a, b in walk.rim.above(level + TOUCH)
            if min(high, b) - max(low, a) > LEAST_CUT
        ]
        if touched:
            first, last = touched[0][0], touched[-1][1]
            start, end = (last, first) if towards < 0 else (first, last)
            bound = high if towards < 0 else low
            _line(walk, centres, (start, level), end, bound=bound, setting=setting)


def _line(
    walk: TurningPathBuilder,
    centres: RadiusProfile,
    start: Spot,
    end: float,
    *,
    bound: float,
    setting: TurningSetting,
) -> None:
    """Cut one scan line, including the approach to it."""
    u, level = start
    towards = 1.0 if end > u else -1.0
    before = u - towards * setting.overcut
    is_open = (bound - before) * towards <= 0.0
    if is_open or abs(bound - u) > LEAST_CUT:
        u = before if is_open else bound
        lead: Sequence[ProfilePiece] = ()
    else:
        u = bound
        lead = _descent(walk, centres, u, towards)
    start = lead[0].start if lead else (u, level)
    if not setting.is_to_and_fro:
        onward(walk, setting.link, start)
    elif lead:
        walk.travel(start)
    else:
        u, level = step_over(walk, setting.link, start, towards)
    foot = lead[-1].end if lead else (u, level)
    if lead and abs(foot[1] - level) > TOUCH:
        lead = [*lead, ProfilePiece(start=foot, end=(foot[0], level))]
        foot = (foot[0], level)
    if setting.is_to_and_fro:
        walk.step(lead)
        lead = ()
    walk.feed([*lead, ProfilePiece(start=foot, end=(end, level))])


def _descent(
    walk: TurningPathBuilder, centres: RadiusProfile, u: float, towards: float
) -> list[ProfilePiece]:
    """Descent to a scan line along the surface before it, from where the tool is free."""
    side = centres.within(u, centres.high) if towards < 0 else centres.within(centres.low, u)
    pieces = list(side.chain())
    if towards > 0.0:
        pieces = [piece.reversed() for piece in reversed(pieces)]
    way: list[ProfilePiece] = []
    for piece in pieces:
        for part, is_contact in split(piece, walk.rim):
            if not is_contact and not part.is_upright:
                return _backwards(way)
            way.append(part)
    return _backwards(way)


def _backwards(pieces: Sequence[ProfilePiece]) -> list[ProfilePiece]:
    return [piece.reversed() for piece in reversed(pieces)]


def touching(
    walk: TurningPathBuilder, chain: Sequence[ProfilePiece], overcut: float
) -> list[ProfilePiece]:
    """Part of a chain from its lead-in to its last cut; empty if it does not cut."""
    parts = [found for piece in chain for found in split(piece, walk.rim)]
    contacts = [i for i, (part, is_contact) in enumerate(parts) if is_contact and _is_cut(part)]
    if not contacts:
        return []
    inner = [part for part, _ in parts[contacts[0] : contacts[-1] + 1]]
    return [*_lead([part for part, _ in parts[: contacts[0]]], overcut), *inner]


def oriented(chain: Sequence[ProfilePiece], *, towards: int) -> list[ProfilePiece]:
    """Chain in the requested direction, given a chain that runs towards −u."""
    return list(chain) if towards < 0 else _backwards(chain)


def shortened(chain: Sequence[ProfilePiece], start: float) -> list[ProfilePiece]:
    """Chain towards −u without the part beyond a start position u."""
    found: list[ProfilePiece] = []
    for piece in chain:
        if piece.low >= start - NARROW and not piece.is_upright:
            continue
        is_cut = piece.high > start + NARROW and not piece.is_upright
        found.append(piece.part(start, piece.end[0]) if is_cut else piece)
    while found and found[0].is_upright:
        found.pop(0)
    return found


def _is_cut(part: ProfilePiece) -> bool:
    return abs(part.end[0] - part.start[0]) + abs(part.end[1] - part.start[1]) > LEAST_CUT


def _lead(before: Sequence[ProfilePiece], overcut: float) -> list[ProfilePiece]:
    """Last part of a chain that is at least as long as the overcut in u."""
    if not before or overcut <= 0.0:
        return []
    end = before[-1].end[0]
    towards = 1.0 if end > before[0].start[0] else -1.0
    start = end - towards * overcut
    lead: list[ProfilePiece] = []
    for piece in reversed(before):
        if not piece.is_upright and piece.low + NARROW < start < piece.high - NARROW:
            return [piece.part(start, piece.end[0]), *lead]
        lead.insert(0, piece)
        if (piece.start[0] - start) * towards <= NARROW:
            break
    return lead


def entrance(
    job: ToolPathTask, walk: TurningPathBuilder, pieces: Sequence[ProfilePiece], link: PassLink
) -> None:
    """Go to the start of a chain; before the first cut, use the approach strategy."""
    start = pieces[0].start
    along = pieces[0].tangent(start)
    lead = () if walk.has_cut else _lead_in(job, operation_of(job).approach, start, along)
    onward(walk, link, lead[0].start if lead else start)
    walk.feed(lead)


def departure(job: ToolPathTask, walk: TurningPathBuilder, link: PassLink) -> None:
    """Leave the last cut with the retract strategy, or else with the lift of every pass."""
    back = (-walk.heading[0], -walk.heading[1])
    lead = _lead_in(job, operation_of(job).retract, walk.at, back)
    if lead:
        walk.feed([piece.reversed() for piece in reversed(lead)])
    elif walk.has_cut:
        lift_off(walk, link)


def _lead_in(
    job: ToolPathTask, ref: Ref[ApproachRetractStrategy] | None, end: Spot, along: Spot
) -> tuple[ProfilePiece, ...]:
    """Lead-in to a spot where the path runs in a direction, on the side free of material."""
    strategy = job.program.get(ref) if ref is not None else None
    up = (along[1], -along[0])
    if up[1] < 0.0 or (up[1] == 0.0 and up[0] < 0.0):
        up = (-up[0], -up[1])
    if isinstance(strategy, ApRetractAngle):
        angle, length = rad_from_deg(strategy.angle), strategy.travel_length
        a, b = length * cos(angle), length * sin(angle)
        # Above 90 degrees it begins over the cut: no farther than the tool starts before it.
        if not (0.0 < length < 1e4 and 0.0 <= strategy.angle < 180.0) or a < -DEFAULT_OVERCUT:
            message = f"{length:g} mm at {strategy.angle:g} degrees is not a valid lead-in"
            raise job.fault(message, ref or job.step.ref)
        start = (end[0] - a * along[0] + b * up[0], end[1] - a * along[1] + b * up[1])
        return (ProfilePiece(start=start, end=end),)
    if isinstance(strategy, ApRetractTangent):
        size = strategy.radius
        if not 0.0 < size < 1e4:
            raise job.fault(
                f"approach radius {size:g} mm must be between 0 and 10 000 mm",
                ref or job.step.ref,
                "radius",
            )
        centre = (end[0] + size * up[0], end[1] + size * up[1])
        start = (centre[0] - size * along[0], centre[1] - size * along[1])
        is_left = along[0] * up[1] - along[1] * up[0] > 0.0
        turn = 0.5 * pi if is_left else -0.5 * pi
        return tuple(arc_pieces(start, end, centre=centre, turn=turn))
    return ()
