"""A block with one slot of 10 mm along X, and logs of it."""

from math import pi

import numpy as np

from extras.verification.model.logged_part import LoggedPart, LoggedSamples
from extras.verification.model.path import ProgrammedPath, ProgrammedRun, programmed_path
from extras.verification.model.surface import ProgrammedPart, programmed_part
from simulator.motion.segments import Floats, arc, chained, lines
from simulator.removal.cutter import Cutter
from stepnc_model.programs.program import Stock

STOCK = Stock(low=(0.0, 0.0, -10.0), high=(40.0, 40.0, 0.0))
CUTTER = Cutter(diameter=10.0)
SLOT = ((-10.0, 20.0, -4.0), (25.0, 20.0, -4.0), (25.0, 50.0, -4.0))
"""The tool comes from the side, turns at a square corner, and leaves."""


def slot_path() -> ProgrammedPath:
    run = ProgrammedRun(cutter=CUTTER, tool=1, workingstep=0, segments=lines(SLOT, speed=5.0))
    return programmed_path([run])


def round_path() -> ProgrammedPath:
    """A groove along a whole circle of 10 mm about the middle."""
    circle = arc((30.0, 20.0, -4.0), (20.0, 20.0, -4.0), 2.0 * pi, speed=5.0)
    down = lines([(30.0, 20.0, 5.0), (30.0, 20.0, -4.0)], speed=5.0)
    whole = chained([down, circle])
    small = Cutter(diameter=6.0)
    run = ProgrammedRun(cutter=small, tool=1, workingstep=0, segments=whole)
    return programmed_path([run])


def part_of(path: ProgrammedPath) -> ProgrammedPart:
    return programmed_part(path, STOCK, cell=0.25)


def samples_at(points: Floats, *, interval: float = 0.01) -> LoggedSamples:
    count = len(points)
    return LoggedSamples(
        time=interval * np.arange(count, dtype=np.float64),
        position=np.asarray(points, dtype=np.float64),
        tool=np.ones(count, dtype=np.int64),
        workingstep=np.zeros(count, dtype=np.int64),
    )


def sampled(points: tuple[tuple[float, float, float], ...], step: float) -> Floats:
    """Points every step of way along a polyline, and its end."""
    corners = np.array(points)
    way = np.concatenate(([0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))))
    at = np.append(np.arange(0.0, way[-1], step), way[-1])
    return np.column_stack([np.interp(at, way, corners[:, axis]) for axis in range(3)])


def logged(part: ProgrammedPart, samples: LoggedSamples) -> LoggedPart:
    cutter = part.path.runs[0].cutter
    assert isinstance(cutter, Cutter)
    left = LoggedPart(part, STOCK, {1: cutter})
    left.add(samples)
    return left
