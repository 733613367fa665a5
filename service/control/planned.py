"""What the virtual machine expects of each workingstep at an override of 1. Units mm, s, N."""

from dataclasses import dataclass

import numpy as np

from simulator.plant.course import NominalCourse


@dataclass(frozen=True, slots=True, kw_only=True)
class Planned:
    """One workingstep as planned."""

    time: float = 0.0
    """s"""
    cutting_time: float = 0.0
    """s with chips"""
    feed: float = 0.0
    """mm/s, mean with chips"""
    force: float = 0.0
    """N, greatest mean of a revolution, with the catalogue's k_c"""
    exponent: float = 0.8
    """p of force over feed"""
    diameter: float = 0.0
    """mm at which the cutting speed drives the force; 0: nothing is cut"""


def planned_steps(course: NominalCourse) -> dict[int, Planned]:
    """By the workingstep's number, in the order of their beginning; 0: around them."""
    widths = np.diff(course.until, prepend=0.0)
    cuts = course.can_override & (course.force > 0.0)
    numbers, first = np.unique(course.workingstep, return_index=True)
    found = {}
    for number in numbers[np.argsort(first)].tolist():
        rows = course.workingstep == number
        planned = Planned(time=float(widths[rows].sum()))
        chips = np.flatnonzero(rows & cuts)
        if len(chips):
            seconds = float(widths[chips].sum())
            planned = Planned(
                time=planned.time,
                cutting_time=seconds,
                feed=float(widths[chips] @ course.feed[chips]) / seconds,
                force=float(course.force[chips].max()),
                exponent=float(np.median(course.exponent[chips])),
                diameter=float(np.median(course.diameter[chips])),
            )
        found[number] = planned
    return found
