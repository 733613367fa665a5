"""A run under control as JSON. Keys carry their units and are fixed: others parse them."""

from typing import Any

from service.control.facts import Row, disturbed, exceeded, rows, whole
from service.control.run import ControlRun
from service.wire import dump, finding_json
from stepnc_model.units import mm_min_from_speed


def control_json(run: ControlRun) -> str:
    """The run, each workingstep, and all that happened."""
    found = rows(run)
    return dump({
        "program": run.plan.program,
        "machine": run.machine.name,
        "material": run.material.material.name,
        "law": run.law.value,
        "look_ahead_revolutions": run.aims.look_ahead if run.has_preview else None,
        "mode": run.criterion.value,
        "override_band": [run.aims.band.floor, run.aims.band.ceiling],
        "seed": run.seed,
        "is_stopped": run.is_stopped,
        "samples": run.samples,
        "workingsteps": [
            {
                "id": row.id,
                "begin_s": row.begin,
                **_numbers(row),
                "bound_there_n": row.set_point,
                "set_point_by": row.bound or None,
                "held_by": dict(row.shares),
                "inhibition": row.inhibition or None,
                "kc_factor": _factor(row),
            }
            for row in found
        ],
        "total": {"program_time_s": run.time_planned, **_numbers(whole(run))},
        "disturbances": [
            {"word": word, "has_come": has_come} for word, has_come in disturbed(run)
        ],
        "events": [
            {"time_s": event.time, "kind": event.kind.value, "text": event.text}
            for event in run.events
        ],
        "limits_exceeded": list(exceeded(run, found)),
        "findings": [finding_json(finding) for finding in run.findings],
    })


def _numbers(row: Row) -> dict[str, Any]:
    """One workingstep or the whole run."""
    record = row.record
    least, greatest = row.override_range
    return {
        "time_s": {"programmed": row.planned, "actual": record.time},
        "cutting_time_s": record.cutting_time,
        "revolutions": {"with_chips": record.revolutions, "without_force": record.lost},
        "mean_feed_mm_min": mm_min_from_speed(record.feed),
        "override": {"mean": record.override, "least": least, "greatest": greatest},
        "force_n": {"mean": record.force, "nearest_to_bound": record.peak},
        "over_set_point_s": record.over_time,
        "excess_impulse_n_s": record.excess,
        "holds": row.holds,
    }


def _factor(row: Row) -> dict[str, Any] | None:
    """Measured over catalogue k_c."""
    if row.factor is None:
        return None
    value, deviation = row.factor
    readings = row.record.ratio.readings
    return {"value": value, "deviation": deviation, "readings": readings}
