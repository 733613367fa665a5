"""Tool paths that a search has tried, and what it read and changed. Units mm, s."""

from dataclasses import dataclass, field

from optimiser.clamped import Change, StockPlace, TrialContacts
from optimiser.cut import Cut
from optimiser.hardest import Bending, PathContacts
from optimiser.plunge import PlungeCuts
from simulator.motion.segments import Bools
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.stations import StationKind
from simulator.removal.trial import PathTrial
from stepnc_model.toolpath.path import ToolPath


@dataclass(frozen=True, slots=True, kw_only=True)
class TriedPath:
    """Tool path that was tried, with its contacts, its cut and its timing."""

    path: ToolPath
    run: ToolPathRun
    """Run of the path at the programmed feeds and speeds."""
    cut: Cut
    """Cut with the engagement met along the path."""
    passes: int
    weighted: float
    """Chip-weighted volume over that of the hardest place, mm."""
    air: float
    """Share of the length that removes nothing."""
    meeting: TrialContacts
    along: PathContacts | None
    """Contacts along the passes; None when they are not known."""
    bent: Bending | None
    """Bending forces of an end mill at these contacts."""
    slope: PlungeCuts | None
    """Contacts down ramps; None when there are no ramps."""
    times: dict[tuple[float, float, float | None], Cut] = field(default_factory=dict)
    """Timed cuts by feed ratio, speed ratio and plunge feed, filled on demand."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchTrace:
    """What the search for a workingstep's setting read and changed."""

    place: StockPlace | None = None
    """Stock map that the workingstep cuts."""
    change: Change | None = None
    trial: PathTrial | None = None
    """Milling trial of the change; None when the tool is not a mill."""
    trials: tuple[PathTrial, ...] = ()
    """Trials of all paths that were tried."""
    left_out: dict[int, str] = field(default_factory=dict)
    """Features whose path could not be made, with the id of the workingstep."""


def air_share(run: ToolPathRun, met: PathContacts, is_bound: Bools) -> float:
    """Share of the time at the programmed feed in which nothing is removed."""
    row = met.stations.segment
    seconds = met.length / run.segments.speed[row]
    bound = is_bound[row]
    whole = float(seconds[bound].sum())
    is_air = bound & (met.stations.kind == StationKind.AIR)
    return float(seconds[is_air].sum()) / whole if whole > 0.0 else 0.0
