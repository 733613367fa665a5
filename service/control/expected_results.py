"""Expected results of each workingstep at an override of 1. Units mm, s, N."""

from dataclasses import dataclass, replace

import numpy as np

from simulator.motion.segments import Floats
from simulator.plant.course import NominalCourse


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedWorkingstep:
    """Expected time, feed and force of a workingstep."""

    time: float = 0.0
    """Duration, in s."""
    cutting_time: float = 0.0
    """Time with chips, in s."""
    feed: float = 0.0
    """Mean feed while cutting, in mm/s."""
    force: float = 0.0
    """Mean force, with the catalogue's k_c, of the revolution closest to its bound, in N."""
    exponent: float = 0.8
    """Exponent p of the force as a function of the feed."""
    diameter: float = 0.0
    """Diameter at which the cutting speed drives the force, in mm; 0: nothing is cut."""


def planned_steps(course: NominalCourse) -> dict[int, PlannedWorkingstep]:
    """Return expected results by workingstep number, in order of execution; 0: outside them.

    Force bounds are not known yet, so the largest force counts as the closest to its bound.
    """
    widths = np.diff(course.until, prepend=0.0)
    cuts = course.can_override & (course.force > 0.0)
    numbers, first = np.unique(course.workingstep, return_index=True)
    found = {}
    for number in numbers[np.argsort(first)].tolist():
        rows = course.workingstep == number
        planned = PlannedWorkingstep(time=float(widths[rows].sum()))
        chips = np.flatnonzero(rows & cuts)
        if len(chips):
            seconds = float(widths[chips].sum())
            planned = PlannedWorkingstep(
                time=planned.time,
                cutting_time=seconds,
                feed=float(widths[chips] @ course.feed[chips]) / seconds,
                force=float(course.force[chips].max()),
                exponent=float(np.median(course.exponent[chips])),
                diameter=float(np.median(course.diameter[chips])),
            )
        found[number] = planned
    return found


def with_hardest(
    planned: dict[int, PlannedWorkingstep], course: NominalCourse, weight: Floats | None
) -> dict[int, PlannedWorkingstep]:
    """Return the expected results with the force at the point closest to its bound.

    Parameters
    ----------
    planned : dict of PlannedWorkingstep
    weight : (N,) array, optional
        Weight of the force in each cell; None: equal weights.
    """
    if weight is None:
        return planned
    counted = np.where(course.can_override, course.force * weight, 0.0)
    found = {}
    for number, each in planned.items():
        rows = np.flatnonzero(course.workingstep == number)
        hardest = rows[counted[rows].argmax()]
        found[number] = (
            replace(each, force=float(course.force[hardest])) if each.force else each
        )
    return found
