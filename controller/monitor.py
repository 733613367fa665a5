"""What is watched besides the feed: warnings, broken teeth, wear, a jump in hardness.

Running state: the states of the functions that look at each revolution. Units N, s.
"""

from collections.abc import Iterator
from math import expm1, inf

from controller.breakage import Breakage, inspected
from controller.guard import Keeping
from controller.orders import Event, EventKind
from controller.preview import Expected
from controller.signal import Revolution
from controller.threshold import Level, Watch, reason, watched
from controller.tool_life import ToolLife, compared_anew, lived, new_tool

STEADY = 0.02
"""greatest change of the override in a revolution that counts as steady, as a share"""

CALM = 5.0
"""s for which the level must have been lower until it is said: a force that flickers about a
threshold must not flood who reads; what is worse is said at once"""

PAUSE = 10.0
"""s between two changes of the work that are told"""

NOTABLE = 0.1
"""change of ln F that is told; less is what the expected force errs by in corners"""

REACH = 20
"""revolutions at the floor of the override with a force above the set point, after which that
is said: more than any drive needs to slow down"""

ABOVE = 1.05
"""times the set point, and times the floor: what is nearer is at it"""

_KINDS = {
    Level.SAFE: EventKind.SAFE,
    Level.WARNING: EventKind.WARNING,
    Level.OVER: EventKind.OVER,
}
_RANKS = {level: rank for rank, level in enumerate(_KINDS)}


class Monitor:
    """Looks at each revolution with chips. Running state."""

    def __init__(self) -> None:
        self.level = Level.SAFE
        """that was told last"""
        self.is_broken = False
        self.lives: dict[str, ToolLife] = {}
        """by the tool's id"""
        self._tool = ""
        self._watch = Watch()
        self._breakage = Breakage()
        self._override = 1.0
        self._has_chips = False
        self._since = -inf
        """s, when the level was last as high as was told"""
        self._changed = -inf
        """s, when a change of the work was told"""
        self._worn: set[str] = set()
        """tools of which it was told"""
        self._at_floor = 0
        """revolutions; negative: it was told"""

    def begin(self, tool: str) -> None:
        """A workingstep begins: its cut may err otherwise than the last one's."""
        self._breakage = self._breakage.paused() if tool == self._tool else Breakage()
        self._tool, self._watch, self._has_chips = tool, Watch(), False
        self._at_floor = 0
        life = self.lives.get(tool)
        self.lives[tool] = new_tool() if life is None else compared_anew(life)

    def out_of_cut(self) -> None:
        """Without chips. The ways out and in look alike, and each like a broken tooth."""
        self._has_chips = False
        self._breakage = self._breakage.paused()

    def seen(
        self,
        revolution: Revolution,
        keep: Keeping,
        *,
        ratio: float | None,
        land_share: float = 0.0,
        expected: Expected | None = None,
    ) -> Iterator[Event]:
        """What one more revolution with chips tells.

        Parameters
        ----------
        revolution : Revolution
        keep : Keeping
            What holds in the workingstep.
        ratio : float, optional
            ln(measured / expected); None: not to be compared.
        land_share : float, 1/mm
            What 1 mm of flank wear adds to measured over expected; 0: not known.
        expected : Expected, optional
            What equal teeth would take in it; None: teeth are not compared.
        """
        if not self._has_chips:
            self._watch = Watch()
        is_steady = abs(revolution.override - self._override) <= STEADY * self._override
        self._has_chips, self._override = True, revolution.override
        if keep.set_point < inf:
            yield from self._warned(revolution, keep.set_point, is_steady=is_steady)
            yield from self._reached(revolution, keep)
        yield from self._inspected(revolution, expected, keep.exponent)
        if ratio is not None:
            yield from self._lived(revolution, ratio, land_share)

    def _warned(
        self, revolution: Revolution, set_point: float, *, is_steady: bool
    ) -> Iterator[Event]:
        """A higher level at once, a lower one when it has lasted."""
        before, force = self._watch, revolution.force
        self._watch = watched(before, revolution, set_point=set_point, is_steady=is_steady)
        level, now = self._watch.level, revolution.time
        if _RANKS[level] >= _RANKS[self.level]:
            self._since = now
        if _RANKS[level] > _RANKS[self.level] or now - self._since > CALM:
            self.level, self._since = level, now
            text = reason(before, level, force, set_point=set_point)
            yield Event(time=now, kind=_KINDS[level], text=text)

    def _reached(self, revolution: Revolution, keep: Keeping) -> Iterator[Event]:
        """Once in a workingstep: the force stays above its set point whatever the override."""
        is_over = revolution.force > ABOVE * keep.set_point
        is_at_floor = revolution.override <= ABOVE * keep.floor
        if self._at_floor < 0 or not (is_over and is_at_floor):
            self._at_floor = min(self._at_floor, 0)
            return
        self._at_floor += 1
        if self._at_floor < REACH:
            return
        self._at_floor = -1
        text = (
            f"{revolution.force:.4g} N at an override of {100.0 * revolution.override:.3g} %: "
            f"the set point of {keep.set_point:.4g} N cannot be reached within the band"
        )
        yield Event(time=revolution.time, kind=EventKind.UNREACHABLE, text=text)

    def _inspected(
        self, revolution: Revolution, expected: Expected | None, exponent: float
    ) -> Iterator[Event]:
        """A tooth that has broken."""
        self._breakage = inspected(self._breakage, revolution, expected, exponent=exponent)
        if self._breakage.broken is not None and not self.is_broken:
            self.is_broken = True
            text = f"tooth {self._breakage.broken + 1} of {revolution.teeth} takes no chip: "
            text += self._breakage.reason
            yield Event(time=revolution.time, kind=EventKind.BREAKAGE, text=text)

    def _lived(
        self, revolution: Revolution, ratio: float, land_share: float
    ) -> Iterator[Event]:
        """A sudden change of the work, or the end of a tool's life."""
        before = self.lives[self._tool]
        life = self.lives[self._tool] = lived(before, ratio, land_share=land_share)
        is_new = len(life.changes) > len(before.changes)
        is_due = revolution.time - self._changed > PAUSE
        if is_new and is_due and abs(life.changes[-1]) > NOTABLE:
            self._changed = revolution.time
            percent = 100.0 * expm1(life.changes[-1])
            way = "harder or deeper" if percent > 0.0 else "softer or shallower"
            text = f"force {percent:+.0f} % against what is expected: {way}"
            yield Event(time=revolution.time, kind=EventKind.HARDNESS, text=text)
        if life.is_worn_out and self._tool not in self._worn:
            self._worn.add(self._tool)
            text = f"tool '{self._tool}': flank wear {life.flank_wear:.2f} mm by the force"
            yield Event(time=revolution.time, kind=EventKind.WEAR, text=text)
