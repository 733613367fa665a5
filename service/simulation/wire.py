"""A simulated run as JSON. Keys carry their units and are fixed: others parse them."""

from dataclasses import asdict
from typing import Any

from service.simulation.carbon import WORLD, CarbonFactor
from service.simulation.facts import Row, rows
from service.simulation.run import Simulation
from service.wire import dump, finding_json
from simulator.machine.totals import Peak, Total


def simulation_json(simulation: Simulation, *, carbon: CarbonFactor = WORLD) -> str:
    """Time, energy, peaks and removal of the run and of each workingstep."""
    whole = simulation.whole
    return dump({
        "program": simulation.program,
        "machine": simulation.machine.name,
        "control": simulation.control.value,
        "samples": simulation.samples,
        "workingsteps": [_row(row) for row in rows(simulation)],
        "total": _total(whole),
        "carbon": {
            "factor_g_kwh": carbon.grams_per_kwh,
            "source": carbon.source,
            "total_g": carbon.grams(whole.energy.total),
        },
        "findings": [finding_json(finding) for finding in simulation.findings],
    })


def _row(row: Row) -> dict[str, Any]:
    """One workingstep; what comes before them has no id."""
    return {"id": row.id, "begin_s": row.begin, **_total(row.total)}


def _total(total: Total) -> dict[str, Any]:
    """One workingstep or the whole run."""
    return {
        "time_s": total.duration,
        "cutting_time_s": total.cutting_time,
        "air_time_s": total.air_time,
        "rapid_time_s": total.rapid_time,
        "waiting_time_s": total.waiting_time,
        "way_time_s": total.way_time,
        "overload_time_s": total.overload_time,
        "energy_j": {**asdict(total.energy), "total": total.energy.total},
        "cutting_energy_j": total.cutting_energy,
        "volume_mm3": total.volume,
        "peak_spindle_power": _peak(total.power, "w"),
        "peak_cutting_power": _peak(total.cutting_power, "w"),
        "peak_drive_power": _peak(total.drive_power, "w"),
        "peak_cutting_force": _peak(total.force, "n"),
        "peak_thrust": _peak(total.thrust, "n"),
        "peak_chip_thickness": _peak(total.chip, "mm"),
        "peak_tool_deflection": _peak(total.deflection, "mm"),
    }


def _peak(peak: Peak, unit: str) -> dict[str, Any]:
    return {f"value_{unit}": peak.value, "time_s": peak.time, "line": peak.line}
