"""How a run under control is now, as others read it: names with their units."""

from dataclasses import asdict
from enum import Enum
from typing import Any

from service.control.live import ControlStatus
from service.trial.run import Status

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


def status_words(status: Status | ControlStatus) -> dict[str, Any]:
    """As JSON."""
    return {UNITS.get(name, name): _plain(value) for name, value in asdict(status).items()}


def _plain(value: Any) -> Any:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return value
