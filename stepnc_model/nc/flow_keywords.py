"""Places of the keywords that steer conditions and loops of ISO code."""

import re

import numpy as np

from stepnc_model.nc.text import NcText

KEYWORDS = re.compile(
    rb"^[ \t]*(?:N[0-9]+[ \t]*)?o[ \t]*([0-9]+|<[^>\r\n]*>)[ \t]*"
    rb"(if|elseif|else|endif|while|endwhile|do|repeat|endrepeat)\b",
    re.M | re.I,
)
FANUC_KEYWORDS = re.compile(
    rb"^[ \t]*(?:N[0-9]+[ \t]*)?(?:WHILE[^\r\n;(]*?\b(DO)|(END))[ \t]*([0-9]+)", re.M | re.I
)


def keyword_places(text: NcText) -> dict[str, list[tuple[int, str]]]:
    """Blocks and keywords of each O word that steers conditions and loops."""
    found: dict[str, list[tuple[int, str]]] = {}
    for each in KEYWORDS.finditer(text.data):
        block = int(np.searchsorted(text.starts, each.start(1), side="right")) - 1
        name = each[1].decode("latin-1").strip().upper()
        found.setdefault(name, []).append((block, each[2].decode("latin-1").lower()))
    return found


def loop_places(text: NcText) -> dict[int, int]:
    """Block of END for the block of each WHILE of Fanuc."""
    found: dict[int, int] = {}
    begun: list[tuple[bytes, int]] = []
    for each in FANUC_KEYWORDS.finditer(text.data):
        block = int(np.searchsorted(text.starts, each.start(3), side="right")) - 1
        if each[1] is not None:
            begun.append((each[3], block))
        elif begun and begun[-1][0] == each[3]:
            found[begun.pop()[1]] = block
    return found
