"""Moves of NC code for which its tools are not made.

A drill that moves sideways in material bends, and no limit says how fast it may: such a move
keeps its feed. So does a reamer that takes off more than its allowance. A mill whose edges do
not reach its axis leaves a core when it goes straight down into solid material.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from optimiser.along_path.change_bounds import is_straight_down
from optimiser.along_path.stretch import PathStretch
from optimiser.cuts.plunge_engagement import is_core
from service.simulation.line_spans import spans
from simulator.library import reaming_allowances
from simulator.motion.segments import Bools, Ints, Segments
from simulator.removal.cutter import ENDS, Cutter, Insert
from simulator.removal.stations import StationKind
from simulator.spec import ToolKind
from simulator.tools.tool_table import TableTool, reaches_centre
from stepnc_model.errors import Finding, Severity

Meets = Callable[[Segments, Ints, Cutter | Insert, float], Ints]
"""Function that gives the blocks of some segments that meet the raw part."""

SIDEWAYS = 0.1
"""Sine of the angle between a move and the axis from which it counts as sideways: about 6°,
more than the rounding of coordinates gives."""

RESOLVED = 0.05
"""Length by which the removed width of a hole may be found too great, mm."""


class MisuseKind(StrEnum):
    """Kinds of moves that a tool is not made for."""

    SIDEWAYS = "sideways"
    REAMED = "reamed"
    PLUNGED = "plunged"


@dataclass(slots=True, kw_only=True)
class MisuseWatch:
    """Watch over the tools of a program. Running state: it notes what they are not made for."""

    tools: Mapping[int, TableTool]
    """Tools by their numbers."""
    allows_plunge: bool = False
    """Whether mills that do not cut over centre may plunge into solid material."""
    lines: set[int] = field(default_factory=set)
    """Lines whose feeds stay."""
    misuses: dict[tuple[int, MisuseKind], dict[int, float]] = field(default_factory=dict)
    """Lines with the greatest width that was removed, mm, by tool and kind."""

    def of_written(self) -> "MisuseWatch":
        """Watch over code that was written from this program."""
        return replace(self, lines=set(), misuses={})

    def watched(self, stretch: PathStretch, number: int) -> PathStretch:
        """Note what a tool is not made for; return the stretch without choice of its feed."""
        tool = self.tools.get(number)
        if tool is None or not isinstance(tool.shape, Cutter):
            return stretch
        if tool.kind in ENDS:
            kept = self._note(tool, stretch, MisuseKind.SIDEWAYS, _sideways_rows(stretch))
            if tool.kind is ToolKind.REAMER:
                rows = _reamed_rows(stretch, _greatest_allowance(tool.shape.diameter))
                kept |= self._note(tool, stretch, MisuseKind.REAMED, rows)
            self.lines |= kept
        elif reaches_centre(tool) is not True:
            rows = _plunged_rows(stretch, tool.shape.diameter)
            self._note(tool, stretch, MisuseKind.PLUNGED, rows)
        return self.as_kept(stretch, stretch.segments.block)

    def watched_tap(self, stretch: PathStretch, number: int, meets: Meets) -> None:
        """Note where a tap, whose cut no map represents, moves sideways in the raw part."""
        tool = self.tools.get(number)
        if tool is None or tool.kind is not ToolKind.TAP:
            return
        segments = stretch.segments
        is_across = _is_sideways(segments) & ~segments.is_rapid & (segments.length > 0.0)
        rows = np.flatnonzero(is_across)
        if not len(rows):
            return
        for block in meets(segments, rows, tool.shape, 0.0).tolist():
            known = self.misuses.setdefault((number, MisuseKind.SIDEWAYS), {})
            known[block] = 0.0

    def as_kept(self, stretch: PathStretch, lines: Ints) -> PathStretch:
        """Return a stretch in which no feed of a kept line may be chosen, lines being (N,)."""
        if not self.lines:
            return stretch
        is_kept = np.isin(lines, list(self.lines)) & ~stretch.segments.is_rapid
        known = stretch.is_kept
        return replace(
            stretch,
            is_free=stretch.is_free & ~is_kept,
            is_kept=is_kept if known is None else known | is_kept,
        )

    def _note(
        self, tool: TableTool, stretch: PathStretch, kind: MisuseKind, rows: Ints
    ) -> set[int]:
        """Note the lines of some stations; return them."""
        met = stretch.met
        blocks = stretch.segments.block[met.segment[rows]].tolist()
        if blocks:
            known = self.misuses.setdefault((tool.number, kind), {})
            for block, width in zip(
                blocks, (2.0 * met.axial_depth[rows]).tolist(), strict=True
            ):
                known[block] = max(width, known.get(block, 0.0))
        return set(blocks)

    def findings(self) -> Iterator[Finding]:
        """Yield what was noted, by tool and kind."""
        for (number, kind), lines in self.misuses.items():
            tool = self.tools[number]
            where = spans(np.array(sorted(lines)))
            severity, text = Severity.WARNING, ""
            if kind is MisuseKind.SIDEWAYS:
                text = (
                    f"moves sideways in material ({where}): a {tool.kind.replace('_', ' ')} "
                    "cuts along its axis alone; its feed is kept there"
                )
            elif kind is MisuseKind.REAMED and isinstance(tool.shape, Cutter):
                most = _greatest_allowance(tool.shape.diameter)
                severity = Severity.ERROR
                text = (
                    f"takes {max(lines.values()):.3g} mm off the diameter ({where}), more than "
                    f"its allowance of {most:.3g} mm: its feed is kept there; drill the hole "
                    "before, or to a greater diameter"
                )
            elif reaches_centre(tool) is None:
                text = (
                    f"plunges straight into solid material ({where}); it is unknown whether "
                    "it cuts over centre: use a ramp or a helix, or set centre_cutting in the "
                    "tool table"
                )
            else:
                severity = Severity.WARNING if self.allows_plunge else Severity.ERROR
                text = (
                    f"does not cut over centre, but plunges into solid material ({where}): use "
                    "a ramp or a helix"
                )
            yield Finding(
                severity=severity, message=f"tool '{tool.id}' {text}", line=min(lines)
            )


def _greatest_allowance(diameter: float) -> float:
    """Greatest allowance of a reamer on the diameter, mm."""
    return next(each for each in reaming_allowances() if diameter <= each.up_to).greatest


def _cuts(stretch: PathStretch) -> Bools:
    """True if material is removed at a feed at a station, (M,)."""
    met = stretch.met
    cuts: Bools = (met.peak_section > 0.0) & ~stretch.segments.is_rapid[met.segment]
    return cuts


def _sideways_rows(stretch: PathStretch) -> Ints:
    """Stations at which a tool moves across its axis in material."""
    is_across = _is_sideways(stretch.segments)
    return np.flatnonzero(_cuts(stretch) & is_across[stretch.met.segment])


def _is_sideways(segments: Segments) -> Bools:
    """True if segments go across the axis, (N,)."""
    length = np.where(segments.length > 0.0, segments.length, 1.0)
    along = np.abs(segments.end[:, 2] - segments.start[:, 2]) / length
    across: Bools = along**2 < 1.0 - SIDEWAYS**2
    return across


def _reamed_rows(stretch: PathStretch, most: float) -> Ints:
    """Stations at which more than a width is taken off the diameter of a hole."""
    met = stretch.met
    is_hole = _cuts(stretch) & (met.kind == StationKind.DRILLING)
    return np.flatnonzero(is_hole & (2.0 * met.axial_depth > most + RESOLVED))


def _plunged_rows(stretch: PathStretch, diameter: float) -> Ints:
    """Stations at which a mill goes straight down into material under its axis."""
    met = stretch.met
    is_down = is_straight_down(stretch)[met.segment] & (met.kind == StationKind.DRILLING)
    return np.flatnonzero(is_down & _cuts(stretch) & is_core(met, diameter))
