"""Rings made into spirals: each goes over into the next one on a slant, without a stop."""

from collections.abc import Iterable, Sequence

from stepnc_model.toolpath.milling.contour import Chain, Loop, line, rotated_to
from stepnc_model.toolpath.milling.cover import Pass
from stepnc_model.toolpath.milling.strokes import is_inside

SLANT = 2.0
"""steps along the way for one step across it"""

FARTHEST = 2.0 * SLANT
"""steps; rings further apart are no neighbours"""


def spirals(rings: Iterable[Pass], loops: Sequence[Loop], *, step: float) -> tuple[Pass, ...]:
    """Neighbouring rings joined to one pass, in their order; every ring is still run whole.

    Parameters
    ----------
    rings : iterable of Pass
        Those that are not closed stay passes of their own.
    loops : sequence of Loop
        Boundary of where the cutter's centre may be.
    step : float, mm
        Between neighbouring rings.
    """
    found: list[list[Pass]] = []
    for ring in rings:
        following = _following(found[-1][-1], ring, loops, step) if found else None
        if following is None:
            found.append([ring])
        else:
            found[-1].append(following)
    return tuple(_joined(run) for run in found)


def _following(last: Pass, ring: Pass, loops: Sequence[Loop], step: float) -> Pass | None:
    """The ring from where the slant from the last one meets it; None where there is no way."""
    if not (last.is_closed and ring.is_closed):
        return None
    ahead = last.end + SLANT * step * last.chain[-1].along(1.0)
    turned = Pass(rotated_to(ring.chain, ahead), is_closed=True)
    is_near = 0.0 < abs(turned.start - last.end) <= FARTHEST * step
    return turned if is_near and is_inside(last.end, turned.start, loops) else None


def _joined(run: Sequence[Pass]) -> Pass:
    """A run of rings with the slants between them."""
    if len(run) == 1:
        return run[0]
    chain: Chain = run[0].chain
    for ring in run[1:]:
        chain = (*chain, line(chain[-1].end, ring.start), *ring.chain)
    return Pass(chain, is_closed=False)
