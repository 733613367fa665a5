"""The outline of a rotating tool: how far it reaches at each height above its tip, mm."""

from dataclasses import dataclass
from math import sqrt, tan

from stepnc_model.entities.tools import MillingCuttingTool
from stepnc_model.toolpath.job import Job
from stepnc_model.units import rad_from_deg


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


def _taper(job: Job) -> float:
    """Tangent of the side's angle to the axis; most tapered end mills of files have none."""
    tool = job.program.get(job.step.tool_ref)
    if not isinstance(tool, MillingCuttingTool):
        return 0.0
    angle = getattr(job.program.get(tool.its_tool_body), "taper_angle", None)
    return tan(rad_from_deg(angle)) if angle else 0.0
