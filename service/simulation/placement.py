"""Place of a raw part beside the cutting moves of NC code: whether units and zero may be right.

A stock that no tool meets is refused, because nothing could be told of its cuts. One that fits
only when it is taken in the other unit is told: it may be a large part with a small pocket.
"""

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from service.inputs.numbers import stock_in
from service.requests.program_facts import RawPart
from service.simulation.code_simulation import with_called_tools
from simulator.motion.segments import Bools, Floats
from simulator.removal.cutter import Cutter
from simulator.tool_files.read import ToolLibrary
from stepnc_model.errors import Finding, Severity, StepNcError
from stepnc_model.nc.moves import MoveFlag, MoveKind, NcMoves
from stepnc_model.nc.program import NcProgram
from stepnc_model.post.blocks import MachineType
from stepnc_model.units import MM_PER_INCH

ELSEWHERE = MoveFlag.MACHINE | MoveFlag.TRANSFORMED | MoveFlag.ROTARY
"""Flags of moves whose coordinates are not those of the stock."""

NEAR_INCH = 2.0
"""Factor about 25.4 within which a ratio of sizes looks like that of inch and millimetre."""


def frame_of_stock(program: NcProgram) -> str:
    """Return the frame of the first cut, in which the stock stands."""
    return program.moves.frames[_frame(program.moves)]


def is_in_frame(moves: NcMoves) -> Bools:
    """True if moves are in the frame of the first cut, in which the stock stands, (N,)."""
    found: Bools = (moves.frame == _frame(moves)) & ((moves.flags & int(ELSEWHERE)) == 0)
    return found


def _frame(moves: NcMoves) -> int:
    fed = np.flatnonzero(moves.is_advisable)
    return int(moves.frame[fed[0]]) if len(fed) else 0


def placed(program: NcProgram, stock: RawPart, library: ToolLibrary) -> Iterator[Finding]:
    """Compare a stock with the cutting moves of a milling program.

    Raises
    ------
    StepNcError
        When no tool ever meets the stock, with both boxes.
    """
    # What a file holds, its run on the virtual machine compares.
    if not isinstance(stock, str) or not stock or program.machine is not MachineType.MILL:
        return
    moves = with_called_tools(program, library).moves
    is_fed = np.isin(moves.kind, (MoveKind.LINE, MoveKind.ARC)) & moves.is_known
    rows = is_fed & is_in_frame(moves)
    if not rows.any() or bool((is_fed & ~rows).any()):
        return
    points = np.concatenate((moves.start[rows], moves.end[rows]))
    low, high = points.min(axis=0), points.max(axis=0)
    bounds = stock_in(stock)
    box = np.array(bounds.low), np.array(bounds.high)
    radius = 0.5 * max((_diameter(tool.shape) for tool in library.tools), default=0.0)
    # Arcs bulge beyond their ends by no more than their own size.
    around = radius + float(np.max(high[:2] - low[:2])) * bool((moves.turn[rows] != 0.0).any())
    reach = np.array([around, around, 0.0])
    factor = _other_unit(box, (low, high), is_inch=program.unit > 1.0)
    if (box[0] > high + reach).any() or (box[1] < low - reach).any():
        raise StepNcError(
            f"no tool meets the stock: it reaches from {_point(box[0])} to {_point(box[1])} "
            f"mm, the cutting moves from {_point(low)} to {_point(high)} mm; is its zero that "
            f"of {frame_of_stock(program)}{_unit_question(factor)}?"
        )
    if factor != 1.0:
        yield Finding(
            severity=Severity.WARNING,
            message=f"the stock of {_point(box[1] - box[0])} mm and the cutting moves, which "
            f"go over {_point(high - low)} mm, differ as inches and mm do"
            f"{_unit_question(factor)}?",
        )


def in_guessed_stock(faults: Iterable[Finding]) -> Iterator[Finding]:
    """Yield warnings in place of faults of a run in a guessed stock, which may be too large."""
    for each in faults:
        text = f"{each.message} (in the guessed stock, which may be too large)"
        yield replace(each, severity=Severity.WARNING, message=text)


def _diameter(shape: object) -> float:
    return shape.diameter if isinstance(shape, Cutter) else 0.0


def _other_unit(
    box: tuple[Floats, Floats], cuts: tuple[Floats, Floats], *, is_inch: bool
) -> float:
    """Factor by which a stock would fit the cuts in X and Y; 1 if it does as it is.

    A stock that is far larger than the cuts tells nothing where the program is in mm.
    """
    size, way = (box[1] - box[0])[:2], (cuts[1] - cuts[0])[:2]
    if (size <= 0.0).any() or (way <= 0.0).any():
        return 1.0
    ratio = way / size
    for factor in (MM_PER_INCH, 1.0 / MM_PER_INCH) if is_inch else (MM_PER_INCH,):
        if ((ratio > factor / NEAR_INCH) & (ratio < factor * NEAR_INCH)).all():
            return factor
    return 1.0


def _unit_question(factor: float) -> str:
    """Question after the unit of a stock."""
    if factor == 1.0:
        return ""
    if factor > 1.0:
        return "; are its numbers inches, which --stock takes in mm"
    return "; is one of them 25.4 times too large, the program in inches and its stock in mm"


def _point(values: Floats) -> str:
    return ", ".join(f"{value:.4g}" for value in values.tolist())
