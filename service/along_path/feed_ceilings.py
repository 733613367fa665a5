"""Tools that NC code uses beyond their limits, so that their feeds may fall but not rise.

A cutting speed above the window burns the edge, and a spindle that turns against the hand of
the tool rubs with its back: no feed makes either right, and a greater one makes it worse.
"""

from collections.abc import Iterator

import numpy as np

from optimiser.along_path.tool_bounds import cutting_speed_bound
from optimiser.bounds.speed_limits import WRITTEN
from service.simulation.code_paths import CodePaths
from service.simulation.spindle_hand import turned_against
from simulator.removal.cutter import Cutter
from stepnc_model.errors import Finding, Severity
from stepnc_model.nc.neutral_blocks import FED
from stepnc_model.units import m_min_from_speed, rpm_from_rev_s


def unraised_tools(code: CodePaths) -> Iterator[tuple[int, Finding]]:
    """Tools whose feeds may not rise, by number, each with a warning."""
    yield from fast_tools(code)
    yield from turned_against(code.program, code.tools)


def fast_tools(code: CodePaths) -> Iterator[tuple[int, Finding]]:
    """Tools that turn above their greatest cutting speed, by number, each with a warning."""
    moves = code.program.moves
    is_fed = np.isin(moves.kind, list(FED))
    spindle = np.where(is_fed, np.nan_to_num(np.abs(moves.spindle)), 0.0)
    for number, tool in code.tools.items():
        rows = np.flatnonzero((moves.tool == number) & (spindle > 0.0))
        if not len(rows) or code.material is None or not isinstance(tool.shape, Cutter):
            continue
        found = cutting_speed_bound(tool, code.machine, code.material.material)
        row = int(rows[spindle[rows].argmax()])
        speed = np.pi * tool.shape.diameter * float(spindle[row])
        if found.bound is None or speed <= found.bound * (1.0 + WRITTEN):
            continue
        line = code.program.text.line(int(moves.block[row]))
        text = (
            f"tool '{tool.id}': cutting speed {m_min_from_speed(speed):.4g} m/min "
            f"({rpm_from_rev_s(float(spindle[row])):.0f} rpm on line {line}) exceeds its "
            f"greatest of {m_min_from_speed(found.bound):.4g} m/min ({found.origin}): none of "
            "its feeds is raised; program a lower spindle speed"
        )
        yield number, Finding(severity=Severity.WARNING, message=text, line=line)
