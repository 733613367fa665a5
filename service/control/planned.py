"""Expected results of each workingstep at an override of 1. Units mm, s, N."""

from dataclasses import dataclass, replace

import numpy as np

from simulator.motion.segments import Floats
from simulator.plant.course import NominalCourse


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedWorkingstep:
    """One workingstep as planned."""

    time: float = 0.0
    """s"""
    cutting_time: float = 0.0
    """s with chips"""
    feed: float = 0.0
    """mm/s, mean with chips"""
    force: float = 0.0
    """N, mean of the revolution that comes nearest to its bound, with the catalogue's k_c"""
    exponent: float = 0.8
    """p of force over feed"""
    diameter: float = 0.0
    """mm at which the cutting speed drives the force; 0: nothing is cut"""


def planned_steps(course: NominalCourse) -> dict[int, PlannedWorkingstep]:
    """By the workingstep's number, in the order of their beginning; 0: around them.

    What bounds the force is not known yet: the greatest counts as the nearest to its bound.
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
    """The same with the force where it comes nearest to its bound.

    Parameters
    ----------
    planned : dict of PlannedWorkingstep
    course : NominalCourse
    weight : (N,) array, optional
        What a force counts in each cell; None: all alike.
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
