"""Process monitor of a run: force warnings, broken teeth, tool wear, changes of the work.

A state and its update by revolutions with chips. Units: N, s.

A state, and what revolutions with chips make of it. Units N, s.
"""

from collections.abc import Mapping
from math import expm1, inf, nan
from types import MappingProxyType
from typing import NamedTuple

from controller.guard import WorkingstepBounds
from controller.monitoring.breakage import Breakage, inspected
from controller.monitoring.threshold import AlarmLevel, ThresholdWatch, reason, watched
from controller.monitoring.tool_life import (
    Ratios,
    ToolLife,
    compared_anew,
    lived,
    new_tool,
    taught,
)
from controller.orders import EventKind, LoopEvent
from controller.signals.preview import Expected
from controller.signals.signal import Revolution
from simulator.physics.tool_life import LIFE_CRITERION
from stepnc_model.tuples import quick_replace

STEADY = 0.02
"""Greatest relative change of the override per revolution that counts as steady."""

CALM = 5.0
"""Time for which the level must be lower before this is reported, s.

A force that fluctuates about a threshold must not flood the operator; a higher level is
reported at once.
"""

PAUSE = 10.0
"""Least time between two reported changes of the work, s."""

NOTABLE = 0.1
"""Least change of ln F that is reported; the expected force errs by less in corners."""

REACH = 20
"""Revolutions at the floor of the override with a force above the set point before a report.

It is more than any drive needs to slow down.
"""

WORN_SHARE = 0.3
"""Share of the wear land in the force from which wear counts as the cause of too much force."""

ABOVE = 1.05
"""Factor on the set point and on the floor within which they count as reached."""

LASTS = 3.0
"""Time for which the mean force must stay above the set point to count as over it, s."""

LASTING = 0.2
"""Weight of a revolution in the mean force that is compared with the set point."""

_KINDS = {
    AlarmLevel.SAFE: EventKind.SAFE,
    AlarmLevel.WARNING: EventKind.WARNING,
    AlarmLevel.OVER: EventKind.OVER,
}
_RANKS = {level: rank for rank, level in enumerate(_KINDS)}


class OverTime(NamedTuple):
    """Time without a break in which the force is above its set point by a twentieth or more."""

    seconds: float = 0.0
    """Cutting time, s."""
    most: float = 0.0
    """Greatest mean force over the set point in this time."""

    @property
    def is_lasting(self) -> bool:
        """True if it has lasted longer than a law needs to bring the force back."""
        return self.seconds >= LASTS


NOT_OVER = OverTime()
"""No time above the set point."""


@quick_replace
class Monitor(NamedTuple):
    """State of the process monitor, learnt from the revolutions so far."""

    tool: str = ""
    """Id of the tool in the spindle."""
    lives: Mapping[str, ToolLife] = MappingProxyType({})
    """Wear estimates by tool id."""
    worn: frozenset[str] = frozenset()
    """Tools whose wear was reported."""
    breakage: Breakage = Breakage()
    watch: ThresholdWatch = ThresholdWatch()
    override: float = 1.0
    """Override in the last revolution."""
    level: AlarmLevel = AlarmLevel.SAFE
    """Level that was reported last."""
    since: float = -inf
    """Time when the level was last as high as reported, s."""
    changed: float = -inf
    """Time when a change of the work was last reported, s."""
    cut: float = 0.0
    """Time with chips since a revolution was last compared with its expected force, s."""
    land_share: float = 0.0
    """Increase of the ratio by 1 mm of flank wear in that revolution, 1/mm; 0: not known."""
    share: float = 0.0
    """Moving mean of the force over the set point; 0: not known."""
    over: OverTime = NOT_OVER
    """How long that mean has been above the set point without a break."""
    at_floor: int = 0
    """Revolutions at the floor of the override; negative once reported."""
    events: tuple[LoopEvent, ...] = ()
    """Events caused by the last revolution."""

    @property
    def life(self) -> ToolLife | None:
        """Wear of the tool in the spindle; None before anything was compared."""
        return self.lives.get(self.tool)

    @property
    def is_worn(self) -> bool:
        """True if the wear land takes a large share of the force now."""
        life = self.life
        return life is not None and life.share(self.land_share) > WORN_SHARE

    @property
    def cause(self) -> str:
        """Cause of a force that is too great, in words, as far as it is known."""
        life = self.life
        if life is not None and self.is_worn:
            return (
                f"{wear_words(life)} takes {100.0 * life.share(self.land_share):.0f} % of the "
                "force: change the tool"
            )
        return "a harder or deeper cut"

    def begun(self, tool: str, *, hardness: float | None = None) -> "Monitor":
        """Enter a new workingstep, whose force errors may differ from those of the last one.

        Parameters
        ----------
        hardness : float, optional
            Factor on k_c that the sharp tool has taught in this cut; None: none was taught.
        """
        life = self.lives.get(tool)
        begun = new_tool() if life is None else compared_anew(life)
        if hardness is not None:
            begun = taught(begun, hardness)
        return self._replace(
            tool=tool,
            lives={**self.lives, tool: begun},
            breakage=self.breakage.paused() if tool == self.tool else Breakage(),
            watch=ThresholdWatch(),
            share=0.0,
            over=NOT_OVER,
            at_floor=0,
        )

    def out_of_cut(self) -> "Monitor":
        """Leave the cut; entries and exits resemble a broken tooth and are not compared."""
        return self._replace(
            watch=ThresholdWatch(),
            breakage=self.breakage.paused(),
            share=0.0,
            over=NOT_OVER,
        )

    def seen(
        self,
        revolution: Revolution,
        keep: WorkingstepBounds,
        *,
        ratio: float | None,
        land_share: float = 0.0,
        normal: float = nan,
        expected: Expected | None = None,
    ) -> "Monitor":
        """Update the monitor with one more revolution with chips.

        Parameters
        ----------
        keep : WorkingstepBounds
            Bounds of the workingstep.
        ratio : float, optional
            ln(measured / expected); None: not comparable.
        land_share : float, 1/mm
            Increase of measured over expected force by 1 mm of flank wear; 0: not known.
        normal : float
            Measured normal force over expected cutting force; NaN: not measured.
        expected : Expected, optional
            Forces that equal teeth would take in it; None: teeth are not compared.
        """
        monitor = self._replace(events=(), cut=self.cut + revolution.period)
        if keep.set_point < inf:
            monitor = _compared(monitor, revolution, keep.set_point)
            monitor = _reached(_warned(monitor, revolution, keep.set_point), revolution, keep)
        monitor = _inspected(monitor, revolution, expected, keep.exponent)
        if ratio is None:
            return monitor
        ratios = Ratios(
            log_ratio=ratio, land_share=land_share, period=monitor.cut, normal=normal
        )
        return _lived(monitor, revolution.time, ratios)

    def teeth_seen(
        self, revolution: Revolution, keep: WorkingstepBounds, *, expected: Expected | None
    ) -> "Monitor":
        """Check the teeth in a revolution while the feed is held, without force warnings."""
        return _inspected(self._replace(events=()), revolution, expected, keep.exponent)


def _with_event(monitor: Monitor, kind: EventKind, time: float, text: str) -> Monitor:
    event = LoopEvent(time=time, kind=kind, text=text)
    return monitor._replace(events=(*monitor.events, event))


def _warned(monitor: Monitor, revolution: Revolution, set_point: float) -> Monitor:
    """Report a higher alarm level at once, a lower one when it has lasted."""
    before, force, now = monitor.watch, revolution.force, revolution.time
    is_steady = abs(revolution.override - monitor.override) <= STEADY * monitor.override
    watch = watched(before, revolution, set_point=set_point, is_steady=is_steady)
    level, over = watch.level, monitor.over
    if over.is_lasting:
        level = AlarmLevel.OVER
    rise = _RANKS[level] - _RANKS[monitor.level]
    since = now if rise >= 0 else monitor.since
    monitor = monitor._replace(watch=watch, since=since)
    if rise <= 0 and now - since <= CALM:
        return monitor
    text = reason(before, watch.level, force, set_point=set_point)
    if over.is_lasting and watch.level is not AlarmLevel.OVER:
        text = (
            f"force {monitor.share:.3g} times the set point of {set_point:.4g} N for "
            f"{over.seconds:.3g} s: {force:.4g} N, limit {ABOVE:g} times"
        )
    monitor = monitor._replace(level=level, since=now)
    return _with_event(monitor, _KINDS[level], now, text)


def _compared(monitor: Monitor, revolution: Revolution, set_point: float) -> Monitor:
    """Update for how long the force has been above the set point."""
    share, before = revolution.force / set_point, monitor.share
    share = before + LASTING * (share - before) if before else share
    if share <= ABOVE:
        return monitor._replace(share=share, over=NOT_OVER)
    seconds = monitor.over.seconds + revolution.period
    over = OverTime(seconds=seconds, most=max(monitor.over.most, share))
    return monitor._replace(share=share, over=over)


def _reached(monitor: Monitor, revolution: Revolution, keep: WorkingstepBounds) -> Monitor:
    """Report, once per workingstep, that the set point cannot be reached within the band."""
    is_above = revolution.force > ABOVE * keep.set_point
    is_at_floor = revolution.override <= ABOVE * keep.floor
    if monitor.at_floor < 0 or not (is_above and is_at_floor):
        return monitor._replace(at_floor=min(monitor.at_floor, 0))
    if monitor.at_floor + 1 < REACH:
        return monitor._replace(at_floor=monitor.at_floor + 1)
    text = (
        f"{revolution.force:.4g} N at an override of {100.0 * revolution.override:.3g} %: "
        f"the set point of {keep.set_point:.4g} N cannot be reached within the band"
    )
    monitor = monitor._replace(at_floor=-1)
    return _with_event(monitor, EventKind.UNREACHABLE, revolution.time, text)


def _inspected(
    monitor: Monitor, revolution: Revolution, expected: Expected | None, exponent: float
) -> Monitor:
    """Check for a broken tooth and report it."""
    before = monitor.breakage
    breakage = inspected(before, revolution, expected, exponent=exponent)
    monitor = monitor._replace(breakage=breakage, override=revolution.override)
    if breakage.broken is None or before.is_broken:
        return monitor
    text = f"tooth {breakage.broken + 1} of {revolution.teeth} takes no chip: "
    return _with_event(monitor, EventKind.BREAKAGE, revolution.time, text + breakage.reason)


def wear_words(life: ToolLife) -> str:
    """Flank wear of a tool with its uncertainty."""
    return f"flank wear {life.flank_wear:.2f} ± {life.uncertainty:.2f} mm"


def _lived(monitor: Monitor, now: float, ratios: Ratios) -> Monitor:
    """Update the wear estimate; report a sudden change of the work, or a worn tool."""
    tool = monitor.tool
    before = monitor.lives.get(tool) or new_tool()
    life = lived(before, ratios)
    monitor = monitor._replace(
        lives={**monitor.lives, tool: life}, cut=0.0, land_share=ratios.land_share
    )
    is_new = len(life.changes) > len(before.changes)
    if is_new and now - monitor.changed > PAUSE and abs(life.changes[-1]) > NOTABLE:
        percent = 100.0 * expm1(life.changes[-1])
        way = "harder or deeper cut" if percent > 0.0 else "softer or shallower cut"
        text = f"force {percent:+.0f} % relative to the expected force: {way}"
        monitor = _with_event(monitor._replace(changed=now), EventKind.HARDNESS, now, text)
    if life.is_worn_out and tool not in monitor.worn:
        text = (
            f"tool '{tool}': {wear_words(life)} by {life.basis}; its life ends at "
            f"{LIFE_CRITERION:g} mm: change the tool"
        )
        monitor = monitor._replace(worn=monitor.worn | {tool})
        monitor = _with_event(monitor, EventKind.WEAR, now, text)
    return monitor
