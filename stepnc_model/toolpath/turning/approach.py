"""Approach to the first cut and retract from the last one, where the operation says how.

ISO 14649-11 ``ap_retract_angle`` (straight, at an angle to the path) and
``ap_retract_tangent`` (a quarter of a circle that meets the path tangentially). The others
plunge, which a lathe does anyway.
"""

from collections.abc import Sequence
from math import cos, pi, sin

from stepnc_model.entities.approach import (
    ApproachRetractStrategy,
    ApRetractAngle,
    ApRetractTangent,
)
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.turning.link import Link
from stepnc_model.toolpath.turning.onward import lift_off, onward
from stepnc_model.toolpath.turning.piece import Piece, Spot, arc_pieces
from stepnc_model.toolpath.turning.stock import operation_of
from stepnc_model.toolpath.turning.walk import Walk
from stepnc_model.units import rad_from_deg


def entrance(job: Job, walk: Walk, pieces: Sequence[Piece], link: Link) -> None:
    """Go to where a chain starts; before the first cut as the approach says."""
    start = pieces[0].start
    along = pieces[0].tangent(start)
    lead = () if walk.has_cut else _lead(job, operation_of(job).approach, start, along)
    onward(walk, link, lead[0].start if lead else start)
    walk.feed(lead)


def departure(job: Job, walk: Walk, link: Link) -> None:
    """Leave the last cut as the retract says, else by the lift of every pass."""
    back = (-walk.heading[0], -walk.heading[1])
    lead = _lead(job, operation_of(job).retract, walk.at, back)
    if lead:
        walk.feed([piece.reversed() for piece in reversed(lead)])
    elif walk.has_cut:
        lift_off(walk, link)


def _lead(
    job: Job, ref: Ref[ApproachRetractStrategy] | None, end: Spot, along: Spot
) -> tuple[Piece, ...]:
    """The way to a spot where the path runs along a direction, over the free side."""
    strategy = job.program.get(ref) if ref is not None else None
    up = (along[1], -along[0])
    if up[1] < 0.0 or (up[1] == 0.0 and up[0] < 0.0):
        up = (-up[0], -up[1])
    if isinstance(strategy, ApRetractAngle):
        angle, length = rad_from_deg(strategy.angle), strategy.travel_length
        if not (0.0 < length < 1e4 and 0.0 <= strategy.angle <= 90.0):
            message = f"{length:g} mm at {strategy.angle:g} degrees is no way to the path"
            raise job.fault(message, ref or job.step.ref)
        a, b = length * cos(angle), length * sin(angle)
        start = (end[0] - a * along[0] + b * up[0], end[1] - a * along[1] + b * up[1])
        return (Piece(start=start, end=end),)
    if isinstance(strategy, ApRetractTangent):
        size = strategy.radius
        if not 0.0 < size < 1e4:
            raise job.fault(f"a radius of {size:g} mm", ref or job.step.ref, "radius")
        centre = (end[0] + size * up[0], end[1] + size * up[1])
        start = (centre[0] - size * along[0], centre[1] - size * along[1])
        is_left = along[0] * up[1] - along[1] * up[0] > 0.0
        turn = 0.5 * pi if is_left else -0.5 * pi
        return tuple(arc_pieces(start, end, centre=centre, turn=turn))
    return ()
