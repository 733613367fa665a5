"""What is cut along from outside: steps, outside profiles, bosses (ISO 14649-10)."""

from stepnc_model.entities.entity import Entity
from stepnc_model.entities.features import (
    Boss,
    GeneralOutsideProfile,
    ShapeProfile,
    Step,
)
from stepnc_model.entities.profiles import ClosedProfile
from stepnc_model.part21.values import Ref
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.job import Job
from stepnc_model.toolpath.milling.area import Flank, leaning, upright
from stepnc_model.toolpath.milling.contour import clockwise, reversed_chain
from stepnc_model.toolpath.milling.outline import (
    closed_outline,
    course,
    open_outline,
    require_simple,
    slope_of,
)


def step_flank(job: Job, ref: Ref[Entity], feature: Step, frame: Frame, bottom: float) -> Flank:
    """From the edge to the side of the stock on the right of its sense."""
    edge = course(job, feature.open_boundary, frame)
    chain = reversed_chain(edge)
    width = None
    if job.stock is not None:
        out = 1j * chain[0].along(0.0)
        sides = [
            complex(x, y)
            for x in (job.stock.low[0], job.stock.high[0])
            for y in (job.stock.low[1], job.stock.high[1])
        ]
        width = max((out.conjugate() * (side - edge[0].start)).real for side in sides)
    return Flank(
        ref=ref,
        chain=chain,
        is_closed=False,
        inset=upright,
        top=frame.origin[2],
        bottom=bottom,
        width=width if width and width > 0.0 else None,
    )


def outside_flank(
    job: Job,
    ref: Ref[Entity],
    feature: GeneralOutsideProfile | Boss | ShapeProfile,
    frame: Frame,
    bottom: float,
) -> Flank:
    """Outline with the part inside; an open one with the part on its left."""
    boundary = next(
        getattr(feature, name)
        for name in (
            "feature_boundary",
            "its_boundary",
            "profile_boundary",
            "closed_boundary",
            "open_boundary",
        )
        if hasattr(feature, name)
    )
    is_closed = isinstance(job.program.get(boundary), ClosedProfile)
    top = frame.origin[2]
    if is_closed:
        outline = closed_outline(job, boundary, frame)
        require_simple(job, outline, ref)
        chain = clockwise(outline)
    else:
        chain = reversed_chain(open_outline(job, boundary, frame))
    slope = slope_of(job, getattr(feature, "slope", None), ref)
    return Flank(
        ref=ref,
        chain=chain,
        is_closed=is_closed,
        inset=leaning(depth=top - bottom, slope_deg=slope),
        top=top,
        bottom=bottom,
    )
