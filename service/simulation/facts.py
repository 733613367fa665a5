"""Figures of a simulated run for table, page and JSON. Units s, J, W, N, mm³."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.overload_bounds import overload_bounds
from service.simulation.run import Simulation
from simulator.machine.totals import Total


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulationRow:
    """Figures of a workingstep, of the time outside workingsteps, or of the whole run."""

    id: str | None
    """Id of the workingstep; None before the first one, or in a program without any."""
    begin: float
    """Start time in the program, in s; NaN for the whole run."""
    total: Total

    @property
    def name(self) -> str:
        """Name of the row in a table."""
        return "outside workingsteps" if self.id is None else self.id


def rows(simulation: Simulation) -> tuple[SimulationRow, ...]:
    """Return the workingsteps in order; the time before them only if it is not zero."""
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
"""Headings of the energy components, by their names."""


def ratio(part: float, whole: float) -> float:
    """Return a part over a whole; 0 if the whole is zero."""
    return part / whole if whole else 0.0


def exceeded(simulation: Simulation, found: Sequence[SimulationRow]) -> tuple[str, ...]:
    """Return a sentence for each workingstep that exceeded a limit."""
    bounds = overload_bounds(simulation.machine)
    return tuple(
        f"{row.name}: {row.total.overload_time:.3g} s above {bounds}"
        for row in found
        if row.total.overload_time > 0.0
    )
