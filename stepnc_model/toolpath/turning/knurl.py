"""Knurling: the wheel is pressed in at the front and fed along once."""

from stepnc_model.entities.turning_features import Knurl
from stepnc_model.toolpath.course import Course
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.path import MoveType
from stepnc_model.toolpath.turning.outline import Outline
from stepnc_model.toolpath.turning.setting import clearance_of
from stepnc_model.toolpath.turning.stock import Bar
from stepnc_model.toolpath.turning.sweep import size_of

EVEN = 1e-6
"""mm between the radii of a cylinder's ends"""


def knurl(job: Job, course: Course, bar: Bar, outline: Outline) -> None:
    """Press in and feed along.

    Raises
    ------
    PathError
        When the feature is no knurl, tells no depth, or is no cylinder.
    """
    ref = job.step.features[0]
    feature = job.program.get(ref)
    if not isinstance(feature, Knurl) or feature.tooth_depth is None:
        raise job.fault("a knurl needs a feature with a tooth depth", ref, "tooth_depth")
    depth = size_of(job, feature.tooth_depth)
    least, radius = outline.radii
    if radius - least > EVEN:
        raise job.fault("only a cylinder can be knurled", ref, "base_feature")
    clearance = clearance_of(job)
    outside = max(radius, bar.left.top(outline.low, bar.left.high)) + clearance
    start = course.at
    course.rapid((outside, 0.0, start[2]), MoveType.APPROACH)
    course.rapid((outside, 0.0, outline.high), MoveType.APPROACH)
    course.line((radius, 0.0, outline.high), MoveType.NO_CONTACT)
    course.line((radius - depth, 0.0, outline.high), MoveType.CONTACT)
    course.line((radius - depth, 0.0, outline.low), MoveType.CONTACT)
    course.line((radius, 0.0, outline.low), MoveType.NO_CONTACT)
    course.rapid((start[0], 0.0, outline.low), MoveType.RETRACT)
    course.rapid(start, MoveType.RETRACT)
