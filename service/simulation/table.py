"""A simulated run as a table on a terminal."""

from service.simulation.carbon import WORLD, CarbonFactor, kilowatt_hours
from service.simulation.facts import components, exceeded, ratio, rows
from service.simulation.run import Simulation
from service.tables import print_findings, print_line, print_table
from simulator.machine.totals import Total
from stepnc_model.units import kw_from_watts

RED = "31"
"""ANSI colour of what exceeds a limit"""


def print_simulation(simulation: Simulation, *, carbon: CarbonFactor = WORLD) -> None:
    """A row for each workingstep, totals, energy by component, limits exceeded, findings."""
    machine = simulation.machine
    print_line(
        f"{simulation.program}: machine {machine.name} ({machine.title}), "
        f"control {simulation.control.value}"
    )
    header = (
        "workingstep", "time s", "cutting", "air", "rapid", "waiting", "energy kJ",
        "spindle kW", "force N", "bent µm", "removed cm³",
    )  # fmt: skip
    found = rows(simulation)
    body = [(row.name, *_numbers(row.total)) for row in found]
    print_table(header, [*body, ("total", *_numbers(simulation.whole))])
    _print_energy(simulation.whole, carbon)
    for text in exceeded(simulation, found):
        print_line(f"limit exceeded: {text}", RED)
    print_findings(simulation.findings)


def _numbers(total: Total) -> tuple[str, ...]:
    """Of one workingstep or of all."""
    return (
        f"{total.duration:.1f}",
        f"{total.cutting_time:.1f}",
        f"{total.air_time:.1f}",
        f"{total.rapid_time:.1f}",
        f"{total.waiting_time:.1f}",
        f"{total.energy.total * 1e-3:.1f}",
        f"{kw_from_watts(total.power.value):.2f}",
        f"{total.force.value:.0f}",
        f"{total.deflection.value * 1e3:.1f}",
        f"{total.volume * 1e-3:.2f}",
    )


def _print_energy(whole: Total, carbon: CarbonFactor) -> None:
    """Shares of the components, and what else follows from energy."""
    energy = whole.energy.total
    shares = ", ".join(
        f"{name} {ratio(part, energy):.1%}" for name, part in components(whole.energy) if part
    )
    print_line(f"energy {kilowatt_hours(energy):.4g} kWh: {shares}")
    print_line(
        f"carbon {carbon.grams(energy):.4g} g CO₂ at {carbon.grams_per_kwh:g} g/kWh "
        f"({carbon.source})"
    )
    if whole.volume:
        print_line(
            f"removal {ratio(whole.volume, whole.duration) * 0.06:.3g} cm³/min on average; "
            f"{ratio(energy, whole.volume):.3g} J/mm³ from the mains, "
            f"{ratio(whole.cutting_energy, whole.volume):.3g} J/mm³ at the edge"
        )
