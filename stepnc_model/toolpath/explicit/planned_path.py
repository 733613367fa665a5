"""Tool path of a workingstep whose feed is planned along the path."""

from dataclasses import dataclass

from stepnc_model.programs.program import ResolvedWorkingstep
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import Dwell, Move, Point


@dataclass(frozen=True, slots=True, kw_only=True)
class MovePart:
    """Part of a move with a feed of its own."""

    end: float
    """End of the part over the length of the move, 0 to 1; 1 for the last part."""
    factor: float
    """Factor on the feed of the move's technology."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedMove:
    """Move with the planned factors on its feed."""

    move: Move
    parts: tuple[MovePart, ...] = ()
    """Parts in the order of the path; empty for a rapid move."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannedPath:
    """Tool path of a workingstep with planned feeds."""

    step: ResolvedWorkingstep
    frame: Frame
    """Frame in which the file gives the path, in the coordinates of the setup."""
    start: Point
    """Start point, in the coordinates of the setup, mm."""
    steps: tuple[PlannedMove | Dwell, ...]
    """Moves and pauses in seconds."""
