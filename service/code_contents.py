"""Check of NC code of any origin: what it says, and what was not understood."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from service.files import read_bytes
from service.reading import one_of
from stepnc_model.errors import Finding
from stepnc_model.nc.moves import MoveKind, NcMoves
from stepnc_model.nc.program import read_program
from stepnc_model.nc.rewrite import rewrite
from stepnc_model.post.dialect import SUFFIXES, Dialect

NC_SUFFIXES = frozenset({
    *(suffix for control, suffix in SUFFIXES.items() if control is not Dialect.CANONICAL),
    *{".spf", ".tap", ".cnc", ".gcode", ".eia", ".iso", ".min", ".ncc", ".gc", ".g"},
})
"""File name extensions of NC code."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoveCount:
    """Moves of one kind and tool."""

    tool: int
    """Number of the tool; -1 before the first tool call."""
    kind: str
    count: int
    length: float
    """Length of the moves whose ends are known, mm."""
    least_feed: float
    """Least feed, mm/s; NaN for rapids and where it is not known."""
    greatest_feed: float
    advisable: int
    """Number of moves whose feed may be advised."""
    splittable: int
    """Number of moves whose block may be split."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CodeContents:
    """Contents and findings of checked NC code."""

    name: str
    control: str
    hints: tuple[str, ...]
    """Pieces of the program that speak for the control; empty if it was named."""
    machine: str
    is_inch: bool
    blocks: int
    executed: int
    """Number of executed moves."""
    frames: tuple[str, ...]
    counts: tuple[MoveCount, ...]
    is_lossless: bool
    """Whether rewriting without advice gives the file byte for byte."""
    findings: tuple[Finding, ...]


def is_code(path: Path) -> bool:
    """Whether a file name is one of NC code."""
    return path.suffix.lower() in NC_SUFFIXES


def check_code(
    path: Path, *, control: str = "", name: str = "", most_repeats: int | None = None
) -> CodeContents:
    """Read NC code and execute it; return what it says.

    Parameters
    ----------
    path : Path
    control : str
        Name of its control; empty: recognised by what the code says.
    name : str
        Name of the program; empty: the name of its file.
    most_repeats : int, optional
        Blocks and moves that may be executed beyond those of the file.

    Raises
    ------
    StepNcError
        When the file cannot be read, the control is not known, or the program repeats blocks
        without end.
    """
    dialect = one_of(Dialect, control, "control") if control else None
    program = read_program(read_bytes(path), dialect=dialect, most_repeats=most_repeats)
    return CodeContents(
        name=name or path.name,
        control=program.dialect.value,
        hints=program.hints,
        machine=program.machine.value,
        is_inch=program.unit > 1.0,
        blocks=len(program.text),
        executed=len(program.moves),
        frames=program.moves.frames,
        counts=tuple(_counts(program.moves)),
        is_lossless=rewrite(program, ()).data == program.text.data,
        findings=program.findings,
    )


def _counts(moves: NcMoves) -> Iterator[MoveCount]:
    """Count the moves by tool, in the order of first use, and by kind."""
    numbers, firsts = np.unique(moves.tool, return_index=True)
    for number in numbers[np.argsort(firsts)]:
        for kind in MoveKind:
            chosen = (moves.tool == number) & (moves.kind == kind)
            if not chosen.any():
                continue
            feeds = moves.feed[chosen]
            known = feeds[~np.isnan(feeds)]
            yield MoveCount(
                tool=int(number),
                kind=kind.name.lower(),
                count=int(chosen.sum()),
                length=float(np.nansum(moves.length[chosen])),
                least_feed=float(known.min()) if len(known) else np.nan,
                greatest_feed=float(known.max()) if len(known) else np.nan,
                advisable=int(moves.is_advisable[chosen].sum()),
                splittable=int(moves.is_splittable[chosen].sum()),
            )
