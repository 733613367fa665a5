"""Ways of the tool around the stock in place of moves of NC code that are left out."""

from collections.abc import Iterable, Iterator

from simulator.machine.interpreter import Numbered
from stepnc_model.post.blocks import Circular, Linear, Rapid, ThreadingMove, ToolChange
from stepnc_model.programs.program import Stock
from stepnc_model.toolpath.path import Point

BRIDGE = 0
"""Line of moves that stand for those that are left out: what they meet is no fault."""

CLEARANCE = 5.0
"""Distance from the stock at which the tool goes around moves that are left out, mm."""


class Detour:
    """Ways around the stock in place of moves that are left out. Running state.

    Where a move begins, the tool has been in truth: it comes there along its axis, or from
    outside if it turns, so that it removes nothing but what its own body fills.
    """

    def __init__(self, stock: Stock, inserts: set[int]) -> None:
        self._inserts = inserts
        self._over = stock.high[2] + CLEARANCE
        self._beside = max(stock.high[0], stock.radius or 0.0) + CLEARANCE
        self._at: Point | None = None
        self._tool = 0

    def led_around(self, blocks: Iterable[Numbered]) -> Iterator[Numbered]:
        """Yield the blocks with detours, whose line is :data:`BRIDGE`."""
        for numbered in blocks:
            block = numbered[1]
            if type(block) is Linear:
                # The usual block of a long program.
                self._at = block.end
                yield numbered
                continue
            if isinstance(block, Rapid) and block.is_way:
                for end in self._ways(block.end):
                    yield BRIDGE, Rapid(end=end, is_way=True)
            else:
                yield numbered
            if isinstance(block, ToolChange):
                self._tool = block.number
            elif isinstance(block, (Rapid, Circular, ThreadingMove)):
                self._at = block.end

    def _ways(self, end: Point) -> Iterator[Point]:
        """Ends of the moves from the last position around the stock to another."""
        x, y, z = end
        start = self._at or end
        if self._tool in self._inserts:
            beside = max(self._beside, start[0], x)
            yield beside, y, start[2]
            yield beside, y, z
        else:
            over = max(self._over, start[2], z)
            yield start[0], start[1], over
            yield x, y, over
        yield end
