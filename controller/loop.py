"""One control cycle after another: sensor, signal, law, guard, override.

A cycle is a tooth period: within it an overload is noticed; each revolution the law decides.
The loop knows only its sockets, :mod:`controller.ports`; what is plugged in may be virtual.
Running state. Units mm, s, N, W, rev/s.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf, isfinite, isnan, nan
from typing import Any

from controller import overload
from controller.aims import AROUND, Aims, Step
from controller.cycle import Cycle
from controller.equivalent import equivalent, weighed
from controller.estimate import log_ratio
from controller.guard import Allowed, Holding, after_hold, allowed, in_air, taught
from controller.hold import Hold
from controller.law import Law, Plant
from controller.monitor import Monitor
from controller.orders import CriterionTo, Event, EventKind, MotorPowerTo, Order
from controller.ports import Override, Sensor
from controller.preview import Preview
from controller.signal import Collector, Revolution
from controller.silence import HEARD, is_blind, is_implausible, listened
from controller.source import Source
from controller.steering import Steering
from controller.target import Target, approached, introduction, kept
from simulator.reading import Reading

STANDING = 0.02
"""override below which the axes count as standing"""


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
        self._steps, self._plain = steps, preview
        self._steering = Steering(law, equivalent(preview, steps, aims))
        self._collector, self._monitor = Collector(), Monitor()
        self._step, self._number = AROUND, 0
        self._allowed = Allowed(override=1.0)
        self._target = Target()
        self._keep = kept(self._target, aims, AROUND)
        self._hold, self._shares = Hold(), overload.fresh(1)
        self._has_chips = False
        """whether the last revolution had"""
        self._override_before = 1.0
        """before the last revolution was decided upon"""
        self._greatest = 0.0
        """N, load of a tooth since the last decision"""
        self._silence = HEARD
        self._expected = 0.0
        self._land_share = 0.0
        """1/mm, what flank wear adds to the ratio of the last revolution"""
        self._time = -inf
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

        Whatever goes wrong in it, the safe override is commanded before it is raised.

        Raises
        ------
        MachineLost
            When the machine does not answer any more.
        """
        try:
            raw = self._sensor.read()
            return None if raw is None else self._answered(raw)
        except BaseException:
            self._port.set(self._safe())
            raise

    def _answered(self, raw: Reading) -> Cycle:
        """What is done upon a reading."""
        is_new, self._time = raw.time > self._time, raw.time
        self._events = []
        if raw.workingstep != self._number:
            self._begin(raw)
        while self._orders:
            self._obey(self._orders.pop(0))
        weight = self._steering.weight(raw)
        reading = self._source.conditioned(
            raw, self._step.diameter, is_air=self._steering.is_air(raw)
        )
        reading = weighed(reading, weight)
        # One that comes again tells nothing.
        revolution = self._collector.add(reading) if is_new else None
        if revolution is not None and is_implausible(revolution.force, self.aims.chips):
            revolution = None
        expected, ratio = 0.0, None
        if revolution is not None:
            expected = self._steering.expectation(revolution, self._step.exponent)
            # Hardly a chip tells nothing of k_c.
            known = expected if expected > weight * self.aims.chips else 0.0
            ratio = log_ratio(revolution, known, expected_before=self._expected)
            self._expected = known
            self._land_share = self._steering.land_share(revolution, expected)
        force = overload.mean(reading.force) if is_new else nan
        force = nan if is_implausible(force, self.aims.chips) else force
        self._act(reading, revolution, ratio, force=force)
        self._port.set(self._allowed.override)
        return Cycle(
            reading=reading,
            allowed=self._allowed,
            set_point=self._keep.set_point,
            revolution=revolution,
            expected=expected,
            ratio=ratio,
            weight=weight,
            events=tuple(self._events),
        )

    def _begin(self, reading: Reading) -> None:
        """Another workingstep. A hold goes on: the axes may still be slowing down."""
        self._number = reading.workingstep
        at = self._number - 1
        self._step = self._steps[at] if 0 <= at < len(self._steps) else AROUND
        self._steering.leave()
        self._has_chips, self._expected = False, 0.0
        self._hold.count = 0.0
        self._target = Target()
        self._keep = kept(self._target, self.aims, self._step)
        self._approach()
        if not (self.is_stopped or self._hold.is_on):
            self._allowed = self._beginning()
        self._shares = overload.fresh(reading.teeth)
        self._monitor.begin(self._step.tool)
        reference = self._step.reference
        if reference.workingstep:
            self._say(EventKind.WORKINGSTEP, introduction(self.aims, reference))
            if reference.inhibition:
                self._say(EventKind.INHIBITED, f"feed left as it is: {reference.inhibition}")

    def _beginning(self) -> Allowed:
        """The override with which a workingstep begins."""
        if not self.aims.is_on:
            return Allowed(override=1.0, holding=Holding.OFF)
        if self._step.reference.inhibition:
            return Allowed(override=1.0, holding=Holding.INHIBITED)
        begin = in_air(self._keep, last=1.0)
        if self._allowed.holding is Holding.SILENCE:
            return replace(self._allowed, override=min(begin.override, self.aims.band.safe))
        return begin

    def _obey(self, order: Order) -> None:
        match order:
            case CriterionTo(criterion=criterion):
                self.aims = replace(self.aims, criterion=criterion)
                text = f"mode {criterion.value}"
            case MotorPowerTo(factor=factor):
                self.aims = replace(self.aims, power_factor=factor)
                self._steering.preview = equivalent(self._plain, self._steps, self.aims)
                text = f"motor power {100.0 * factor:.4g} %"
            case _:
                self.aims = replace(self.aims, is_on=order.is_on)
                text = "ON" if order.is_on else "OFF: the program's own feed"
        self._steering.leave()
        self._keep = kept(self._target, self.aims, self._step)
        self._say(EventKind.ORDER, text)

    def _act(
        self,
        reading: Reading,
        revolution: Revolution | None,
        ratio: float | None,
        *,
        force: float,
    ) -> None:
        """Choose the next override; force in N is the mean of the reading, NaN: not known."""
        if not reading.can_override:
            self._steering.leave()
            if self._has_chips:
                self._monitor.out_of_cut()
            self._silence, self._has_chips, self._greatest = HEARD, False, 0.0
            return
        self._silence = listened(self._silence, reading, revolution, has_force=not isnan(force))
        load = self._loaded(reading, force)
        if revolution is not None:
            self._approach()
        if self.is_stopped:
            self._allowed = Allowed(override=0.0, holding=Holding.STOPPED)
        elif self._hold.is_on:
            self._go_on_when_safe(reading, load)
        elif self._may_hold and load > self._keep.threshold(self.aims.band):
            self._stop_feed(reading, load)
        elif revolution is not None or self._is_blind(reading):
            before = self._allowed.override
            self._allowed = self._decided(reading, revolution, ratio)
            self._override_before, self._greatest = before, 0.0

    @property
    def _may_hold(self) -> bool:
        return self.aims.is_on and not self._step.reference.inhibition

    def _is_blind(self, reading: Reading) -> bool:
        speed = reading.spindle_speed
        return is_blind(self._silence, allowed=self.aims.band.silence, spindle_speed=speed)

    def _loaded(self, reading: Reading, force: float) -> float:
        """Load of a tooth period, N, as the threshold counts it; NaN: not known."""
        if len(self._shares.usual) != reading.teeth:
            self._shares = overload.fresh(reading.teeth)
        # Noise in the air and the way into the work tell nothing of runout.
        see = overload.seen if self._has_chips else overload.noted
        self._shares = see(self._shares, reading.tooth, force)
        level = overload.level(self._shares, reading.tooth, force)
        load = self._keep.load(self.aims.band, level=level, force=force)
        self._greatest = max(self._greatest, load)
        return load

    def _approach(self) -> None:
        """What holds for the next revolution."""
        self._hold.forgive()
        target = approached(self._target, self.aims, self._step.reference)
        if target == self._target:
            return
        self._target = target
        self._keep = kept(self._target, self.aims, self._step)

    def _stop_feed(self, reading: Reading, load: float) -> None:
        """Hold the feed after an overload; once too often, for good."""
        hold = self._hold
        hold.count += 1
        hold.is_on, hold.override, hold.force, hold.calm = True, reading.override, load, 0
        self._steering.leave()
        self._allowed = Allowed(override=0.0, holding=Holding.OVERLOAD)
        bound = self._keep.threshold(self.aims.band)
        text = f"force {load:.4g} N of a tooth exceeds {bound:.4g} N: feed held"
        self._say(EventKind.HOLD, text)
        if hold.count > self.aims.band.holds:
            self._stop(f"held {hold.count:.0f} times in quick succession")

    def _go_on_when_safe(self, reading: Reading, load: float) -> None:
        hold = self._hold
        if load > hold.force:
            hold.override, hold.force = reading.override, load
        hold.calm = hold.calm + 1 if load < self._keep.set_point else 0
        if reading.override > STANDING and hold.calm < reading.teeth:
            return
        hold.is_on = False
        keep, band = self._keep, self.aims.band
        override = after_hold(keep, override=hold.override, force=hold.force)
        cap = taught(band, keep, override=hold.override, force=hold.force)
        self._target = replace(self._target, cap=min(cap, self._target.cap))
        self._keep = kept(self._target, self.aims, self._step)
        self._allowed = Allowed(override=override, holding=Holding.OVERLOAD)
        self._greatest = 0.0
        self._say(EventKind.RESUME, f"override {100.0 * override:.4g} %")

    def _stop(self, why: str) -> None:
        self.is_stopped = True
        self._allowed = Allowed(override=0.0, holding=Holding.STOPPED)
        self._say(EventKind.STOP, why)

    def _decided(
        self, reading: Reading, revolution: Revolution | None, ratio: float | None
    ) -> Allowed:
        """The override after a revolution, or after too long without one that says a force."""
        if not self.aims.is_on:
            return Allowed(override=1.0, holding=Holding.OFF)
        is_entry = not self._has_chips
        if revolution is not None and revolution.is_covered:
            self._watch(revolution, ratio)
        if self.is_stopped:
            return self._allowed
        if self._step.reference.inhibition:
            return Allowed(override=1.0, holding=Holding.INHIBITED)
        if self._is_blind(reading):
            return self._blind()
        if revolution is None:
            return self._allowed
        if not revolution.is_covered:
            return self._lowered(revolution)
        if not self._has_chips:
            return in_air(self._keep, last=self._left(is_exit=not is_entry))
        return self._by_law(revolution, is_entry=is_entry)

    def _watch(self, revolution: Revolution, ratio: float | None) -> None:
        """What is looked at besides the feed."""
        had_chips, self._has_chips = self._has_chips, revolution.force > self.aims.chips
        if not self._has_chips:
            if had_chips:
                self._steering.leave()
                self._monitor.out_of_cut()
            return
        teeth, land_share = self._steering.teeth(revolution), self._land_share
        self._events += self._monitor.seen(
            revolution, self._keep, ratio=ratio, land_share=land_share, expected=teeth
        )
        if self._monitor.is_broken:
            self._stop("a tooth is broken")

    def _blind(self) -> Allowed:
        """The safe override, until forces are read again."""
        if self._allowed.holding is not Holding.SILENCE:
            safe = 100.0 * self.aims.band.safe
            text = (
                f"no force for {self._silence.revolutions:.2g} s: override {safe:.4g} % at most"
            )
            self._say(EventKind.SILENCE, text)
        self._steering.leave()
        return Allowed(override=self._safe(), holding=Holding.SILENCE)

    def _safe(self) -> float:
        """The override when nothing is known: what it is, at most the safe one."""
        if self._step.reference.inhibition or not self.aims.is_on:
            return self._allowed.override
        return min(self._allowed.override, self.aims.band.safe)

    def _lowered(self, revolution: Revolution) -> Allowed:
        """The last override, or less where the few samples that arrived ask for it."""
        last = self._allowed
        got = allowed(
            last.override,
            self.aims.band,
            self._keep,
            last=last.override,
            actual=revolution.override,
            force=self._greatest,
        )
        return got if got.override < last.override else last

    def _left(self, *, is_exit: bool) -> float:
        """The override of the cut: its last revolution, half in the air, must not raise it."""
        last = self._allowed.override
        return min(last, self._override_before) if is_exit else last

    def _by_law(self, revolution: Revolution, *, is_entry: bool) -> Allowed:
        last, keep = self._allowed.override, self._keep
        wanted = 1.0
        if isfinite(keep.set_point):
            wanted = self._steering.wish(revolution, keep, aims=self.aims, override=last)
        if is_entry:
            # The force of a revolution that began in the air is too small to be trusted.
            wanted = min(wanted, last)
        got = allowed(
            wanted,
            self.aims.band,
            keep,
            last=last,
            actual=revolution.override,
            force=max(self._greatest, revolution.force),
        )
        if self._hold.stays_below(is_below=got.override < keep.floor):
            percent = 100.0 * keep.floor
            self._stop(f"the tool is in danger even at {percent:.3g} % of the programmed feed")
            return self._allowed
        return got

    def _say(self, kind: EventKind, text: str) -> None:
        self._events.append(Event(time=self._time, kind=kind, text=text))
