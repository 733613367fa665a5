"""Figures of a simulated run for table, page and JSON. Units s, J, W, N, mm³."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.simulation.run import Simulation
from simulator.machine.totals import Total


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRow:
    """One workingstep, or what comes before them all."""

    id: str | None
    """None: before the first workingstep, or in a program without any"""
    begin: float
    """Begin, s from the start of the program; not a number for the whole run"""
    total: Total

    @property
    def name(self) -> str:
        """Name of the row in a table."""
        return "outside workingsteps" if self.id is None else self.id


def rows(simulation: Simulation) -> tuple[SimulationRow, ...]:
    """The run's workingsteps in their order; what comes before them only if it takes time."""
    found: list[SimulationRow] = []
    now = 0.0
    for number, (name, total) in enumerate(simulation.totals):
        if number or total.duration > 0.0:
            found.append(SimulationRow(id=name if number else None, begin=now, total=total))
        now += total.duration
    return tuple(found)


COMPONENTS = {
    "x_axis": "X axis",
    "y_axis": "Y axis",
    "z_axis": "Z axis",
    "spindle": "spindle",
    "coolant": "coolant",
    "base": "base load",
}
"""headings of the components of energy, by their names"""


def ratio(part: float, whole: float) -> float:
    """Part over whole; 0 of nothing."""
    return part / whole if whole else 0.0


def exceeded(simulation: Simulation, found: Sequence[SimulationRow]) -> tuple[str, ...]:
    """A sentence for each workingstep that was above a limit."""
    return tuple(
        f"{row.name}: {row.total.overload_time:.3g} s above {_limits(simulation)}"
        for row in found
        if row.total.overload_time > 0.0
    )


def _limits(simulation: Simulation) -> str:
    force = simulation.machine.max_cutting_force
    drive = "the spindle drive's continuous power"
    return drive if force is None else f"{drive} or the permitted force of {force:.0f} N"
