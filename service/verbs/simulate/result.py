"""A simulated run as text, JSON and one self-contained HTML page; equal runs give equal bytes.

JSON keys carry their units and never change, because other programs read them.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import TYPE_CHECKING, Any

from service.errors import BAD_INPUT, LIMIT_EXCEEDED, OK
from service.rendering.columns import Column, record
from service.rendering.text import RED
from service.rendering.view import Fact, Findings, ResultView, Table, TextLine
from service.simulation.facts import COMPONENTS as NAMES
from service.simulation.facts import WORLD, CarbonFactor, SimulationRow, exceeded, ratio, rows
from service.simulation.run import Simulation
from service.verbs.result import Result
from simulator.machine.deviation import SeededDeviation
from simulator.machine.totals import Peak, Total
from stepnc_model.errors import StepNcError
from stepnc_model.units import kw_from_watts, kwh_from_joules, rpm_from_rev_s

if TYPE_CHECKING:
    import plotly.graph_objects as go

Columns = tuple[Column[SimulationRow], ...]

CM3_MIN = 0.06
"""Removal rate of 1 mm³/s, in cm³/min."""


def _of(value: Callable[[Total], Any], **about: Any) -> Column[SimulationRow]:
    """Return a column with a value of the totals."""
    return Column(value=lambda row: value(row.total), **about)


def _energy(name: str, total: Total) -> float:
    """Energy of a component, in J."""
    joules: float = getattr(total.energy, name)
    return joules


NAME: Column[SimulationRow] = Column(
    heading="workingstep", value=lambda row: row.name, is_key=True
)
ID: Column[SimulationRow] = Column(key="id", value=lambda row: row.id)
BEGIN: Column[SimulationRow] = Column(
    key="begin_s", heading="begins s", form=".1f", value=lambda row: row.begin
)
TIMES = (
    _of(lambda total: total.duration, key="time_s", heading="time s", form=".1f"),
    _of(lambda total: total.cutting_time, key="cutting_time_s", heading="cutting", form=".1f"),
    _of(lambda total: total.air_time, key="air_time_s", heading="air", form=".1f",
        help="at cutting feed without chips"),
    _of(lambda total: total.rapid_time, key="rapid_time_s", heading="rapid", form=".1f"),
    _of(lambda total: total.waiting_time, key="waiting_time_s", heading="waiting", form=".1f"),
)  # fmt: skip
COMPONENTS = tuple(
    _of(partial(_energy, name), key=f"energy_j.{name}",
        heading=heading, scale=1e-3, form=".1f")
    for name, heading in NAMES.items()
)  # fmt: skip
ENERGY = _of(lambda total: total.energy.total, key="energy_j.total", heading="energy kJ",
             scale=1e-3, form=".1f")  # fmt: skip
VOLUME = _of(lambda total: total.volume, key="volume_mm3", heading="removed cm³", scale=1e-3,
             form=".2f")  # fmt: skip


def _peak(value: Callable[[Total], Peak], name: str, unit: str, **about: Any) -> Columns:
    """Return columns with the peak of a quantity, its time and its program line."""
    return (
        _of(lambda total: value(total).value, key=f"{name}.value_{unit}", **about),
        _of(lambda total: value(total).time, key=f"{name}.time_s"),
        _of(lambda total: value(total).line, key=f"{name}.line"),
    )


POWER = _peak(lambda total: total.power, "peak_spindle_power", "w", heading="spindle kW",
              scale=1e-3, form=".2f")  # fmt: skip
FORCE = _peak(lambda total: total.force, "peak_cutting_force", "n", heading="force N",
              form=".0f")  # fmt: skip
BENT = _peak(lambda total: total.deflection, "peak_tool_deflection", "mm", heading="bent µm",
             scale=1e3, form=".1f", help="largest deflection of the tool, δ")  # fmt: skip

TEXT: Columns = (NAME, *TIMES, ENERGY, POWER[0], FORCE[0], BENT[0], VOLUME)
"""Columns of the table on a terminal."""

TOTALS: Columns = (
    *TIMES,
    _of(lambda total: total.way_time, key="way_time_s"),
    _of(lambda total: total.overload_time, key="overload_time_s"),
    *COMPONENTS,
    ENERGY,
    _of(lambda total: total.cutting_energy, key="cutting_energy_j"),
    VOLUME,
    *POWER,
    *_peak(lambda total: total.cutting_power, "peak_cutting_power", "w"),
    *_peak(lambda total: total.drive_power, "peak_drive_power", "w"),
    *FORCE,
    *_peak(lambda total: total.thrust, "peak_thrust", "n"),
    *_peak(lambda total: total.chip, "peak_chip_thickness", "mm"),
    *BENT,
)
"""Columns in JSON."""

REMOVAL: Columns = (
    NAME,
    VOLUME,
    _of(lambda total: _over(total.volume, total.cutting_time), heading="while cutting cm³/min",
        scale=CM3_MIN, form=".2f"),
    _of(lambda total: _over(total.volume, total.duration), heading="over all cm³/min",
        scale=CM3_MIN, form=".2f"),
    _of(lambda total: _over(total.energy.total, total.volume), heading="from the mains J/mm³",
        form=".2f"),
    _of(lambda total: _over(total.cutting_energy, total.volume), heading="at the edge J/mm³",
        form=".2f"),
)  # fmt: skip


def _over(part: float, whole: float) -> float | None:
    """Ratio of two numbers; None if either is zero."""
    return part / whole if part and whole else None


@dataclass(frozen=True, slots=True, kw_only=True)
class PeakRow:
    """Row of the peak table: largest value of a quantity in the whole run."""

    name: str
    peak: Peak
    form: str
    scale: float
    workingstep: str
    permitted: str | None

    @property
    def value(self) -> str:
        """Value as shown in the table."""
        return f"{self.peak.value * self.scale:{self.form}}"

    @property
    def time(self) -> float | None:
        """Time of the peak, in s; None if the quantity was always zero."""
        return self.peak.time if self.peak.value else None

    @property
    def line(self) -> int | None:
        """Program line of the peak; None if the quantity was always zero."""
        return self.peak.line if self.peak.value else None


PEAKS: tuple[Column[PeakRow], ...] = (
    Column(heading="quantity", value=lambda row: row.name),
    Column(heading="maximum", value=lambda row: row.value),
    Column(heading="at s", form=".1f", value=lambda row: row.time),
    Column(heading="line", value=lambda row: row.line),
    Column(heading="workingstep", value=lambda row: row.workingstep),
    Column(heading="limit of the machine", value=lambda row: row.permitted),
)


def whole_row(simulation: Simulation) -> SimulationRow:
    """Row of the whole run."""
    return SimulationRow(id="total", begin=nan, total=simulation.whole)


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulateResult(Result):
    """A simulated run, with the carbon factor of its energy."""

    simulation: Simulation
    carbon: CarbonFactor = WORLD

    @property
    def exit_code(self) -> int:
        """Exit code: 3 where workingsteps were left out, 5 for overloads and collisions."""
        if self.simulation.faults:
            return BAD_INPUT
        is_exceeded = self.simulation.whole.overload_time > 0.0
        return LIMIT_EXCEEDED if is_exceeded or self.simulation.collisions else OK

    def view(self) -> ResultView:
        """Return time, energy, peaks and removal of the run and of each workingstep."""
        simulation = self.simulation
        machine, found, whole = simulation.machine, rows(simulation), simulation.whole
        red = [str(fault) for fault in simulation.collisions]
        red += [f"limit exceeded: {text}" for text in exceeded(simulation, found)]
        return ResultView([
            *(TextLine(text=text, colour=RED) for text in red),
            TextLine(
                text=f"{simulation.program}: machine {machine.name} ({machine.title}), "
                f"control {simulation.control.value}"
            ),
            Fact(key="program", value=simulation.program),
            Fact(key="machine", value=machine.name),
            Fact(key="control", value=simulation.control.value),
            Fact(key="samples", value=simulation.samples),
            Table(key="workingsteps", columns=(ID, BEGIN, *TOTALS), rows=found, is_shown=False),
            Table(columns=TEXT, rows=(*found, whole_row(simulation))),
            Fact(key="total", value=record(TOTALS, whole_row(simulation))),
            Fact(key="power_deviation", value=_deviation_record(simulation.deviation)),
            Fact(
                key="carbon",
                value={
                    "factor_g_kwh": self.carbon.grams_per_kwh,
                    "source": self.carbon.source,
                    "total_g": self.carbon.grams(whole.energy.total),
                },
            ),
            *(TextLine(text=text) for text in self._energies()),
            Fact(key="left_out", value=[str(fault) for fault in simulation.faults]),
            Findings(
                findings=simulation.findings,
                reported=(*simulation.reported, *simulation.collisions),
            ),
        ])

    def _energies(self) -> Iterator[str]:
        """Yield sentences on energy, carbon, removal and deviation."""
        simulation, whole = self.simulation, self.simulation.whole
        energy, carbon = whole.energy.total, self.carbon
        shares = ", ".join(
            f"{heading} {ratio(getattr(whole.energy, name), energy):.1%}"
            for name, heading in NAMES.items()
            if getattr(whole.energy, name)
        )
        yield f"energy {kwh_from_joules(energy):.4g} kWh: {shares}"
        yield (
            f"carbon {carbon.grams(energy):.4g} g CO₂ at {carbon.grams_per_kwh:g} g/kWh "
            f"({carbon.source})"
        )
        if whole.volume:
            yield (
                f"removal {ratio(whole.volume, whole.duration) * CM3_MIN:.3g} cm³/min on "
                f"average; {ratio(energy, whole.volume):.3g} J/mm³ from the mains, "
                f"{ratio(whole.cutting_energy, whole.volume):.3g} J/mm³ at the edge"
            )
        if simulation.deviation is not None:
            yield _deviation(simulation.deviation)

    def figures(self) -> "list[go.Figure]":
        """Return powers, feed, force and removal over time, if the run kept its signals."""
        from service.simulation.figures import run_figure  # noqa: PLC0415 (plotly)

        trace = self.simulation.trace
        return [] if trace is None else [run_figure(rows(self.simulation), trace)]

    def page(self) -> str:
        """Return the HTML report.

        Raises
        ------
        StepNcError
            When the run kept no signals: it was run without a report.
        """
        from service.rendering.pages import plot, rendered  # noqa: PLC0415 (Jinja)

        simulation, trace = self.simulation, self.simulation.trace
        if trace is None:
            raise StepNcError("the run kept no signals: name a report when it is run")
        found, whole = rows(simulation), simulation.whole
        energy, carbon = whole.energy.total, self.carbon
        return rendered(
            "simulation.html.jinja",
            simulation=simulation,
            material=simulation.material,
            carbon=carbon,
            rows=found,
            whole=whole_row(simulation),
            exceeded=exceeded(simulation, found),
            figure=plot(self.plot(), "run"),
            width=trace.width,
            energy_kwh=kwh_from_joules(energy),
            mean_power=kw_from_watts(ratio(energy, whole.duration)),
            cutting_share=ratio(whole.cutting_time, whole.duration),
            times=(NAME, BEGIN, *TIMES),
            time_shares=_shares(TIMES, simulation, whole.duration),
            energies=(NAME, *COMPONENTS, ENERGY, *_carbon(carbon, energy)),
            energy_shares=_shares((*COMPONENTS, ENERGY), simulation, energy),
            removal=REMOVAL,
            peaks=PEAKS,
            peak_rows=_peak_rows(simulation, found),
        )


def _deviation_record(seeded: SeededDeviation | None) -> dict[str, Any] | None:
    """Return the random deviation of a run as a JSON object."""
    if seeded is None:
        return None
    return {
        "feed": seeded.deviation.feed,
        "traverse": seeded.deviation.traverse,
        "seed": seeded.seed,
    }


def _deviation(seeded: SeededDeviation) -> str:
    """Describe the random deviation of a run."""
    feed, traverse = seeded.deviation.feed, seeded.deviation.traverse
    return (
        f"motor power of each movement deviates by up to ±{100.0 * feed:g} % in feed and "
        f"±{100.0 * traverse:g} % in rapid, seed {seeded.seed}"
    )


def _shares(columns: Columns, simulation: Simulation, whole: float) -> list[str]:
    """Return the shares of the columns in the whole run, as text."""
    values = (column.value(whole_row(simulation)) for column in columns)
    return [
        f"{ratio(float(each), whole):.1%}" for each in values if isinstance(each, float | int)
    ]


def _carbon(carbon: CarbonFactor, whole: float) -> Columns:
    """Return columns derived from energy: share, kWh and carbon dioxide."""
    return (
        _of(lambda total: 100.0 * ratio(total.energy.total, whole), heading="share %",
            form=".1f"),
        _of(lambda total: kwh_from_joules(total.energy.total), heading="kWh", form=".4f"),
        _of(lambda total: carbon.grams(total.energy.total), heading="g CO₂", form=".2f"),
    )  # fmt: skip


def _peak_rows(simulation: Simulation, rows: Sequence[SimulationRow]) -> list[PeakRow]:
    """Return the peaks, their workingsteps, and the limits of the machine."""
    whole, machine = simulation.whole, simulation.machine
    best = max(machine.spindle.curve, key=lambda point: point.power)
    power = f"{kw_from_watts(best.power):g} kW at {rpm_from_rev_s(best.speed):.0f} rpm"
    bound = machine.max_cutting_force
    force = None if bound is None else f"{bound:.0f} N"
    return [
        PeakRow(
            name=name,
            peak=peak,
            form=form,
            scale=scale,
            workingstep=next((row.name for row in reversed(rows) if row.begin <= peak.time), "")
            if peak.value
            else "",
            permitted=permitted,
        )
        for name, peak, form, scale, permitted in (
            ("spindle power, kW", whole.power, ".2f", 1e-3, power),
            ("cutting force, N", whole.force, ".0f", 1.0, force),
            ("mean chip thickness, mm", whole.chip, ".3f", 1.0, None),
        )
    ]
