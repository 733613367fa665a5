"""Paths that were tried for a workingstep, and what they met."""

from dataclasses import dataclass, field

from optimiser.clamped import Change, Meeting, Place
from optimiser.cut import Cut
from optimiser.hardest import Bending, Met
from optimiser.plunge import Slope
from simulator.motion.tool_path import Run
from simulator.removal.trial import Trial
from stepnc_model.toolpath.path import ToolPath


@dataclass(frozen=True, slots=True, kw_only=True)
class Seen:
    """A path that was tried, and what it met."""

    path: ToolPath
    run: Run
    """as programmed"""
    cut: Cut
    """with the engagement as met"""
    passes: int
    weighted: float
    """weighted volume over that of the hardest place, mm"""
    air: float
    """share of the length that removes nothing"""
    meeting: Meeting
    along: Met | None
    """what was met along the passes; None: nothing is known of it"""
    bent: Bending | None
    """by that"""
    slope: Slope | None
    """what was met down ramps; None: nothing"""
    times: dict[tuple[float, float, float | None], Cut] = field(default_factory=dict)
    """the cut as timed already, by the ratios of feed and speed and the plunge feed; filled
    when asked for"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Trace:
    """What a workingstep looked at and changed."""

    place: Place | None = None
    """which stock"""
    change: Change | None = None
    trial: Trial | None = None
    """that of the change; None: not of a mill"""
    trials: tuple[Trial, ...] = ()
    """of all paths that were tried"""
    left_out: dict[int, str] = field(default_factory=dict)
    """features whose path could not be made, with the workingstep"""
