"""What drilling cycles do, as single blocks: for controls that lack one, and for readers.

Motion after LinuxCNC, "G-Code reference", G73 and G81 to G86; controls differ in the distance
that they keep above the last depth, which is an argument here.
"""

from collections.abc import Iterator
from dataclasses import replace

from stepnc_model.errors import PostError
from stepnc_model.post.blocks import (
    Block,
    DrillingCycle,
    Linear,
    Pause,
    Rapid,
    SpindleOff,
    SpindleOn,
    SurfaceSpeed,
)
from stepnc_model.toolpath.path import CycleKind

MOST_PECKS = 10_000

LEAST = 1e-9
"""mm; a peck that leaves less has reached the bottom"""


def expanded(
    cycle: DrillingCycle, spindle: SpindleOn | SurfaceSpeed | None = None
) -> DrillingCycle:
    """The cycle with its expansion.

    Parameters
    ----------
    cycle : DrillingCycle
    spindle : SpindleOn or SurfaceSpeed, optional
        What turns again after a cycle that stops the spindle.
    """
    return replace(cycle, expansion=tuple(_expansion(cycle, spindle)))


def _expansion(
    cycle: DrillingCycle, spindle: SpindleOn | SurfaceSpeed | None
) -> Iterator[Block]:
    bottom, top = (*cycle.at, cycle.bottom_z), (*cycle.at, cycle.retract_z)
    if cycle.kind in {CycleKind.PECK, CycleKind.CHIP_BREAK} and cycle.step_depth > 0.0:
        yield from _pecks(cycle)
    else:
        yield Linear(end=bottom, rate=cycle.rate)
    if cycle.dwell:
        yield Pause(seconds=cycle.dwell)
    if cycle.kind is CycleKind.BORE:
        yield Linear(end=top, rate=cycle.rate)
        return
    if cycle.kind is CycleKind.BORE_STOP:
        yield SpindleOff()
    yield Rapid(end=top)
    if cycle.kind is CycleKind.BORE_STOP and spindle is not None:
        yield spindle


def _pecks(cycle: DrillingCycle) -> Iterator[Block]:
    """Down in steps; between them a full or a short retract."""
    x, y = cycle.at
    count = (cycle.retract_z - cycle.bottom_z) / cycle.step_depth
    if count > MOST_PECKS:
        raise PostError(f"a drilling cycle of {count:.4g} pecks: {MOST_PECKS} at most")
    depth = cycle.retract_z - cycle.step_depth
    while depth > cycle.bottom_z + LEAST:
        yield Linear(end=(x, y, depth), rate=cycle.rate)
        if cycle.kind is CycleKind.PECK:
            yield Rapid(end=(x, y, cycle.retract_z))
        above = min(depth + cycle.retract_distance, cycle.retract_z)
        yield Rapid(end=(x, y, above))
        depth -= cycle.step_depth
    yield Linear(end=(x, y, cycle.bottom_z), rate=cycle.rate)
