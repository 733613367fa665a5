"""Check of rewritten NC code: no block may be faster than its place permits.

The ends of split blocks are rounded to what the program can say, and the engagement is known
for stretches that depend on how the path is cut into blocks. So what is written is run as well,
and a block that is too fast is slowed down. Its path stays, so one run is enough.
"""

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from optimiser.along_path.caps import CutBounds
from optimiser.along_path.plan import PERMITTED
from optimiser.along_path.stretch import excess
from service.along_path.code_paths import CodeBlocks, CodePaths
from service.along_path.course import Part, stretches_of
from simulator.machine.samples import Episode
from simulator.machine.virtual import VirtualMachine
from simulator.motion.segments import ControlModel
from stepnc_model.nc.advice import BlockAdvice
from stepnc_model.nc.moves import FeedMode


def slowed(
    code: CodePaths,
    *,
    bounds: Callable[[Part], CutBounds | None],
    control: ControlModel,
    watch: Callable[[Episode, VirtualMachine], None],
) -> Iterator[BlockAdvice]:
    """Yield lower feeds for the blocks of a program that are too fast.

    Parameters
    ----------
    code : CodePaths
        Program as it is written.
    bounds : callable
        Bounds of a part of the program; None if its feed may not be chosen.
    control : ControlModel
    watch : callable
        Receives all episodes of the run.

    Raises
    ------
    SimulationError
        When the machine cannot run the program.
    """
    for line, ratio in _ratios(code, bounds, control, watch).items():
        block = code.block_at(line)
        yield BlockAdvice(block=block, ends=(1.0,), feeds=(_feed(code, block) / ratio,))


def _ratios(
    code: CodePaths,
    bounds: Callable[[Part], CutBounds | None],
    control: ControlModel,
    watch: Callable[[Episode, VirtualMachine], None],
) -> Mapping[int, float]:
    """Feed over the permitted feed of lines that are too fast."""
    run = code.prepared(0.0)
    found: dict[int, float] = {}
    for stretch in stretches_of(
        run,
        None,
        control=control,
        bounds=bounds,
        log=CodeBlocks(run.blocks, code),
        watch=watch,
    ):
        ratio = excess(stretch)
        for row in np.flatnonzero(ratio > PERMITTED).tolist():
            line = int(stretch.segments.block[row])
            found[line] = max(float(ratio[row]), found.get(line, 1.0))
    return found


def _feed(code: CodePaths, block: int) -> float:
    """Least feed at which a block is executed, mm/s; per revolution at its greatest speed."""
    moves, rows = code.program.moves, code.rows_of(block)
    if moves.settings[int(moves.rows["setting"][rows[0]])].mode is FeedMode.PER_REVOLUTION:
        return float(moves.word[rows].min()) * moves.fastest(rows)
    return float(moves.feed[rows].min())
