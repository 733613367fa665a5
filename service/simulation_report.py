"""One self-contained HTML page for a simulated run: same run, same bytes."""

from collections.abc import Iterable, Sequence
from html import escape

from plotly.offline import get_plotlyjs

from service.carbon import WORLD, CarbonFactor, kilowatt_hours
from service.simulation import Simulation
from service.simulation_facts import Row, components, exceeded, ratio, rows
from service.simulation_figures import run_figure
from service.simulation_trace import Trace
from simulator.machine.totals import Peak, Total
from simulator.spec import MaterialMatch
from stepnc_model.units import kw_from_watts, rpm_from_rev_s

STYLE = """
:root { color-scheme: light dark; --ink: #1a1a1a; --soft: #555; --paper: #fff; --rule: #ddd;
        --box: #fff; --bad: #b00020; --warn: #8a5a00; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e6; --soft: #aaa; --paper: #16181a; --rule: #3a3d40; --box: #24272a;
          --bad: #ff7b8a; --warn: #e0b050; } }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem;
       padding: 0 1rem; color: var(--ink); background: var(--paper); }
h1 { font-size: 1.5rem; margin-bottom: 0; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 2.2rem 0 .4rem; }
.sub { color: var(--soft); margin-top: .2rem; }
.figures { display: flex; gap: .8rem 2.5rem; flex-wrap: wrap; margin: 1.2rem 0; }
.figures b { display: block; font-size: 1.6rem; font-weight: 600; line-height: 1.2; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: .3rem .6rem; border-bottom: 1px solid var(--rule);
         white-space: nowrap; }
th:first-child, td:first-child, td.words, th.words { text-align: left; }
thead th, tfoot tr:first-child td { border-bottom: 2px solid var(--soft); }
tfoot { font-weight: 600; }
li.error, .bad { color: var(--bad); } li.warning { color: var(--warn); }
.js-plotly-plot text { fill: var(--ink) !important; }
.js-plotly-plot .hoverlayer .bg { fill: var(--box) !important; }
@media (max-width: 40rem) { body { margin-top: 1rem; font-size: 14px; }
  .figures b { font-size: 1.25rem; } }
"""

TOUCH = """
if (window.matchMedia("(pointer: coarse)").matches)
  Plotly.relayout("{plot_id}", {dragmode: false});
"""
"""a finger on the plot scrolls the page"""


PLOT = {
    "displaylogo": False,
    "showSendToCloud": False,
    "modeBarButtonsToRemove": ["select2d", "lasso2d"],
}
"""without the button that sends a plot to another host, which plotly.js shows by itself"""


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
    plot = run_figure(found, trace).to_html(
        full_html=False, include_plotlyjs=False, div_id="run", post_script=TOUCH,
        config=PLOT,
    )  # fmt: skip
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(f"{simulation.program} on {machine.name}")}</title><style>{STYLE}</style>
<script>{get_plotlyjs()}</script></head><body>
<h1>{escape(simulation.program)}</h1>
<p class="sub">simulated on {escape(machine.title)} ({escape(machine.name)}) ·
 control {escape(simulation.control.value)} ·
 {escape(material.reason if material else "material not known")}</p>
{_first(simulation.whole, carbon)}
<h2>Limits exceeded</h2>{_limits(simulation, found)}
<h2>The run</h2>
{plot}
<p class="sub">{escape(_resolution(trace))}</p>
<h2>Time, s</h2>{_times(found, simulation.whole)}
<h2>Energy, kJ</h2>{_energies(found, simulation.whole, carbon)}
<p class="sub">carbon by {carbon.grams_per_kwh:g} g CO₂/kWh: {escape(carbon.source)}</p>
<h2>Removal</h2>{_removal(found, simulation.whole)}
<h2>Peaks</h2>{_peaks(simulation, found)}
<h2>Findings</h2>{_findings(simulation)}
</body></html>
"""


def _first(whole: Total, carbon: CarbonFactor) -> str:
    """The numbers that are looked at first."""
    energy = whole.energy.total
    facts = (
        ("time", _clock(whole.duration)),
        ("with chips", f"{ratio(whole.cutting_time, whole.duration):.0%}"),
        ("energy", f"{kilowatt_hours(energy):.3g} kWh"),
        ("carbon", f"{carbon.grams(energy):.3g} g CO₂"),
        ("mean power", f"{kw_from_watts(ratio(energy, whole.duration)):.3g} kW"),
        ("removed", f"{whole.volume * 1e-3:.4g} cm³"),
    )
    items = "".join(f"<div>{name}<b>{value}</b></div>" for name, value in facts)
    return f'<div class="figures">{items}</div>'


def _clock(seconds: float) -> str:
    """Time as people say it."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def _limits(simulation: Simulation, found: Sequence[Row]) -> str:
    return _list(("bad", text) for text in exceeded(simulation, found))


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
    return _table(heads, body, (("total", "", *_split(whole)), ("share", "", *shares)))


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
    return _table(heads, body, foot)


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
    return _table(heads, body, (("total", *_removed(whole)),))


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
    return _table(heads, body, ())


def _place(peak: Peak, found: Sequence[Row]) -> tuple[str, str, str]:
    """Time, line and workingstep."""
    if not peak.value:
        return "–", "–", "–"
    name = next((row.name for row in reversed(found) if row.begin <= peak.time), "")
    return f"{peak.time:.1f}", str(peak.line), name


def _findings(simulation: Simulation) -> str:
    """All findings, equal ones once."""
    unique = {str(finding): finding.severity.value for finding in simulation.findings}
    return _list((severity, text) for text, severity in unique.items())


def _list(items: Iterable[tuple[str, str]]) -> str:
    """Class and text of each item."""
    shown = "\n".join(f'<li class="{kind}">{escape(text)}</li>' for kind, text in items)
    return f"<ul>{shown}</ul>" if shown else "<p>none</p>"


def _table(
    heads: Sequence[str], body: Iterable[Sequence[str]], foot: Iterable[Sequence[str]]
) -> str:
    """A table that scrolls by itself where the screen is narrow."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in heads)
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead>\n'
        f"<tbody>{_cells(body)}</tbody>\n<tfoot>{_cells(foot)}</tfoot></table></div>"
    )


def _cells(lines: Iterable[Sequence[str]]) -> str:
    return "\n".join(
        f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in line)}</tr>" for line in lines
    )
