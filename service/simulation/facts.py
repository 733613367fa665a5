"""Figures of a simulated run for table, page and JSON. Units s, J, W, N, mm³.

Carbon dioxide emission of electric energy, by a stated factor. Units J, g.

References
----------
.. [1] Ember, "Global Electricity Review 2024": 480 g/kWh, world average of 2023, including the
   effects of other gases and of the construction of plants and supply of fuel.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from service.simulation.line_spans import overload_bounds
from service.simulation.run import Simulation
from simulator.machine.totals import Total
from stepnc_model.errors import StepNcError
from stepnc_model.units import kwh_from_joules


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


def exceeded(simulation: Simulation, rows: Sequence[SimulationRow]) -> tuple[str, ...]:
    """Return a sentence for each workingstep that exceeded a limit."""
    bounds = overload_bounds(simulation.machine)
    return tuple(
        f"{row.name}: {row.total.overload_time:.3g} s above {bounds}"
        for row in rows
        if row.total.overload_time > 0.0
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class CarbonFactor:
    """Carbon dioxide emission per kilowatt-hour from the mains.

    Raises
    ------
    ValueError
        When the factor is negative or not a number.
    """

    grams_per_kwh: float
    source: str

    def __post_init__(self) -> None:
        if not 0.0 <= self.grams_per_kwh < float("inf"):
            raise ValueError(f"carbon factor {self.grams_per_kwh:g} g/kWh must be at least 0")

    def grams(self, energy: float) -> float:
        """Return the carbon dioxide emission of an energy in J, in g."""
        return kwh_from_joules(energy) * self.grams_per_kwh


def stated(grams_per_kwh: float) -> CarbonFactor:
    """Build a carbon factor from a user's value.

    Raises
    ------
    StepNcError
        When the value is negative or not a number.
    """
    try:
        return CarbonFactor(grams_per_kwh=grams_per_kwh, source="as requested")
    except ValueError as error:
        raise StepNcError(str(error)) from error


WORLD = CarbonFactor(
    grams_per_kwh=480.0,
    source="Ember, Global Electricity Review 2024, world average of 2023",
)
"""World average, [1]_."""
