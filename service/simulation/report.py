"""One self-contained HTML page for a simulated run: same run, same bytes."""

from collections.abc import Sequence
from html import escape

from service.buckets import Trace
from service.page import bullets, clock, headline, page, plot, table
from service.simulation.carbon import WORLD, CarbonFactor, kilowatt_hours
from service.simulation.facts import Row, components, exceeded, ratio, rows
from service.simulation.figures import run_figure
from service.simulation.run import Simulation
from simulator.machine.totals import Peak, Total
from simulator.spec import MaterialMatch
from stepnc_model.units import kw_from_watts, rpm_from_rev_s


def simulation_page(
    simulation: Simulation,
    trace: Trace,
    *,
    material: MaterialMatch | None = None,
    carbon: CarbonFactor = WORLD,
) -> str:
    """The page as HTML.

    Parameters
    ----------
    simulation : Simulation
    trace : Trace
        Of the same run.
    material : MaterialMatch, optional
        None: not known.
    carbon : CarbonFactor

    Returns
    -------
    str
    """
    found = rows(simulation)
    machine = simulation.machine
    body = f"""<h1>{escape(simulation.program)}</h1>
<p class="sub">simulated on {escape(machine.title)} ({escape(machine.name)}) ·
 control {escape(simulation.control.value)} ·
 {escape(material.reason if material else "material not known")}</p>
{_first(simulation.whole, carbon)}
<h2>Limits exceeded</h2>{_limits(simulation, found)}
<h2>The run</h2>
{plot(run_figure(found, trace), "run")}
<p class="sub">{escape(_resolution(trace))}</p>
<h2>Time, s</h2>{_times(found, simulation.whole)}
<h2>Energy, kJ</h2>{_energies(found, simulation.whole, carbon)}
<p class="sub">carbon by {carbon.grams_per_kwh:g} g CO₂/kWh: {escape(carbon.source)}</p>
<h2>Removal</h2>{_removal(found, simulation.whole)}
<h2>Peaks</h2>{_peaks(simulation, found)}
<h2>Findings</h2>{_findings(simulation)}"""
    return page(f"{simulation.program} on {machine.name}", body)


def _first(whole: Total, carbon: CarbonFactor) -> str:
    """The numbers that are looked at first."""
    energy = whole.energy.total
    facts = (
        ("time", clock(whole.duration)),
        ("with chips", f"{ratio(whole.cutting_time, whole.duration):.0%}"),
        ("energy", f"{kilowatt_hours(energy):.3g} kWh"),
        ("carbon", f"{carbon.grams(energy):.3g} g CO₂"),
        ("mean power", f"{kw_from_watts(ratio(energy, whole.duration)):.3g} kW"),
        ("removed", f"{whole.volume * 1e-3:.4g} cm³"),
    )
    return headline(facts)


def _limits(simulation: Simulation, found: Sequence[Row]) -> str:
    return bullets(("bad", text) for text in exceeded(simulation, found))


def _resolution(trace: Trace) -> str:
    """What one point of the plots stands for."""
    return (
        f"One point of the plots stands for {trace.width:.2g} s or less: stacked powers show "
        "its mean, lines its least and greatest sample. Drag to look closer, double-click to "
        "come back."
    )


def _times(found: Sequence[Row], whole: Total) -> str:
    heads = ("workingstep", "begins", "whole", "cutting", "air at feed", "rapid", "waiting")
    body = [(row.name, f"{row.begin:.1f}", *_split(row.total)) for row in found]
    shares = [_share(part, whole.duration) for part in _seconds(whole)]
    return table(heads, body, (("total", "", *_split(whole)), ("share", "", *shares)))


def _split(total: Total) -> tuple[str, ...]:
    return tuple(f"{part:.1f}" for part in _seconds(total))


def _seconds(total: Total) -> tuple[float, ...]:
    return (
        total.duration, total.cutting_time, total.air_time, total.rapid_time,
        total.waiting_time,
    )  # fmt: skip


def _energies(found: Sequence[Row], whole: Total, carbon: CarbonFactor) -> str:
    names = [name for name, _ in components(whole.energy)]
    energy = whole.energy.total
    heads = ("workingstep", *names, "all", "share", "kWh", "g CO₂")
    body = [(row.name, *_joules(row.total, energy, carbon)) for row in found]
    shares = [_share(part, energy) for _, part in components(whole.energy)]
    foot = (
        ("total", *_joules(whole, energy, carbon)),
        ("share", *shares, *(_share(energy, energy), "", "", "")),
    )
    return table(heads, body, foot)


def _joules(total: Total, whole: float, carbon: CarbonFactor) -> tuple[str, ...]:
    energy = total.energy.total
    parts = [f"{part * 1e-3:.1f}" for _, part in components(total.energy)]
    return (
        *parts, f"{energy * 1e-3:.1f}", _share(energy, whole),
        f"{kilowatt_hours(energy):.4f}", f"{carbon.grams(energy):.2f}",
    )  # fmt: skip


def _share(part: float, whole: float) -> str:
    return f"{ratio(part, whole):.1%}"


def _removal(found: Sequence[Row], whole: Total) -> str:
    heads = (
        "workingstep", "removed cm³", "while cutting cm³/min", "over all cm³/min",
        "from the mains J/mm³", "at the edge J/mm³",
    )  # fmt: skip
    body = [(row.name, *_removed(row.total)) for row in found]
    return table(heads, body, (("total", *_removed(whole)),))


def _removed(total: Total) -> tuple[str, ...]:
    """Volume, mean rates and specific energies."""
    if not total.volume:
        return ("0", *["–"] * 4)
    return (
        f"{total.volume * 1e-3:.2f}",
        f"{ratio(total.volume, total.cutting_time) * 0.06:.2f}",
        f"{ratio(total.volume, total.duration) * 0.06:.2f}",
        f"{ratio(total.energy.total, total.volume):.2f}",
        f"{ratio(total.cutting_energy, total.volume):.2f}",
    )


def _peaks(simulation: Simulation, found: Sequence[Row]) -> str:
    """Greatest values, where they stand, and what the machine permits."""
    whole, machine = simulation.whole, simulation.machine
    best = max(machine.spindle.curve, key=lambda point: point.power)
    power = f"{kw_from_watts(best.power):g} kW at {rpm_from_rev_s(best.speed):.0f} rpm"
    force = machine.max_cutting_force
    heads = ("", "greatest", "at s", "line", "workingstep", "the machine permits at most")
    body = (
        (
            "spindle power, kW",
            f"{kw_from_watts(whole.power.value):.2f}",
            *_place(whole.power, found),
            power,
        ),
        (
            "cutting force, N",
            f"{whole.force.value:.0f}",
            *_place(whole.force, found),
            "–" if force is None else f"{force:.0f} N",
        ),
        ("mean chip thickness, mm", f"{whole.chip.value:.3f}", *_place(whole.chip, found), "–"),
    )
    return table(heads, body, ())


def _place(peak: Peak, found: Sequence[Row]) -> tuple[str, str, str]:
    """Time, line and workingstep."""
    if not peak.value:
        return "–", "–", "–"
    name = next((row.name for row in reversed(found) if row.begin <= peak.time), "")
    return f"{peak.time:.1f}", str(peak.line), name


def _findings(simulation: Simulation) -> str:
    """All findings, equal ones once."""
    unique = {str(finding): finding.severity.value for finding in simulation.findings}
    return bullets((severity, text) for text, severity in unique.items())
