"""Status snapshot of a session, and its JSON: names with their units."""

from dataclasses import asdict, dataclass
from enum import Enum
from typing import Any

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
"""names that are canonical inside"""


@dataclass(frozen=True, slots=True, kw_only=True)
class SessionStatus:
    """What programs and trial cuts have in common."""

    time: float
    """s"""
    feed_programmed_mm_min: float
    feed_advised_mm_min: float
    """that the loop commands"""
    feed_actual_mm_min: float
    override_percent: float
    """commanded"""
    force_measured: float | None
    """N, mean of the last revolution; None: there was none"""
    set_point: float | None
    """N; None: nothing bounds the force, or it is not known yet"""
    power_kw: float
    """that the main drive really draws"""
    motor_power_kw: float | None
    """that the motor gives now, as far as the operator allows; None: the spindle stands"""
    removal_rate_cm3_min: float
    """that really is removed"""
    is_overloaded: bool
    """power limit warning: the drive draws more than the motor has, or did a second ago"""
    holding: str
    """what holds the feed now"""
    level: str
    """of the force, as the loop sees it"""
    criterion: Criterion
    is_on: bool
    is_stopped: bool
    """the loop has stopped the run, or lost the machine"""

    def as_json(self) -> dict[str, Any]:
        """Values by names that carry their units."""
        return {UNITS.get(name, name): _plain(value) for name, value in asdict(self).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return value
