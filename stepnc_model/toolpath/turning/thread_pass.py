"""One pass of a thread: in, along bound to the spindle, and out.

What meets the stock is contact; the run-in, the run-out and whatever else lies in air is none.
The parts of a run have one feed, so that a control makes one block of them.
"""

from dataclasses import dataclass
from math import tan

from stepnc_model.toolpath.course import Course
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.path import Feed, Move, MoveType
from stepnc_model.toolpath.turning.piece import Piece, Spot
from stepnc_model.toolpath.turning.profile import Profile
from stepnc_model.toolpath.turning.walk import split
from stepnc_model.units import rad_from_deg

MOST_RETURN = 0.5
"""of a pass that may go on the way out at an angle"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Pass:
    """One pass of a thread, mm."""

    start: float
    """z where the tool gathers speed"""
    end: float
    bottom: float
    """radius of the tip"""
    clear: float
    """radius of the way back"""
    angle: float | None
    """degrees from the axis at which the tool leaves; None: straight out"""
    has_relief: bool
    """nothing stands where the tool leaves"""


def cut_thread(
    job: Job, course: Course, one: Pass, *, stock: Profile, pitch: float, kind: MoveType
) -> None:
    """Make the moves of a pass.

    Parameters
    ----------
    job : Job
    course : Course
    one : Pass
    stock : Profile
        Radii over z before the thread.
    pitch : float, mm
    kind : MoveType
        Of the way to the pass.
    """
    bound = Feed(technology=job.step.technology_ref, per_revolution=pitch, is_synchronised=True)
    course.rapid((one.clear, 0.0, one.start), kind)
    _feed(course, stock, (one.start, one.bottom), job.feed)
    if one.angle is not None and 0.0 < one.angle < 90.0:
        out = (one.clear - one.bottom) / tan(rad_from_deg(one.angle))
        part = min(out / abs(one.end - one.start), MOST_RETURN)
        turning = one.end + part * (one.start - one.end)
        _feed(course, stock, (turning, one.bottom), bound)
        _feed(course, stock, (one.end, one.clear), bound)
        return
    _feed(course, stock, (one.end, one.bottom), bound)
    if one.has_relief:
        course.rapid((one.clear, 0.0, one.end))
    else:
        _feed(course, stock, (one.end, one.clear), job.feed)


def _feed(course: Course, stock: Profile, end: Spot, feed: Feed) -> None:
    """Straight to z and radius, split where the tip enters or leaves the stock."""
    line = Piece(start=(course.at[2], course.at[0]), end=end)
    for part, is_contact in split(line, stock):
        kind = MoveType.CONTACT if is_contact else MoveType.NO_CONTACT
        z, x = part.end
        course.add(Move(end=(x, 0.0, z), type=kind, feed=feed))
