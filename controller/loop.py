"""One control cycle after another: sensor, signal, state, override.

A cycle is a tooth period: within it an overload is noticed; each revolution the law decides
(:mod:`controller.loop_state`). The loop knows only its sockets, :mod:`controller.ports`; what
is plugged in may be virtual. Running state. Units mm, s, N, W, rev/s.
"""

from collections.abc import Sequence
from functools import cache
from math import nan

from controller import overload
from controller.cycle import LoopCycle
from controller.equivalent import equivalent, weighed
from controller.estimate import log_ratio
from controller.loop_settings import LoopSettings, LoopStep
from controller.loop_state import LEAST_WAY, LawFor, answered, begun, initial, obeyed
from controller.orders import Order
from controller.ports import Override, Sensor
from controller.preview import Preview
from controller.signal import Collector
from controller.source import Source
from simulator.reading import Reading

IMPLAUSIBLE = 5.0
"""times the force of chips that a force may be below zero: no cut pulls, the zero is wrong"""


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
    steps : sequence of LoopStep
        The program's workingsteps in the order of their beginning.
    preview : Preview
        What the program expects; the law is told when the settings have a look-ahead.
    settings : LoopSettings
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
        self._collector = Collector()
        self._orders: list[Order] = []

    def order(self, order: Order) -> None:
        """Something that the operator wants, from the next cycle on."""
        self._orders.append(order)

    def cycle(self) -> LoopCycle | None:
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
            self._port.set(self.state.safe)
            raise

    def _answered(self, raw: Reading) -> LoopCycle:
        """Process one reading."""
        is_new = raw.time > self.state.time
        state = self.state._replace(time=raw.time, events=())
        if raw.workingstep != state.workingstep:
            state = begun(state, raw, self._steps)
        while self._orders:
            order = self._orders.pop(0)
            state = obeyed(state, order, plain=self._plain, steps=self._steps)
        # Program time that a revolution takes at the override that is run.
        way = raw.period * raw.teeth * max(raw.override, LEAST_WAY)
        preview, least = state.preview, -IMPLAUSIBLE * state.settings.chips
        weight = preview.weight_between(raw.progress - way, raw.progress)
        is_air = preview.is_air(raw.progress, revolution=way)
        conditioned = self._source.conditioned(raw, state.step.diameter, is_air=is_air)
        reading = weighed(conditioned, weight)
        # One that comes again tells nothing.
        revolution = self._collector.add(reading) if is_new else None
        if revolution is not None and revolution.force < least:
            revolution = None
        force = overload.mean(reading.force) if is_new else nan
        expected, ratio = 0.0, None
        if revolution is not None:
            # What the catalogue's k_c gives at the override that was run.
            mean = preview.mean(revolution.progress_before, revolution.progress)
            expected = float(mean * max(revolution.override, 0.0) ** state.step.exponent)
            # Hardly a chip tells nothing of k_c.
            known = expected if expected > weight * state.settings.chips else 0.0
            ratio = log_ratio(revolution, known, expected_before=state.expected)
            state = state._replace(expected=known)
        self.state = answered(
            state,
            reading,
            revolution,
            ratio=ratio,
            force=nan if force < least else force,
            law_for=self._law_for,
        )
        self._port.set(self.state.override)
        return LoopCycle(
            reading=reading,
            allowed=self.state.allowed,
            set_point=self.state.keep.set_point,
            revolution=revolution,
            expected=expected,
            ratio=ratio,
            weight=weight,
            events=self.state.events,
        )
