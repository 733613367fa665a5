"""Lines of a program in words: consecutive ones as a range."""

import numpy as np

from simulator.motion.segments import Ints
from simulator.spec import Machine
from stepnc_model.plurals import counted

MOST_SPANS = 6
"""Greatest number of ranges of lines that a message lists."""


def spans(lines: Ints) -> str:
    """Numbers of lines in words, consecutive ones as a range."""
    ends = np.flatnonzero(np.diff(lines) > 1)
    firsts, lasts = np.append(lines[0], lines[ends + 1]), np.append(lines[ends], lines[-1])
    spans = [
        f"{first}" if first == last else f"{first}–{last}"
        for first, last in zip(firsts.tolist(), lasts.tolist(), strict=True)
    ]
    more = (
        f" and {counted(len(spans) - MOST_SPANS, 'more range')}"
        if len(spans) > MOST_SPANS
        else ""
    )
    word = "line" if len(lines) == 1 else "lines"
    return f"{word} {', '.join(spans[:MOST_SPANS])}{more}"


def overload_bounds(machine: Machine) -> str:
    """Bounds of a machine whose excess counts as overload, in words."""
    force, drive = machine.max_cutting_force, "the spindle drive's continuous power"
    return drive if force is None else f"{drive} or the permitted force of {force:.0f} N"
