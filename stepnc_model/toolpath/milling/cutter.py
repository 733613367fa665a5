"""The outline of a rotating tool: how far it reaches at each height above its tip, mm."""

from dataclasses import dataclass
from math import sqrt, tan

from stepnc_model.entities.tools import MillingCuttingTool
from stepnc_model.toolpath.job import Job
from stepnc_model.units import rad_from_deg

RUN_OUT = 2.0
"""mm beyond an open side where no overcut length is given"""

LONGEST = 1000.0
"""mm of overcut; more is a slip"""

STEEPEST_DEG = 80.0
"""degrees between the side of a tapered tool and its axis"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cutter:
    """Flat, ball, bull-nose or tapered end mill."""

    radius: float
    """mm, where it is widest at the end: the nominal one"""
    corner: float = 0.0
    """mm, radius of the corner; the radius itself for a ball"""
    taper: float = 0.0
    """tangent of the angle of the side"""

    def reach(self, height: float) -> float:
        """Radius at a height above the tip."""
        if height < self.corner:
            below = self.corner - height
            return self.radius - self.corner + sqrt(self.corner**2 - below**2)
        return self.radius + (height - self.corner) * self.taper


def cutter_of(job: Job) -> Cutter:
    """Cutter of a milling workingstep.

    Raises
    ------
    PathError
        When the tool has no diameter, or corners larger than itself.
    """
    tool = job.tool
    radius, corner = 0.5 * tool.diameter, tool.corner_radius or 0.0
    if radius <= 0.0:
        raise job.fault("is no rotating tool: nothing can be milled with it", job.step.tool_ref)
    if corner > radius * (1.0 + 1e-9):
        raise job.fault(
            f"corner radius {corner:g} mm on a tool of {tool.diameter:g} mm: "
            "it is at most half the diameter",
            job.step.tool_ref,
        )
    return Cutter(radius=radius, corner=corner, taper=_taper(job))


def run_out(job: Job) -> float:
    """How far the rim of the tool goes beyond an open side: the overcut length, if given.

    Raises
    ------
    PathError
        When it is negative.
    """
    overcut = getattr(job.step.operation, "overcut_length", None)
    if overcut is not None and not 0.0 <= overcut < LONGEST:
        raise job.fault(
            f"{overcut:g} mm: it must be at least 0, below {LONGEST:g} mm",
            job.step.operation_ref,
            "overcut_length",
        )
    return RUN_OUT if overcut is None else float(overcut)


def _taper(job: Job) -> float:
    """Tangent of the side's angle to the axis; most tapered end mills of files have none."""
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, MillingCuttingTool):
        return 0.0
    angle = getattr(job.program.get(tool.its_tool_body), "taper_angle", None)
    if not angle:
        return 0.0
    if not 0.0 < angle < STEEPEST_DEG:
        raise job.fault(
            f"taper of {angle:g}°: it must lie between 0° and {STEEPEST_DEG:g}°",
            job.step.tool_ref,
        )
    return tan(rad_from_deg(angle))
