"""From the end of one pass to the start of the next one: lift, back path and step over.

"The rapid type maps with lift, backward and stepover paths to connect actual cutting paths":
Shin et al. (2016), section 3.2.2. Each is a move of its own. Where one as given would run into
what is left of the bar, the tool takes the clear way along the axes, and a finding says so.
"""

from math import dist

from stepnc_model.toolpath.turning.link import ALONG, Link
from stepnc_model.toolpath.turning.piece import Piece, Spot
from stepnc_model.toolpath.turning.walk import RAPID_CLEARANCE, TOUCH, Walk

LEAST_LIFT = 0.05
"""mm off the surface below which no rapid goes back over it"""

BLOCKED = "would run into what is left: the tool goes along the axes, where it is clear"


def lift_off(walk: Walk, link: Link) -> None:
    """Leave the surface after a pass; straight out where the lift would cut."""
    direction = link.lift or _customary(link)
    end = _moved(walk.at, direction, link.lift_height)
    if walk.meets(Piece(start=walk.at, end=end)):
        if link.lift is not None:
            _warn(
                walk,
                link,
                "lift_direction",
                "the lift would run into what is left: straight out",
            )
        direction = (0.0, 1.0)
    walk.lift(direction, link.lift_height)


def onward(walk: Walk, link: Link, start: Spot) -> None:
    """Lift, go back and step over to where the next pass starts."""
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
        text = f"{gain:g} mm off the surface are no room for a rapid: the tool goes up for it"
        _warn(walk, link, "lift_height", text)
        walk.travel(start)
        return
    corner = meeting((walk.at, back), (start, stepover))
    if corner is None:
        if not (_is_straight(back) and _is_straight(stepover)):
            text = "does not lead to the next pass: the tool goes along the axes"
            _warn(walk, link, "back_path_direction", text)
        walk.travel(start)
    elif walk.meets(Piece(start=walk.at, end=corner)):
        _warn(walk, link, "back_path_direction", f"the way back {BLOCKED}")
        walk.travel(start)
    elif walk.meets(Piece(start=corner, end=start)):
        _warn(walk, link, "stepover_direction", f"the step over {BLOCKED}")
        walk.travel(start)
    else:
        walk.rush(corner, min(gain, RAPID_CLEARANCE))
        _step(walk, link, start)


def step_over(walk: Walk, link: Link, start: Spot, ahead: float) -> Spot:
    """Go from one pass to the one back, without a lift; where that one then starts."""
    if link.stepover is None or not walk.has_cut:
        walk.travel(start)
        return start
    end = meeting((walk.at, link.stepover), (start, (-ahead, 0.0)))
    if end is None or walk.meets(Piece(start=walk.at, end=end)):
        if not _is_straight(link.stepover):
            _warn(walk, link, "stepover_direction", f"the step over {BLOCKED}")
        walk.travel(start)
        return start
    _step(walk, link, end)
    return end


def meeting(one: tuple[Spot, Spot], other: tuple[Spot, Spot]) -> Spot | None:
    """Where a way from a spot along a direction turns into one that ends at another spot.

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


def _step(walk: Walk, link: Link, end: Spot) -> None:
    """The step over, at its feed; in rapid where it has none and there is room."""
    if link.is_stepover_fed:
        walk.step([Piece(start=walk.at, end=end)] if dist(walk.at, end) > TOUCH else [])
    else:
        walk.rush(end, RAPID_CLEARANCE)


def _customary(link: Link) -> Spot:
    return -link.ahead[0] * 0.5**0.5, 0.5**0.5


def _is_straight(direction: Spot) -> bool:
    return min(abs(direction[0]), abs(direction[1])) < ALONG


def _moved(spot: Spot, direction: Spot, by: float) -> Spot:
    return spot[0] + by * direction[0], spot[1] + by * direction[1]


def _warn(walk: Walk, link: Link, attribute: str, text: str) -> None:
    walk.course.warn(text, link.ref, attribute)
