"""Rows and events of a live session, and their conversion to columns of files.

Includes the "Power Limit Warning" of [1]_: on while the main drive draws more than the motor
can deliver. Running state. Units s, W.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, "Optimal results" and Fig. 9.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isnan
from typing import NamedTuple

import numpy as np

from controller.orders import EventKind, LoopEvent
from controller.record import EXCESS_RATIO
from simulator.motion.segments import Floats
from stepnc_model.units import kw_from_watts, mm_min_from_speed


class Moment(NamedTuple):
    """Values of a run at one time; NaN where a value is unknown or does not exist."""

    time: float
    progress: float
    workingstep: str
    x: float
    y: float
    z: float
    feed_programmed: float
    feed_actual: float
    override_commanded: float
    override_actual: float
    set_point: float
    force_measured: float
    force_peak: float
    force_true: float
    force_expected: float
    force_ratio: float
    tooth_passing: float
    once_per_revolution: float
    spindle_power: float
    spindle_power_true: float
    removal_rate: float
    axial_depth: float
    flank_wear: float
    level: str
    holding: str
    event: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RunUpdate:
    """Rows and events since the last call, ascending in time."""

    moments: tuple[Moment, ...] = ()
    """Rows, one for each revolution or quarter of a second."""
    events: tuple[LoopEvent, ...] = ()

    @property
    def rows(self) -> Floats:
        """Rows in the units of the columns, (M, C)."""
        return rows_of(self.moments)


LIT = 1.0
"""Shortest time for which the power warning stays on, in s, so that it can be seen."""

CM3_MIN = 0.06
"""Removal rate of 1 mm³/s, in cm³/min."""


class LiveRows:
    """Collects rows and events, as the sink of a trace. Running state.

    Parameters
    ----------
    motor_power : callable
        Function that returns the power that the motor can deliver now, in W.
    """

    def __init__(self, motor_power: Callable[[], float]) -> None:
        self.last: Moment | None = None
        """Latest row."""
        self._motor_power = motor_power
        self._moments: list[Moment] = []
        self._events: list[LoopEvent] = []
        self._lit_until = -inf
        self._is_lit = False

    def __call__(self, moment: Moment) -> None:
        """Add a row, and an event when the power warning changes."""
        self._moments.append(moment)
        self.last = moment
        power, motor = moment.spindle_power_true, self._motor_power()
        if power > EXCESS_RATIO * motor:
            self._lit_until = moment.time + LIT
        if self.is_overloaded(moment.time) is not self._is_lit:
            self._is_lit = not self._is_lit
            self.note(_change(moment.time, power, motor, is_lit=self._is_lit))

    def note(self, event: LoopEvent) -> None:
        """Add an event."""
        self._events.append(event)

    def is_overloaded(self, time: float) -> bool:
        """Whether the drive exceeds the motor power, or did within the last second."""
        return time < self._lit_until

    def taken(self) -> RunUpdate:
        """Return rows and events since the last call, and clear them."""
        taken = RunUpdate(moments=tuple(self._moments), events=tuple(self._events))
        self._moments.clear()
        self._events.clear()
        return taken


def _change(time: float, power: float, motor: float, *, is_lit: bool) -> LoopEvent:
    """Return the event for a change of the power warning."""
    draws, has = f"{kw_from_watts(power):.3g} kW", f"{kw_from_watts(motor):.3g} kW"
    if is_lit:
        text = f"power limit: the drive draws {draws}, the motor delivers {has}"
        return LoopEvent(time=time, kind=EventKind.OVER, text=text)
    text = f"power limit: for {LIT:g} s at most {EXCESS_RATIO - 1.0:.0%} above {has}"
    return LoopEvent(time=time, kind=EventKind.SAFE, text=text)


def known(value: float) -> float | None:
    """Return a number of a row, or None where it is NaN."""
    return None if isnan(value) else value


FEED, RATE = mm_min_from_speed(1.0), 0.001 * mm_min_from_speed(1.0)
"""Feed of 1 mm/s in mm/min, and removal rate of 1 mm³/s in cm³/min."""

PER_CENT = 100.0

COLUMNS: Mapping[str, tuple[str, float]] = {
    "time_s": ("time", 1.0),
    "progress_s": ("progress", 1.0),
    "x_mm": ("x", 1.0),
    "y_mm": ("y", 1.0),
    "z_mm": ("z", 1.0),
    "feed_programmed_mm_min": ("feed_programmed", FEED),
    "feed_actual_mm_min": ("feed_actual", FEED),
    "override_commanded_percent": ("override_commanded", PER_CENT),
    "override_actual_percent": ("override_actual", PER_CENT),
    "force_set_point_n": ("set_point", 1.0),
    "force_measured_n": ("force_measured", 1.0),
    "force_expected_n": ("force_expected", 1.0),
    "force_true_n": ("force_true", 1.0),
    "force_ratio": ("force_ratio", 1.0),
    "spindle_power_w": ("spindle_power", 1.0),
    "spindle_power_true_w": ("spindle_power_true", 1.0),
    "removal_rate_cm3_min": ("removal_rate", RATE),
    "axial_depth_mm": ("axial_depth", 1.0),
    "flank_wear_mm": ("flank_wear", 1.0),
}
"""Columns in files: attribute of :class:`Moment` and factor from internal units."""

_PLACES = [Moment._fields.index(name) for name, _ in COLUMNS.values()]
_SCALES = np.array([scale for _, scale in COLUMNS.values()])


def rows_of(moments: Sequence[Moment]) -> Floats:
    """Return moments as an array of rows, (M, C), in the units of the columns."""
    rows = [[moment[place] for place in _PLACES] for moment in moments]
    values: Floats = np.array(rows, dtype=np.float64).reshape(-1, len(_PLACES)) * _SCALES
    return values
