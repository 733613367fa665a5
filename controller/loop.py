"""Control loop: repeats sensor, signal processing, state transition and override.

A cycle is a tooth period: within it an overload is noticed; once a revolution the law decides
(:mod:`controller.states.loop_state`). The loop knows only its interfaces,
:mod:`controller.signals.ports`; the machine behind them may be virtual. Mutable state. Units:
mm, s, N, W, rev/s.
"""

from collections.abc import Sequence
from functools import cache
from math import nan

from controller.cycle import LoopCycle
from controller.monitoring import overload
from controller.monitoring.tool_life import ToolLife
from controller.orders import Order
from controller.signals.estimate import log_ratio
from controller.signals.ports import Override, Sensor
from controller.signals.preview import Preview
from controller.signals.signal import Collector, ToothJoiner, tooth_periods
from controller.signals.source import Source
from controller.states.equivalent_force import equivalent, weighed
from controller.states.loop_settings import LoopSettings, LoopStep
from controller.states.loop_state import (
    LEAST_WAY,
    LawFor,
    LoopState,
    answered,
    awaited,
    begun,
    initial,
)
from controller.states.order_effects import obeyed, operated
from controller.states.supervision import resolved, supervised
from simulator.reading import Reading

IMPLAUSIBLE = 5.0
"""Multiple of the chip force by which a force may be below zero before it is rejected.

No cut pulls that much, so the zero of the instrument must be wrong.
"""


class Loop:
    """Control loop of the feed override on one machine (mutable state).

    Parameters
    ----------
    source : Source
        Force from a dynamometer or from spindle power.
    law : callable
        Returns a law tuned for a process.
    steps : sequence of LoopStep
        The program's workingsteps in the order in which they begin.
    preview : Preview
        Force that the program expects; the law uses it when the settings have a look-ahead.
    """

    def __init__(  # noqa: PLR0913 (everything that is plugged together, once)
        self,
        sensor: Sensor,
        override: Override,
        *,
        source: Source,
        law: LawFor,
        steps: Sequence[LoopStep],
        preview: Preview,
        settings: LoopSettings,
    ) -> None:
        self.state = initial(settings, equivalent(preview, steps, settings))
        self._sensor, self._port, self._source = sensor, override, source
        self._law_for, self._steps, self._plain = cache(law), steps, preview
        self._collector, self._pieces = Collector(), ToothJoiner()
        self._orders: list[Order] = []

    def order(self, order: Order) -> None:
        """Queue an order of the operator, which takes effect from the next cycle on."""
        self._orders.append(order)

    def cycle(self) -> LoopCycle | None:
        """Wait for a reading and act on it; None when the program has ended.

        On any error, the safe override is commanded before the error is raised.

        Raises
        ------
        MachineLost
            When the machine no longer responds.
        """
        try:
            raw = self._sensor.read()
            return None if raw is None else self._answered(raw)
        except BaseException:
            self._port.set(self.state.safe)
            raise

    def _answered(self, raw: Reading) -> LoopCycle:
        """Process one reading: condition it, update the state, and command the override."""
        is_new = raw.time > self.state.time
        state = supervised(self._entered(raw), raw)
        # Program time that one revolution takes at the present override.
        way = _turn(raw) * max(raw.override, LEAST_WAY)
        preview, least = state.preview, -IMPLAUSIBLE * state.settings.chips
        weight = preview.weight_between(raw.progress - way, raw.progress)
        is_air = preview.is_air(raw.progress, revolution=way)
        conditioned = self._source.conditioned(raw, state.step.diameter, is_air=is_air)
        reading = weighed(conditioned, weight)
        # A repeated reading carries no new information.
        whole = self._pieces.add(reading) if is_new else reading
        if whole is None:
            # A part of a tooth period is no load of a tooth.
            self.state = operated(awaited(state, reading, self._law_for))
            self._port.set(self.state.override)
            return self._cycle(reading, weight, None)
        is_tooth = whole is reading
        revolution = self._collector.add(whole, is_tooth=is_tooth) if is_new else None
        if revolution is not None and revolution.force < least:
            revolution = None
        force = overload.mean(whole.force) if is_new else nan
        expected, ratio = 0.0, None
        if revolution is not None:
            # Force by the catalogue's k_c at the override that was run.
            mean = preview.mean(revolution.progress_before, revolution.progress)
            expected = float(mean * max(revolution.override, 0.0) ** state.step.exponent)
            # A force near zero gives no information on k_c.
            is_known = reading.is_placed and expected > weight * state.settings.chips
            known = expected if is_known else 0.0
            ratio = log_ratio(revolution, known, expected_before=state.expected)
            state = resolved(state._replace(expected=known), reading, revolution)
        state = answered(
            state,
            whole,
            revolution,
            ratio=ratio,
            force=nan if force < least else force,
            law_for=self._law_for,
        )
        self.state = operated(state)
        self._port.set(self.state.override)
        cycle = self._cycle(reading, weight, self.state.monitor.life)
        if revolution is None:
            return cycle
        sharp = ratio
        if cycle.life is not None and ratio is not None:
            sharp = cycle.life.sharp(ratio, self.state.monitor.land_share)
        return cycle._replace(
            revolution=revolution, expected=expected, ratio=ratio, sharp_ratio=sharp
        )

    def _entered(self, raw: Reading) -> LoopState:
        """State in the workingstep of a reading, once the orders are obeyed."""
        state = self.state._replace(time=raw.time, events=())
        if raw.workingstep != state.workingstep:
            state = begun(state, raw, self._steps)
        while self._orders:
            order = self._orders.pop(0)
            state = obeyed(state, order, plain=self._plain, steps=self._steps)
        return state

    def _cycle(self, reading: Reading, weight: float, life: ToolLife | None) -> LoopCycle:
        """Result of a cycle in which no revolution ends."""
        state = self.state
        return LoopCycle(
            reading=reading,
            allowed=state.allowed,
            set_point=state.keep.set_point,
            revolution=None,
            expected=0.0,
            ratio=None,
            events=state.events,
            weight=weight,
            over=state.monitor.over,
            life=life,
            is_astray=state.following.is_astray,
        )


def _turn(reading: Reading) -> float:
    """Duration of a revolution, or of a reading if that is longer, s."""
    periods = tooth_periods(reading)
    if periods <= 0.0 or reading.teeth * abs(periods - 1.0) < 1.0:
        return reading.period * reading.teeth
    return max(reading.period, 1.0 / reading.spindle_speed)
