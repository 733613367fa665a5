"""Status snapshot of a live session, and its JSON with units in the names."""

from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any

from controller.monitor import Monitor
from controller.orders import Criterion

UNITS = {
    "time": "time_s",
    "force_predicted": "force_predicted_n",
    "force_measured": "force_measured_n",
    "force_expected": "force_expected_n",
    "set_point": "force_set_point_n",
    "specific_cutting_force": "specific_cutting_force_n_mm2",
    "progress": "progress_share",
}
"""JSON names, with units, of attributes that are in canonical units."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionStatus:
    """Status values that controlled runs and trial cuts have in common."""

    time: float
    """Machine time, in s."""
    feed_programmed_mm_min: float
    feed_advised_mm_min: float
    """Feed advised by the force loop, in mm/min."""
    feed_actual_mm_min: float
    override_percent: float
    """Commanded override, in per cent."""
    force_measured: float | None
    """Mean force of the last revolution, in N; None if there was none."""
    set_point: float | None
    """Force set point, in N; None if the force is not bounded, or not known yet."""
    power_kw: float
    """True power that the main drive draws, in kW."""
    motor_power_kw: float | None
    """Power available from the motor, in kW, as limited by the operator; None at standstill."""
    removal_rate_cm3_min: float
    """True material removal rate, in cm³/min."""
    is_overloaded: bool
    """Power warning: the drive draws more than the motor delivers, or did a second ago."""
    over_set_point_percent: float | None
    """Mean force over its set point, in per cent, while it is above it; else None."""
    over_set_point_s: float
    """Time for which the force has been above its set point without a break, in s."""
    is_override_followed: bool
    """Whether the axes run the commanded override."""
    holding: str
    """What limits the feed now."""
    level: str
    """Level of the force, as the loop sees it."""
    criterion: Criterion
    is_on: bool
    is_stopped: bool
    """Whether the loop has stopped the run, or lost the machine."""

    def as_json(self) -> dict[str, Any]:
        """Return the values by names that carry their units."""
        return {UNITS.get(name, name): _plain(value) for name, value in asdict(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return value


def over_percent(monitor: Monitor) -> float | None:
    """Return the mean force over its set point, in per cent; None if it is not above it."""
    return 100.0 * monitor.share if monitor.over.is_lasting else None


def over_seconds(monitor: Monitor) -> float:
    """Return for how long the force has been above its set point, in s."""
    return monitor.over.seconds if monitor.over.is_lasting else 0.0
