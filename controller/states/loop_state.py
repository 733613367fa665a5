"""State machine of the control loop, with its phases and transitions.

The phase determines the override::

                          overload
              ┌─────────────────────────> HELD ──────────────┐
              │      the force has fallen  │  ^              │ held too often
              │  ┌─────────────────────────┘  │ overload     │
              │  v     no force for too long  │              │
        ──> FOLLOWING ─────────────────────> BLIND           │
            ^   ^  │ <───────────────────────┘               v
     switch │   │  └──────────────────────────────────────> STOPPED
            v   │ lock     too long below the band           ^
           OFF  v                                            │
             INHIBITED       all but OFF: a broken tooth ────┘

- FOLLOWING: the law's request, as far as the guard allows it; in air the last one, up to 1.
- HELD: 0, until each tooth is below the set point or the axes stand.
- BLIND: at most the safe override, until a revolution has a valid force.
- OFF and INHIBITED: 1; the force is only watched. The switch and the lock of a workingstep take
  effect from the next complete revolution or workingstep, and before BLIND; a hold continues to
  its end.
- STOPPED: 0, permanently.

All functions are pure: a state and a reading give the next state. Units: mm, s, N, rev/s.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import ceil, inf, isfinite, isnan, nan
from typing import Any, NamedTuple

from controller.guard import (
    AllowedOverride,
    WorkingstepBounds,
    after_hold,
    allowed,
    in_air,
    taught,
)
from controller.laws.law import ControlLaw, Plant, Situation
from controller.monitoring import overload
from controller.monitoring.monitor import ABOVE, Monitor
from controller.orders import EventKind, LoopEvent
from controller.signals.preview import Preview
from controller.signals.signal import Revolution, tooth_periods
from controller.states.following import Following
from controller.states.loop_settings import AROUND, LoopSettings, LoopStep
from controller.states.phase import FeedHold, Phase
from controller.states.set_point import approached, bounded, introduction
from simulator.reading import Reading
from stepnc_model.plurals import counted
from stepnc_model.tuples import quick_replace

STANDING = 0.02
"""Override below which the axes count as standing."""

FORGIVING = 1.0 / 100.0
"""Share of a feed hold forgotten per revolution: only holds in quick succession count."""
BELOW = 500
"""Consecutive revolutions with an override below the band after which the program stops."""

WORN_PATIENCE = 10.0
"""Time above the set point at the least feed after which a worn tool stops the program, s."""

REVOLUTIONS = 2.0
"""Revolutions without a force allowed besides the timeout; the first is mostly incomplete."""

LEAST_WAY = 0.1
"""Least override in the program time of the next revolutions."""

LawFor = Callable[[Plant], ControlLaw[Any]]
"""Function that returns a control law tuned for a process."""


@quick_replace
class LoopState(NamedTuple):
    """State of the control loop after a reading."""

    settings: LoopSettings
    preview: Preview
    """Preview of the cut ahead, in equivalent forces."""
    keep: WorkingstepBounds
    phase: Phase = Phase.FOLLOWING
    allowed: AllowedOverride = AllowedOverride(override=1.0)
    """Last commanded override, with its reason."""
    time: float = -inf
    """Time of the last reading, s."""
    workingstep: int = 0
    """Number of the running workingstep."""
    step: LoopStep = AROUND
    hold: FeedHold | None = None
    """Feed hold in progress, while HELD."""
    holds: float = 0.0
    """Feed holds in this workingstep, with decaying weights."""
    below: int = 0
    """Consecutive revolutions with an override below the floor of the band."""
    without_sample: float = 0.0
    """Time at feed since the last sample, s."""
    without_force: float = 0.0
    """Time at feed since the last revolution with a valid force, s.

    Too few samples, skipped teeth and repeated readings with an old time give no valid force.
    """
    has_chips: bool = False
    """Whether the last revolution had chips."""
    law: tuple[ControlLaw[Any], Any] | None = None
    """Law tuned for the present cut, with its state; None outside a controlled cut."""
    override_before: float = 1.0
    """Override before the last decision."""
    greatest: float = 0.0
    """Greatest load of a tooth since the last decision, N."""
    expected: float = 0.0
    """Expected force of the last revolution, N; 0: there was no cut."""
    following: Following = Following()
    """How the axes follow the override."""
    by_teeth: bool = True
    """Whether readings are tooth periods."""
    shares: overload.UsualShares = overload.fresh(1)
    monitor: Monitor = Monitor()
    events: tuple[LoopEvent, ...] = ()
    """Events that this reading has caused."""

    @property
    def override(self) -> float:
        """Last commanded override."""
        return self.allowed.override

    @property
    def is_stopped(self) -> bool:
        """True if the loop has stopped the program."""
        return self.phase is Phase.STOPPED

    @property
    def safe(self) -> float:
        """Override to use when the force is unknown: the present one, at most the safe one."""
        if self.step.reference.inhibition or not self.settings.is_on:
            return self.override
        return min(self.override, max(self.settings.band.safe, self.keep.least))

    def is_blind(self, spindle_speed: float) -> bool:
        """True if there has been no force for too long; a standing spindle does not count."""
        most = self.settings.band.sensor_timeout
        turning = REVOLUTIONS / spindle_speed if spindle_speed > 0.0 else inf
        return self.without_sample > most or self.without_force > most + turning


def initial(settings: LoopSettings, preview: Preview) -> LoopState:
    """Return the state before the first reading."""
    return LoopState(settings=settings, preview=preview, keep=bounded(settings, AROUND))


def begun(state: LoopState, reading: Reading, steps: Sequence[LoopStep]) -> LoopState:
    """Enter another workingstep; a feed hold continues while the axes slow down."""
    at, settings = reading.workingstep - 1, state.settings
    step = steps[at] if 0 <= at < len(steps) else AROUND
    state = state._replace(
        workingstep=reading.workingstep,
        step=step,
        keep=approached(bounded(settings, step), settings, step),
        holds=0.0,
        has_chips=False,
        law=None,
        expected=0.0,
        shares=overload.fresh(reading.teeth),
        monitor=state.monitor.begun(step.tool, hardness=step.taught),
    )
    if state.phase not in {Phase.HELD, Phase.STOPPED}:
        state = _opened(state)
    if step.reference.workingstep:
        state = with_event(state, EventKind.WORKINGSTEP, introduction(settings, step.reference))
        if step.reference.inhibition:
            text = f"feed left as it is: {step.reference.inhibition}"
            state = with_event(state, EventKind.INHIBITED, text)
    return state


def _opened(state: LoopState) -> LoopState:
    """Set the phase and override with which a workingstep begins."""
    if not state.settings.is_on:
        return _into(state, Phase.OFF, 1.0)
    if state.step.reference.inhibition:
        return _into(state, Phase.INHIBITED, 1.0)
    air = in_air(state.keep, last=1.0)
    if state.phase is Phase.BLIND:
        return _into(state, Phase.BLIND, min(air.override, state.settings.band.safe))
    return _into(state, Phase.FOLLOWING, air.override)


def answered(
    state: LoopState,
    reading: Reading,
    revolution: Revolution | None,
    *,
    ratio: float | None,
    force: float,
    law_for: LawFor,
) -> LoopState:
    """Process a reading: return the state with the next phase and override.

    Parameters
    ----------
    reading : Reading
        In equivalent forces.
    revolution : Revolution, optional
        Revolution that the reading completes.
    ratio : float, optional
        ln(measured / expected) of the revolution.
    force : float, N
        Mean of the reading; NaN: not known.
    """
    if not reading.can_override:
        return _out_of_cut(state)._replace(without_sample=0.0, without_force=0.0, greatest=0.0)
    state, load = _loaded(state, reading, revolution, force)
    if revolution is not None:
        keep = approached(state.keep, state.settings, state.step)
        state = state._replace(keep=keep, holds=max(0.0, state.holds - FORGIVING))
    if state.phase is Phase.STOPPED:
        return state
    hold = state.hold
    if hold is not None:
        # After a broken tooth the next one takes two chips, which may have caused the hold.
        if revolution is not None and revolution.is_covered:
            state = _watched(state, revolution, ratio)
        return state if state.is_stopped else _waited(state, hold, reading, load)
    may_hold = state.settings.is_on and not state.step.reference.inhibition
    if may_hold and load > state.keep.threshold(state.settings.band):
        return _held(state, reading, load)
    is_blind = state.is_blind(reading.spindle_speed)
    if revolution is None and not is_blind:
        return state
    decided = _decided(state, revolution, ratio, is_blind=is_blind, law_for=law_for)
    return decided._replace(override_before=state.override, greatest=0.0)


def awaited(state: LoopState, reading: Reading, law_for: LawFor) -> LoopState:
    """Wait for the rest of a tooth period, but not for too long.

    Parameters
    ----------
    reading : Reading
        Part of a tooth period, which has no load of a tooth.
    """
    sample, force = _listened(state, reading, None, nan)
    state = state._replace(without_sample=sample, without_force=force)
    if state.phase in {Phase.HELD, Phase.STOPPED} or not state.is_blind(reading.spindle_speed):
        return state
    return _decided(state, None, None, is_blind=True, law_for=law_for)


def _out_of_cut(state: LoopState) -> LoopState:
    """Leave the cut: the memory of the law does not apply to the next one."""
    if not state.has_chips:
        return state
    return state._replace(law=None, has_chips=False, monitor=state.monitor.out_of_cut())


def _listened(
    state: LoopState, reading: Reading, revolution: Revolution | None, force: float
) -> tuple[float, float]:
    """Time since the last sample and since the last valid force, s."""
    if revolution is not None and revolution.is_covered:
        return 0.0, 0.0
    without_sample = state.without_sample + reading.period if isnan(force) else 0.0
    return without_sample, state.without_force + reading.period


def _loaded(
    state: LoopState, reading: Reading, revolution: Revolution | None, force: float
) -> tuple[LoopState, float]:
    """Update the load of a tooth period, N, as compared with the threshold; NaN: not known."""
    silence = _listened(state, reading, revolution, force)
    is_same = len(state.shares.usual) == reading.teeth
    shares = state.shares if is_same else overload.fresh(reading.teeth)
    level = force
    # Means of other periods than a tooth's do not show runout.
    if state.by_teeth:
        # Noise in air and the entry into the work do not show it either.
        see = overload.seen if state.has_chips else overload.noted
        shares = see(shares, reading.tooth, force)
        level = overload.level(shares, reading.tooth, force)
    load = state.keep.load(state.settings.band, level=level, force=force)
    # One copy for all: this runs once in each tooth period.
    greatest, (sample, without) = max(state.greatest, load), silence
    return state._replace(
        without_sample=sample, without_force=without, shares=shares, greatest=greatest
    ), load


def _held(state: LoopState, reading: Reading, load: float) -> LoopState:
    """Hold the feed after an overload, or stop the program after too many holds."""
    bound = state.keep.threshold(state.settings.band)
    text = f"tooth force {load:.4g} N exceeds {bound:.4g} N: feed held"
    hold, holds = FeedHold(override=reading.override, force=load), state.holds + 1
    held = _into(state._replace(hold=hold, holds=holds, law=None), Phase.HELD, 0.0)
    held = with_event(held, EventKind.HOLD, text)
    if holds > state.settings.band.holds:
        often = f"held {counted(int(holds), 'time')} in quick succession"
        return _stopped(held, f"{often}: {state.monitor.cause}")
    return held


def _waited(state: LoopState, hold: FeedHold, reading: Reading, load: float) -> LoopState:
    """Keep holding the feed, or resume below the override that led to the hold."""
    if load > hold.force:
        hold = replace(hold, override=reading.override, force=load)
    periods = max(round(tooth_periods(reading)), 1)
    calm = hold.calm + periods if load < state.keep.set_point else 0
    if reading.override > STANDING and calm < reading.teeth:
        return state._replace(hold=replace(hold, calm=calm))
    band, keep = state.settings.band, state.keep
    override = after_hold(keep, override=hold.override, force=hold.force)
    if state.monitor.is_worn:
        # A worn edge takes its force at any feed: a lower one only rubs.
        override = max(override, keep.floor)
    cap = min(taught(band, keep, override=hold.override, force=hold.force), keep.cap)
    resumed = with_bounds(state, cap=cap)._replace(
        phase=Phase.FOLLOWING,
        allowed=AllowedOverride(override=override, holding=Phase.HELD.value),
        hold=None,
        greatest=0.0,
    )
    return with_event(resumed, EventKind.RESUME, f"override {100.0 * override:.4g} %")


def _decided(
    state: LoopState,
    revolution: Revolution | None,
    ratio: float | None,
    *,
    is_blind: bool,
    law_for: LawFor,
) -> LoopState:
    """Decide after a revolution, or after too long a time without a valid force."""
    had_chips = state.has_chips
    if revolution is not None and revolution.is_covered:
        state = _watched(state, revolution, ratio)
    if not state.settings.is_on:
        return _into(state, Phase.OFF, 1.0)
    if state.is_stopped:
        return state
    if state.step.reference.inhibition:
        return _into(state, Phase.INHIBITED, 1.0)
    if revolution is None or is_blind:
        return _blinded(state)
    if not revolution.is_covered:
        return _lowered(state, revolution)
    if state.has_chips:
        return _followed(state, revolution, law_for, is_entry=not had_chips)
    # The last revolution of a cut is partly in air and must not raise the override.
    last = min(state.override, state.override_before) if had_chips else state.override
    return _into(state, Phase.FOLLOWING, in_air(state.keep, last=last).override)


def _watched(state: LoopState, revolution: Revolution, ratio: float | None) -> LoopState:
    """Update the monitor with a revolution; during a hold only the teeth are checked."""
    if not revolution.force > state.settings.chips:
        return _out_of_cut(state)
    monitor, preview = state.monitor, state.preview
    begin, end = revolution.progress_before, revolution.progress
    teeth = preview.expected(begin, end, teeth=revolution.teeth, first=revolution.first)
    if state.phase is Phase.HELD:
        monitor = monitor.teeth_seen(revolution, state.keep, expected=teeth)
    else:
        # If the ratio is known, the expected force is known too.
        land = 0.0 if ratio is None else preview.mean_land(begin, end) / state.expected
        monitor = monitor.seen(
            revolution,
            state.keep,
            ratio=ratio,
            land_share=land,
            normal=nan if ratio is None else revolution.normal / state.expected,
            expected=teeth,
        )
    events = (*state.events, *monitor.events)
    state = state._replace(monitor=monitor, has_chips=True, events=events)
    is_broken = monitor.breakage.is_broken and state.settings.is_on
    return _stopped(state, "a tooth is broken") if is_broken else state


def _blinded(state: LoopState) -> LoopState:
    """Apply the safe override until forces are read again."""
    if state.phase is not Phase.BLIND:
        safe = 100.0 * state.settings.band.safe
        text = f"no force for {state.without_force:.2g} s: override limited to {safe:.4g} %"
        state = with_event(state, EventKind.SILENCE, text)
    return _into(state._replace(law=None), Phase.BLIND, state.safe)


def _lowered(state: LoopState, revolution: Revolution) -> LoopState:
    """Keep the last override, or reduce it if the few samples that arrived require it."""
    got = allowed(
        state.override,
        state.settings.band,
        state.keep,
        last=state.override,
        actual=revolution.override,
        force=state.greatest,
    )
    is_lower = got.override < state.override
    return state._replace(phase=Phase.FOLLOWING, allowed=got) if is_lower else state


def _followed(
    state: LoopState, revolution: Revolution, law_for: LawFor, *, is_entry: bool
) -> LoopState:
    """Apply the override requested by the law, as far as the guard allows it."""
    wanted, law, last, keep = 1.0, state.law, state.override, state.keep
    if isfinite(keep.set_point):
        tuned, memory = law or _tuned(state, revolution, law_for)
        memory, wanted = tuned.decide(memory, _situation(state, revolution))
        law = tuned, memory
    if is_entry:
        # The force of a revolution that began in the air is too small to be trusted.
        wanted = min(wanted, last)
    got = allowed(
        wanted,
        state.settings.band,
        keep,
        last=last,
        actual=revolution.override,
        force=max(state.greatest, revolution.force),
    )
    monitor, is_least = state.monitor, got.override <= ABOVE * keep.floor
    if monitor.is_worn and monitor.over.seconds > WORN_PATIENCE and is_least:
        least = f"{monitor.share:.3g} times the set point even at the least feed"
        return _stopped(state, f"the force is {least}: {monitor.cause}")
    below = state.below + 1 if got.override < min(keep.floor, state.settings.most) else 0
    if below > BELOW:
        percent = 100.0 * keep.floor
        text = f"the force is too high even at {percent:.3g} % of the programmed feed"
        return _stopped(state, f"{text}: {state.monitor.cause}")
    return state._replace(law=law, below=below, phase=Phase.FOLLOWING, allowed=got)


def _tuned(
    state: LoopState, revolution: Revolution, law_for: LawFor
) -> tuple[ControlLaw[Any], Any]:
    """Tune the law for the cut that begins, and return it with its initial state."""
    # Rounded, so that equal cuts reuse a cached law.
    lag = state.settings.servo_lag * revolution.spindle_speed / _turns(revolution)
    lag = round(max(lag, 0.1), 1)
    law = law_for(Plant(exponent=round(state.keep.exponent, 2) or state.keep.exponent, lag=lag))
    return law, law.begin(max(state.override, LEAST_WAY))


def _situation(state: LoopState, revolution: Revolution) -> Situation:
    """Input for the control law from the state and a revolution."""
    keep, preview = state.keep, state.preview
    look_ahead = ceil(state.settings.look_ahead / _turns(revolution))
    way = revolution.period * max(revolution.override, LEAST_WAY)
    begin, end = revolution.progress_before, revolution.progress
    return Situation(
        force=revolution.force,
        set_point=keep.set_point,
        override=state.override,
        actual=max(revolution.override, LEAST_WAY * keep.floor),
        floor=keep.floor,
        ceiling=keep.ceiling,
        expected=preview.mean(begin, end) if look_ahead else 0.0,
        ahead=preview.ahead(end, revolution=way, count=look_ahead) if look_ahead else (),
    )


def _turns(revolution: Revolution) -> float:
    """Turns between two decisions of the law."""
    return 1.0 if revolution.by_teeth else max(revolution.turns, 1.0)


def with_bounds(state: LoopState, *, cap: float) -> LoopState:
    """Update the bounds from the settings."""
    keep = bounded(
        state.settings,
        state.step,
        set_point=state.keep.set_point,
        settled=state.keep.settled,
        cap=cap,
    )
    return state._replace(keep=keep)


def _stopped(state: LoopState, why: str) -> LoopState:
    """Stop the program permanently, with the reason."""
    return with_event(_into(state, Phase.STOPPED, 0.0), EventKind.STOP, why)


def _into(state: LoopState, phase: Phase, override: float) -> LoopState:
    """Change to a phase, with its override."""
    allowed_ = AllowedOverride(override=override, holding=phase.value)
    return state._replace(phase=phase, allowed=allowed_)


def with_event(state: LoopState, kind: EventKind, text: str) -> LoopState:
    """Add an event."""
    event = LoopEvent(time=state.time, kind=kind, text=text)
    return state._replace(events=(*state.events, event))
