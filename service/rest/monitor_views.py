"""Response bodies of the monitors, from their snapshots."""

from math import isnan
from typing import Any

from service.monitor.monitor import MonitorStatus
from service.monitor.observed_run import Comparison, ObservedRun, StepComparison
from service.rest.replies import moment


def monitor_view(status: MonitorStatus) -> dict[str, Any]:
    """Return a status as a :class:`service.rest.views.MonitorView`."""
    return {
        "name": status.source.name,
        "url": status.source.url,
        "state": status.state.value,
        "problem": status.problem or None,
        "freshness": status.freshness.value,
        "age_s": _known(status.age, 1),
        "stale_after_s": round(status.stale_after, 1),
        "availability": status.availability,
        "execution": status.execution,
        "program": status.program,
        "workingstep": status.workingstep,
    }


def status_view(status: MonitorStatus) -> dict[str, Any]:
    """Return a status as a :class:`service.rest.views.MonitorStatusView`."""
    return {
        **monitor_view(status),
        "time_zero": moment(status.origin),
        "rows": status.rows,
        "workingsteps": status.workingsteps,
        "latest": {name: _known(value) for name, value in status.latest.items()},
        "run": None if status.run is None else _run_view(status.run),
    }


def _run_view(run: ObservedRun) -> dict[str, Any]:
    return {
        "program": run.program,
        "begin_s": run.begin,
        "is_running": run.is_running,
        "workingsteps": [
            {
                "id": step.id,
                "begin_s": step.begin,
                "time_s": _known(step.time),
                "energy_j": _known(step.energy, 3),
                "is_running": step.is_running,
                "is_whole": step.is_whole,
            }
            for step in run.steps
        ],
    }


def comparison_view(comparison: Comparison) -> dict[str, Any]:
    """Return a comparison as the last fields of a ``ComparisonView``."""
    return {
        "workingsteps": [_step_view(step) for step in comparison.steps],
        "done": _step_view(comparison.done),
        "parts": [
            {
                "begin_s": _known(part.begin),
                "end_s": _known(part.end),
                "shift_s": _known(part.shift),
            }
            for part in comparison.parts
        ],
    }


def _step_view(step: StepComparison) -> dict[str, Any]:
    return {
        "id": step.id,
        "state": step.state.value,
        "measured_time_s": _known(step.measured_time),
        "predicted_time_s": _known(step.predicted_time),
        "time_ratio": _known(step.time_ratio),
        "measured_energy_j": _known(step.measured_energy, 3),
        "predicted_energy_j": _known(step.predicted_energy, 3),
        "energy_ratio": _known(step.energy_ratio),
    }


def _known(value: float | None, digits: int = 6) -> float | None:
    """Return a rounded number; None if it is not known."""
    return None if value is None or isnan(value) else round(value, digits)
