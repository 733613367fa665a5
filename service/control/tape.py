"""The rows of a run until somebody takes them, and the lamp of its power limit.

The "Power Limit Warning" of [1]_: over while the main drive draws more than the motor has.
Running state. Units s, W.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Optimal results" and Fig. 9.
"""

from collections.abc import Callable
from math import inf, isnan

from controller.orders import Event, EventKind
from controller.record import OVER
from service.control.live_run import Taken
from service.control.trace import Moment
from stepnc_model.units import kw_from_watts

LIT = 1.0
"""s for which the lamp is lit at least: what is shorter nobody sees"""

CM3_MIN = 0.06
"""cm³/min in a mm³/s"""


class Tape:
    """Takes rows and events. Running state; it is the sink of a trace.

    Parameters
    ----------
    motor_power : callable
        W that the motor has now.
    """

    def __init__(self, motor_power: Callable[[], float]) -> None:
        self.last: Moment | None = None
        """row"""
        self._motor_power = motor_power
        self._moments: list[Moment] = []
        self._events: list[Event] = []
        self._lit_until = -inf
        self._is_lit = False

    def __call__(self, moment: Moment) -> None:
        """One more row."""
        self._moments.append(moment)
        self.last = moment
        power, motor = moment.spindle_power_true, self._motor_power()
        if power > OVER * motor:
            self._lit_until = moment.time + LIT
        if self.is_over(moment.time) is not self._is_lit:
            self._is_lit = not self._is_lit
            self.note(_change(moment.time, power, motor, is_lit=self._is_lit))

    def note(self, event: Event) -> None:
        """One more event."""
        self._events.append(event)

    def is_over(self, time: float) -> bool:
        """Whether the drive draws more than the motor has, or did a moment ago."""
        return time < self._lit_until

    def taken(self) -> Taken:
        """What came since it was asked last."""
        taken = Taken(moments=tuple(self._moments), events=tuple(self._events))
        self._moments.clear()
        self._events.clear()
        return taken


def _change(time: float, power: float, motor: float, *, is_lit: bool) -> Event:
    """What is said when the lamp changes."""
    draws, has = f"{kw_from_watts(power):.3g} kW", f"{kw_from_watts(motor):.3g} kW"
    if is_lit:
        text = f"power limit: the drive draws {draws}, the motor has {has}"
        return Event(time=time, kind=EventKind.OVER, text=text)
    text = f"power limit: for {LIT:g} s at most {OVER - 1.0:.0%} above {has}"
    return Event(time=time, kind=EventKind.SAFE, text=text)


def known(value: float) -> float | None:
    """A number of a row; None where it has none."""
    return None if isnan(value) else value
