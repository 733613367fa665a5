"""What table, page and JSON of a simulated run have in common. Units s, J, W, N, mm³."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.simulation.run import Simulation
from simulator.machine.totals import Energy, Total


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One workingstep, or what comes before them all."""

    id: str | None
    """None: before the first workingstep, or in a program without any"""
    begin: float
    """s from the start of the program"""
    total: Total

    @property
    def name(self) -> str:
        """What a table calls it."""
        return "outside workingsteps" if self.id is None else self.id


def rows(simulation: Simulation) -> tuple[Row, ...]:
    """The run's workingsteps in their order; what comes before them only if it takes time."""
    found: list[Row] = []
    now = 0.0
    for number, (name, total) in enumerate(simulation.totals):
        if number or total.duration > 0.0:
            found.append(Row(id=name if number else None, begin=now, total=total))
        now += total.duration
    return tuple(found)


def components(energy: Energy) -> tuple[tuple[str, float], ...]:
    """Name of each component and its energy in J."""
    return (
        ("X axis", energy.x_axis),
        ("Y axis", energy.y_axis),
        ("Z axis", energy.z_axis),
        ("spindle", energy.spindle),
        ("coolant", energy.coolant),
        ("base load", energy.base),
    )


def ratio(part: float, whole: float) -> float:
    """Part over whole; 0 of nothing."""
    return part / whole if whole else 0.0


def exceeded(simulation: Simulation, found: Sequence[Row]) -> tuple[str, ...]:
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
