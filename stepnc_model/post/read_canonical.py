"""Reading canonical commands: ours, NIST's, and what LinuxCNC prints."""

import re
from collections.abc import Iterable, Iterator
from math import isfinite

from stepnc_model.errors import PostError
from stepnc_model.post.canonical import Argument, Canonical
from stepnc_model.post.iso_words import shown

LINE = re.compile(r"\s*(?:\d+\s+)?(?:N\S+\s+)?([A-Z][A-Z0-9_]*)\((.*)\)\s*")
NUMBER = re.compile(r"[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?")

NUMBERS = {
    "STRAIGHT_TRAVERSE": slice(0, 3),
    "STRAIGHT_FEED": slice(0, 3),
    "RIGID_TAP": slice(0, 3),
    "ARC_FEED": slice(0, 6),
    "SET_FEED_RATE": slice(-1, None),
    "SET_FEED_MODE": slice(-1, None),
    "SET_SPINDLE_SPEED": slice(-1, None),
    "SET_SPINDLE_MODE": slice(-1, None),
    "START_SPEED_FEED_SYNC": slice(0, 1),
    "DWELL": slice(0, 1),
    "ORIENT_SPINDLE": slice(-2, -1),
}
"""which arguments count: LinuxCNC adds rotary axes behind and spindle numbers before"""

NAMES = frozenset({
    "SELECT_PLANE",
    "CHANGE_TOOL",
    "SELECT_TOOL",
    "START_CHANGE",
    "START_SPINDLE_CLOCKWISE",
    "START_SPINDLE_COUNTERCLOCKWISE",
    "STOP_SPINDLE_TURNING",
    "SPINDLE_RETRACT",
    "FLOOD_ON",
    "FLOOD_OFF",
    "MIST_ON",
    "MIST_OFF",
    "COMMENT",
    "MESSAGE",
    "PROGRAM_STOP",
    "OPTIONAL_PROGRAM_STOP",
    "PROGRAM_END",
    "STOP_SPEED_FEED_SYNCH",
    "USE_LENGTH_UNITS",
    "SET_FEED_REFERENCE",
    "SET_ORIGIN_OFFSETS",
    "USE_TOOL_LENGTH_OFFSET",
    "SET_G5X_OFFSET",
    "SET_G92_OFFSET",
    "SET_XY_ROTATION",
    "ON_RESET",
    "SET_MOTION_CONTROL_MODE",
    "SET_NAIVECAM_TOLERANCE",
    "ENABLE_FEED_OVERRIDE",
    "DISABLE_FEED_OVERRIDE",
    "ENABLE_SPEED_OVERRIDE",
    "DISABLE_SPEED_OVERRIDE",
})
TEXTS = frozenset({"COMMENT", "MESSAGE"})


def read(lines: Iterable[str]) -> Iterator[Canonical]:
    """Canonical commands of a text: ours, NIST's, or what LinuxCNC prints.

    Raises
    ------
    PostError
        At a line that is no canonical command.
    """
    for number, line in enumerate(lines, 1):
        if line.strip():
            yield _parsed(line, number)


def _parsed(line: str, number: int) -> Canonical:
    """One command."""
    found = LINE.fullmatch(line)
    if found is None or (found[1] not in NUMBERS and found[1] not in NAMES):
        raise PostError(f"'{shown(line)}' is no canonical command", line=number)
    name, text = found[1], found[2]
    if name in TEXTS:
        return Canonical(name, (text.strip('"'),))
    parts = [part for part in re.split(r"[,\s]+", text) if part]
    if name not in NUMBERS:
        return Canonical(name, () if name.startswith("START_SPINDLE") else (text,))
    if not all(NUMBER.fullmatch(part) and isfinite(float(part)) for part in parts):
        raise PostError(f"{name}({shown(text)}): its arguments must be numbers", line=number)
    values: list[Argument] = [float(part) for part in parts]
    chosen = values[NUMBERS[name]] if len(values) > 1 else values
    wanted = {"ARC_FEED": 6}.get(name, 3 if NUMBERS[name] == slice(0, 3) else 1)
    if len(chosen) != wanted:
        raise PostError(f"{name} has {len(chosen)} arguments: it needs {wanted}", line=number)
    if name == "ARC_FEED":
        turns = float(chosen[4])
        if not turns or turns != int(turns):
            raise PostError(f"{name}: {turns:g} turns: whole ones are needed", line=number)
        chosen[4] = int(turns)
    return Canonical(name, tuple(chosen))
