"""One control cycle after another: sensor, signal, law, guard, override.

A cycle is a tooth period: within it an overload is noticed; each revolution the law decides.
The loop knows only its sockets, :mod:`controller.ports`; what is plugged in may be virtual.
Running state. Units mm, s, N, W, rev/s.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite, isnan
from typing import Any

import numpy as np

from controller import overload
from controller.aims import AROUND, Aims, Step
from controller.conditioning import conditioned
from controller.cycle import Cycle
from controller.errors import MachineLost
from controller.estimate import log_ratio
from controller.guard import (
    Allowed,
    Holding,
    Keeping,
    after_hold,
    allowed,
    in_air,
    keeping,
)
from controller.law import Law, Plant, Situation
from controller.monitor import Monitor
from controller.orders import Criterion, CriterionTo, Event, EventKind, MotorPowerTo, Order
from controller.ports import Override, Sensor
from controller.preview import Preview
from controller.signal import Collector, Revolution
from controller.source import Source
from simulator.reading import Reading

STANDING = 0.02
"""override below which the axes count as standing"""

LEAST_WAY = 0.1
"""override at least with which the way of the next revolutions is reckoned"""


@dataclass(kw_only=True)
class _Hold:
    """A hold of the feed. Running state."""

    count: int = 0
    """in this workingstep"""
    is_on: bool = False
    override: float = 1.0
    """that the axes ran when it began"""
    force: float = 0.0
    """N, greatest since"""


class Loop:
    """A control loop on one machine. Running state.

    Parameters
    ----------
    sensor : Sensor
    override : Override
    source : Source
        Force by dynamometer or by power.
    law : callable
        A law tuned for a process.
    steps : sequence of Step
        The program's workingsteps in the order of their beginning.
    preview : Preview
        What the program expects; the law is told when the aims have a look-ahead.
    aims : Aims
    """

    def __init__(  # noqa: PLR0913 (everything that is plugged together, once)
        self,
        sensor: Sensor,
        override: Override,
        *,
        source: Source,
        law: Callable[[Plant], Law[Any]],
        steps: Sequence[Step],
        preview: Preview,
        aims: Aims,
    ) -> None:
        self.aims = aims
        self.is_stopped = False
        self._sensor, self._port, self._source = sensor, override, source
        self._law_for, self._steps, self._preview = law, steps, preview
        self._collector, self._monitor = Collector(), Monitor()
        self._laws: dict[Plant, Law[Any]] = {}
        self._cut: tuple[Law[Any], Any] | None = None
        """law and its state while there are chips"""
        self._step, self._number = AROUND, 0
        self._allowed = Allowed(override=1.0)
        self._set_point = 0.0
        self._hold = _Hold()
        self._shares = overload.fresh(1)
        self._greatest = 0.0
        self._silence = 0.0
        self._expected = 0.0
        self._time = 0.0
        self._orders: list[Order] = []
        self._events: list[Event] = []

    @property
    def override(self) -> float:
        """That was commanded last."""
        return self._allowed.override

    def order(self, order: Order) -> None:
        """Something that the operator wants, from the next cycle on."""
        self._orders.append(order)

    def cycle(self) -> Cycle | None:
        """Wait for a reading, and act upon it; None: the program has ended.

        Raises
        ------
        MachineLost
            When the machine does not answer any more; the safe override was commanded.
        """
        try:
            raw = self._sensor.read()
        except MachineLost:
            self._port.set(min(self._allowed.override, self.aims.band.safe))
            raise
        if raw is None:
            return None
        self._time = raw.time
        self._events = []
        if raw.workingstep != self._number:
            self._begin(raw)
        while self._orders:
            self._obey(self._orders.pop(0))
        reading = self._source.conditioned(raw, self._step.diameter)
        revolution = self._collector.add(reading)
        expected, ratio = 0.0, None
        if revolution is not None:
            expected = self._expectation(revolution)
            ratio = log_ratio(revolution, expected, expected_before=self._expected)
            self._expected = expected
        self._act(reading, revolution, ratio)
        self._port.set(self._allowed.override)
        return Cycle(
            reading=reading,
            allowed=self._allowed,
            set_point=self._set_point or inf,
            revolution=revolution,
            expected=expected,
            ratio=ratio,
            events=tuple(self._events),
        )

    def _begin(self, reading: Reading) -> None:
        """Another workingstep."""
        self._number = reading.workingstep
        at = self._number - 1
        self._step = self._steps[at] if 0 <= at < len(self._steps) else AROUND
        reference = self._step.reference
        self._hold, self._cut, self._set_point = _Hold(), None, 0.0
        self._allowed = Allowed(override=1.0)
        self._shares = overload.fresh(reading.teeth)
        self._expected = 0.0
        self._monitor.begin(self._step.tool)
        if reference.workingstep:
            bound = reference.bound(power_factor=self.aims.power_factor)
            words = "nothing bounds the force"
            if self.aims.set_point is not None:
                words = f"{self.aims.set_point:.4g} N as asked for"
            elif bound is not None:
                words = f"{bound.force:.4g} N by {bound.words}"
            self._say(EventKind.WORKINGSTEP, f"{reference.workingstep}: force bound {words}")
            if reference.inhibition:
                self._say(EventKind.INHIBITED, reference.inhibition)

    def _obey(self, order: Order) -> None:
        match order:
            case CriterionTo(criterion=criterion):
                self.aims = replace(self.aims, criterion=criterion)
                text = f"mode {criterion.value}"
            case MotorPowerTo(factor=factor):
                self.aims = replace(self.aims, power_factor=factor)
                text = f"motor power {100.0 * factor:.4g} %"
            case _:
                self.aims = replace(self.aims, is_on=order.is_on)
                text = "ON" if order.is_on else "OFF: the program's own feed"
        self._cut = None
        self._say(EventKind.ORDER, text)

    def _act(
        self, reading: Reading, revolution: Revolution | None, ratio: float | None
    ) -> None:
        """Choose the next override."""
        force = _mean(reading)
        self._silence = self._silence + reading.period if isnan(force) else 0.0
        if not reading.can_override:
            self._silence = 0.0
            self._cut = None
            return
        if len(self._shares.usual) != reading.teeth:
            self._shares = overload.fresh(reading.teeth)
        self._shares = overload.seen(self._shares, reading.tooth, force)
        level = overload.level(self._shares, reading.tooth, force)
        self._greatest = max(self._greatest, level)
        if revolution is not None:
            self._set_point = self._conditioned()
        keep = self._keep()
        if self.is_stopped:
            self._allowed = Allowed(override=0.0, holding=Holding.STOPPED)
        elif self._hold.is_on:
            self._go_on_when_safe(keep, reading, level)
        elif self.aims.is_on and level > keep.threshold(self.aims.band):
            self._stop_feed(keep, reading, level)
        elif revolution is not None or self._silence > self.aims.band.silence:
            self._allowed = self._decided(keep, revolution, ratio)
            self._greatest = 0.0

    def _conditioned(self) -> float:
        """Set point on its way to what is wanted."""
        wanted = self.aims.set_point
        if wanted is None:
            bound = self._step.reference.bound(power_factor=self.aims.power_factor)
            wanted = inf if bound is None else bound.force
        return conditioned(self._set_point, wanted)

    def _keep(self) -> Keeping:
        most = 1.0 if self.aims.criterion is Criterion.QC else inf
        return keeping(
            self.aims.band,
            self._step.reference,
            set_point=self._set_point or inf,
            exponent=self._step.exponent,
            most=most,
        )

    def _stop_feed(self, keep: Keeping, reading: Reading, level: float) -> None:
        """Hold the feed after an overload; once too often, for good."""
        hold = self._hold
        hold.count += 1
        hold.is_on, hold.override, hold.force = True, reading.override, level
        self._cut = None
        self._allowed = Allowed(override=0.0, holding=Holding.OVERLOAD)
        bound = keep.threshold(self.aims.band)
        text = f"force {level:.4g} N of a tooth exceeds {bound:.4g} N: feed held"
        self._say(EventKind.HOLD, text)
        if hold.count > self.aims.band.holds:
            self._stop(f"held {hold.count} times in this workingstep")

    def _go_on_when_safe(self, keep: Keeping, reading: Reading, level: float) -> None:
        hold = self._hold
        if level > hold.force:
            hold.override, hold.force = reading.override, level
        if reading.override > STANDING and not level < keep.set_point:
            return
        hold.is_on = False
        override = after_hold(keep, override=hold.override, force=hold.force)
        self._allowed = Allowed(override=override, holding=Holding.OVERLOAD)
        self._greatest = 0.0
        self._say(EventKind.RESUME, f"override {100.0 * override:.4g} %")

    def _stop(self, why: str) -> None:
        self.is_stopped = True
        self._allowed = Allowed(override=0.0, holding=Holding.STOPPED)
        self._say(EventKind.STOP, why)

    def _decided(
        self, keep: Keeping, revolution: Revolution | None, ratio: float | None
    ) -> Allowed:
        """The override after a revolution, or after too long without one that says a force."""
        if not self.aims.is_on:
            return Allowed(override=1.0, holding=Holding.OFF)
        if self._silence > self.aims.band.silence:
            return self._blind()
        if revolution is None:
            return self._allowed
        if isnan(revolution.force):
            return self._allowed
        if not revolution.force > self.aims.chips:
            self._cut = None
            self._monitor.out_of_cut()
            return in_air(keep, last=self._allowed.override)
        self._events += self._monitor.seen(
            revolution, ratio=ratio, set_point=keep.set_point, exponent=keep.exponent
        )
        if self._monitor.is_broken:
            self._stop("a tooth is broken")
            return self._allowed
        if self._step.reference.inhibition:
            return Allowed(override=1.0, holding=Holding.INHIBITED)
        return self._by_law(keep, revolution)

    def _blind(self) -> Allowed:
        """The safe override, until forces are read again."""
        if self._allowed.holding is not Holding.SILENCE:
            safe = 100.0 * self.aims.band.safe
            text = f"no force for {self._silence:.2g} s: override {safe:.4g} % at most"
            self._say(EventKind.SILENCE, text)
        self._cut = None
        override = min(self._allowed.override, self.aims.band.safe)
        return Allowed(override=override, holding=Holding.SILENCE)

    def _by_law(self, keep: Keeping, revolution: Revolution) -> Allowed:
        last, actual = self._allowed.override, revolution.override
        if isfinite(keep.set_point):
            law, state = self._cut or self._entered(revolution)
            state, wanted = law.decide(state, self._situation(keep, revolution))
            self._cut = law, state
        else:
            wanted = 1.0
        force = max(self._greatest, revolution.force)
        return allowed(wanted, self.aims.band, keep, last=last, actual=actual, force=force)

    def _entered(self, revolution: Revolution) -> tuple[Law[Any], Any]:
        """The law, tuned for what begins, and its state."""
        lag = round(max(self.aims.servo_lag * revolution.spindle_speed, 0.1), 1)
        plant = Plant(exponent=round(self._step.exponent, 2), lag=lag)
        if plant not in self._laws:
            self._laws[plant] = self._law_for(plant)
        law = self._laws[plant]
        return law, law.begin(max(self._allowed.override, LEAST_WAY))

    def _situation(self, keep: Keeping, revolution: Revolution) -> Situation:
        known = Situation(
            force=revolution.force,
            set_point=keep.set_point,
            override=self._allowed.override,
            actual=max(revolution.override, LEAST_WAY * keep.floor),
            floor=keep.floor,
            ceiling=keep.ceiling,
        )
        if not self.aims.look_ahead:
            return known
        preview = self._preview
        way = revolution.period * max(revolution.override, LEAST_WAY)
        return replace(
            known,
            expected=preview.mean(revolution.progress_before, revolution.progress),
            ahead=preview.ahead(
                revolution.progress, revolution=way, count=self.aims.look_ahead
            ),
        )

    def _expectation(self, revolution: Revolution) -> float:
        """Force that the catalogue's k_c gives at the override that was run, N."""
        mean = self._preview.mean(revolution.progress_before, revolution.progress)
        return float(mean * max(revolution.override, 0.0) ** self._step.exponent)

    def _say(self, kind: EventKind, text: str) -> None:
        self._events.append(Event(time=self._time, kind=kind, text=text))


def _mean(reading: Reading) -> float:
    """Mean force of a reading, N; NaN when no sample arrived."""
    force = reading.force
    total = float(np.add.reduce(force)) if len(force) else np.nan
    if not isnan(total):
        return total / len(force)
    seen = force[~np.isnan(force)]
    return float(seen.mean()) if len(seen) else np.nan
