"""Passes of a nose: scan lines down to a surface, and passes along it.

Steps 3 and 4 of Shin et al. (2016), section 3.2.2. A scan line is cut where the centre of the
nose may be at its level and where it touches the stock; where a line starts behind something
that stays, the tool comes down along it.
"""

from collections.abc import Sequence

from stepnc_model.toolpath.turning.onward import onward, step_over
from stepnc_model.toolpath.turning.piece import Piece, Spot
from stepnc_model.toolpath.turning.profile import NARROW, Profile
from stepnc_model.toolpath.turning.setting import Setting
from stepnc_model.toolpath.turning.walk import TOUCH, Walk, split

LEAST_CUT = 1e-3
"""mm of contact along a pass that is worth one"""


def scan(walk: Walk, centres: Profile, level: float, setting: Setting, *, towards: int) -> None:
    """Cut everything at one level.

    Parameters
    ----------
    walk : Walk
    centres : Profile
        Where the centre may be at the lowest.
    level : float, mm
        v of the centre.
    setting : Setting
    towards : int
        −1 to the chuck or to the axis, +1 back.
    """
    spans = centres.below(level + TOUCH)
    for low, high in spans if towards > 0 else reversed(spans):
        touched = [
            (max(low, a), min(high, b))
            for a, b in walk.rim.above(level + TOUCH)
            if min(high, b) - max(low, a) > LEAST_CUT
        ]
        if touched:
            first, last = touched[0][0], touched[-1][1]
            start, end = (last, first) if towards < 0 else (first, last)
            bound = high if towards < 0 else low
            _line(walk, centres, (start, level), end, bound=bound, setting=setting)


def _line(
    walk: Walk, centres: Profile, start: Spot, end: float, *, bound: float, setting: Setting
) -> None:
    """One scan line, with the way to it."""
    u, level = start
    towards = 1.0 if end > u else -1.0
    before = u - towards * setting.overcut
    is_open = (bound - before) * towards <= 0.0
    if is_open or abs(bound - u) > LEAST_CUT:
        u = before if is_open else bound
        lead: Sequence[Piece] = ()
    else:
        u = bound
        lead = _descent(walk, centres, u, towards)
    start = lead[0].start if lead else (u, level)
    if not setting.is_to_and_fro:
        onward(walk, setting.link, start)
    elif lead:
        walk.travel(start)
    else:
        u, level = step_over(walk, setting.link, start, towards)
    foot = lead[-1].end if lead else (u, level)
    if lead and abs(foot[1] - level) > TOUCH:
        lead = [*lead, Piece(start=foot, end=(foot[0], level))]
        foot = (foot[0], level)
    if setting.is_to_and_fro:
        walk.step(lead)
        lead = ()
    walk.feed([*lead, Piece(start=foot, end=(end, level))])


def _descent(walk: Walk, centres: Profile, u: float, towards: float) -> list[Piece]:
    """The way down along what stands before a line, from where the tool is free."""
    side = centres.within(u, centres.high) if towards < 0 else centres.within(centres.low, u)
    pieces = list(side.chain())
    if towards > 0.0:
        pieces = [piece.reversed() for piece in reversed(pieces)]
    way: list[Piece] = []
    for piece in pieces:
        for part, is_contact in split(piece, walk.rim):
            if not is_contact and not part.is_upright:
                return _backwards(way)
            way.append(part)
    return _backwards(way)


def _backwards(pieces: Sequence[Piece]) -> list[Piece]:
    return [piece.reversed() for piece in reversed(pieces)]


def touching(walk: Walk, chain: Sequence[Piece], overcut: float) -> list[Piece]:
    """A chain from before its first cut to the end of its last one; nothing if it has none."""
    parts = [found for piece in chain for found in split(piece, walk.rim)]
    contacts = [i for i, (part, is_contact) in enumerate(parts) if is_contact and _is_cut(part)]
    if not contacts:
        return []
    inner = [part for part, _ in parts[contacts[0] : contacts[-1] + 1]]
    return [*_lead([part for part, _ in parts[: contacts[0]]], overcut), *inner]


def oriented(chain: Sequence[Piece], *, towards: int) -> list[Piece]:
    """A chain that runs towards −u, or the same back."""
    return list(chain) if towards < 0 else _backwards(chain)


def shortened(chain: Sequence[Piece], start: float) -> list[Piece]:
    """A chain towards −u without what lies behind a u."""
    found: list[Piece] = []
    for piece in chain:
        if piece.low >= start - NARROW and not piece.is_upright:
            continue
        is_cut = piece.high > start + NARROW and not piece.is_upright
        found.append(piece.part(start, piece.end[0]) if is_cut else piece)
    while found and found[0].is_upright:
        found.pop(0)
    return found


def _is_cut(part: Piece) -> bool:
    return abs(part.end[0] - part.start[0]) + abs(part.end[1] - part.start[1]) > LEAST_CUT


def _lead(before: Sequence[Piece], overcut: float) -> list[Piece]:
    """The last part of a chain that is at least as long as the overcut, in u."""
    if not before or overcut <= 0.0:
        return []
    end = before[-1].end[0]
    towards = 1.0 if end > before[0].start[0] else -1.0
    start = end - towards * overcut
    lead: list[Piece] = []
    for piece in reversed(before):
        if not piece.is_upright and piece.low + NARROW < start < piece.high - NARROW:
            return [piece.part(start, piece.end[0]), *lead]
        lead.insert(0, piece)
        if (piece.start[0] - start) * towards <= NARROW:
            break
    return lead
