"""What is watched besides the feed: warnings, broken teeth, wear, a jump in hardness.

Running state: the states of the functions that look at each revolution. Units N, s.
"""

from collections.abc import Iterator
from math import expm1, inf

from controller.breakage import Breakage, inspected
from controller.orders import Event, EventKind
from controller.signal import Revolution
from controller.threshold import Level, Watch, watched
from controller.tool_life import ToolLife, compared_anew, lived, new_tool

STEADY = 0.02
"""greatest change of the override in a revolution that counts as steady, as a share"""

_KINDS = {
    Level.SAFE: EventKind.SAFE,
    Level.WARNING: EventKind.WARNING,
    Level.OVER: EventKind.OVER,
}


class Monitor:
    """Looks at each revolution with chips. Running state."""

    def __init__(self) -> None:
        self.level = Level.SAFE
        self.is_broken = False
        self.lives: dict[str, ToolLife] = {}
        """by the tool's id"""
        self._tool = ""
        self._watch = Watch()
        self._breakage = Breakage()
        self._override = 1.0
        self._has_chips = False

    def begin(self, tool: str) -> None:
        """A workingstep begins: its cut may err otherwise than the last one's."""
        if tool != self._tool:
            self._breakage = Breakage()
        self._tool, self._watch, self._has_chips = tool, Watch(), False
        life = self.lives.get(tool)
        self.lives[tool] = new_tool() if life is None else compared_anew(life)

    def out_of_cut(self) -> None:
        """A revolution without chips."""
        self._has_chips = False

    def seen(
        self, revolution: Revolution, *, ratio: float | None, set_point: float, exponent: float
    ) -> Iterator[Event]:
        """What one more revolution with chips tells.

        Parameters
        ----------
        revolution : Revolution
        ratio : float, optional
            ln(measured / expected); None: not to be compared.
        set_point : float, N
            Infinite: none.
        exponent : float
            p of force over feed.
        """
        if not self._has_chips:
            self._watch = Watch()
        is_steady = abs(revolution.override - self._override) <= STEADY * self._override
        self._has_chips, self._override = True, revolution.override
        if set_point < inf:
            yield from self._warned(revolution, set_point, is_steady=is_steady)
        yield from self._inspected(revolution, exponent)
        if ratio is not None:
            yield from self._lived(revolution, ratio)

    def _warned(
        self, revolution: Revolution, set_point: float, *, is_steady: bool
    ) -> Iterator[Event]:
        """A change of the level."""
        self._watch = watched(self._watch, revolution, set_point=set_point, is_steady=is_steady)
        level = self._watch.level
        if level is not self.level:
            self.level = level
            text = f"{revolution.force:.4g} N, set point {set_point:.4g} N"
            yield Event(time=revolution.time, kind=_KINDS[level], text=text)

    def _inspected(self, revolution: Revolution, exponent: float) -> Iterator[Event]:
        """A tooth that has broken."""
        self._breakage = inspected(self._breakage, revolution, exponent=exponent)
        if self._breakage.broken is not None and not self.is_broken:
            self.is_broken = True
            text = f"tooth {self._breakage.broken + 1} of {revolution.teeth} takes no chip"
            yield Event(time=revolution.time, kind=EventKind.BREAKAGE, text=text)

    def _lived(self, revolution: Revolution, ratio: float) -> Iterator[Event]:
        """A sudden change of the work, or the end of a tool's life."""
        before = self.lives[self._tool]
        life = self.lives[self._tool] = lived(before, ratio)
        if len(life.changes) > len(before.changes):
            percent = 100.0 * expm1(life.changes[-1])
            text = f"force {percent:+.0f} % against what is expected: harder or deeper"
            if percent < 0.0:
                text = f"force {percent:+.0f} % against what is expected: softer or shallower"
            yield Event(time=revolution.time, kind=EventKind.HARDNESS, text=text)
        if life.is_worn_out and not before.is_worn_out:
            text = f"tool '{self._tool}': flank wear {life.flank_wear:.2f} mm by the force"
            yield Event(time=revolution.time, kind=EventKind.WEAR, text=text)
