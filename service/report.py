"""One self-contained HTML page for a plan: nothing is fetched from anywhere."""

from html import escape

from plotly.offline import get_plotlyjs

from optimiser.advice import Advice, Plan, State, Status
from service.figures import (
    feed_figure,
    front_figure,
    limits_figure,
    power_figure,
    time_figure,
)
from stepnc_model.units import kw_from_watts, mm_min_from_speed, rpm_from_rev_s

STYLE = """
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 76rem;
       padding: 0 1rem; color: #1a1a1a; background: #fff; }
h1 { font-size: 1.5rem; margin-bottom: 0; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
.sub { color: #555; margin-top: .2rem; }
.figures { display: flex; gap: 2.5rem; flex-wrap: wrap; margin: 1.2rem 0; }
.figures b { display: block; font-size: 1.7rem; font-weight: 600; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; padding: .35rem .7rem; border-bottom: 1px solid #ddd;
         vertical-align: top; }
th { font-weight: 600; border-bottom: 2px solid #888; } td.n, th.n { text-align: right; }
td.n { white-space: nowrap; }
.infeasible { color: #b00020; font-weight: 600; } .untouched { color: #666; }
li.error { color: #b00020; } li.warning { color: #8a5a00; } li.note { color: #444; }
"""


PLOT = {"displaylogo": False, "showSendToCloud": False}
"""no button that sends a plot to another host"""


def report_page(plan: Plan) -> str:
    """The page as HTML.

    Parameters
    ----------
    plan : Plan

    Returns
    -------
    str
    """
    figures = [
        time_figure(plan), feed_figure(plan), power_figure(plan), limits_figure(plan),
        front_figure(plan),
    ]  # fmt: skip
    plots = "\n".join(
        figure.to_html(
            full_html=False, include_plotlyjs=False, config=PLOT, div_id=f"plot{row}"
        )
        for row, figure in enumerate(figures)
        if figure is not None
    )
    title = f"{plan.program}: {plan.mode.value} on {plan.machine.name}"
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE}</style>
<script>{get_plotlyjs()}</script></head><body>
<h1>{escape(plan.program)}</h1>
<p class="sub">mode {plan.mode.value} · {escape(plan.machine.title)}
 · {escape(plan.material.reason)}</p>
{_totals(plan)}
<h2>Workingsteps</h2>{_table(plan)}
<h2>Plots</h2>
{plots}
<h2>Findings</h2>{_findings(plan)}
</body></html>
"""


def _totals(plan: Plan) -> str:
    """The numbers that are looked at first."""
    before, after = plan.time_before, plan.time_after
    energy = f"{plan.energy_before / 1e3:.0f} → {plan.energy_after / 1e3:.0f} kJ"
    change = f"{after / before - 1.0:+.0%}".replace("-", "−") if before else ""
    return (
        '<div class="figures">'
        f"<div>as programmed<b>{before:.1f} s</b></div>"
        f"<div>as advised<b>{after:.1f} s</b></div>"
        f"<div>change<b>{change}</b></div>"
        f"<div>energy<b>{energy}</b></div></div>"
        f"<p class=sub>totals leave out {escape(plan.left_out)}</p>"
    )


def _table(plan: Plan) -> str:
    """A row for each workingstep."""
    heads = (
        "<th>workingstep</th><th>operation, tool</th><th class=n>feed mm/min</th>"
        "<th class=n>plunge feed mm/min</th><th class=n>rpm</th>"
        "<th class=n>depth mm × passes</th><th class=n>kW</th>"
        "<th class=n>time s</th><th>why</th>"
    )
    rows = "\n".join(_row(advice) for advice in plan.advices)
    return f'<div class="scroll"><table><thead><tr>{heads}</tr></thead>{rows}</table></div>'


def _row(advice: Advice) -> str:
    """One workingstep; programmed → advised where they differ."""
    before, after = advice.before, advice.after
    step = advice.workingstep
    names = (
        f"<td>{escape(step.id)}</td><td>{escape(step.operation_type.replace('_', ' '))}<br>"
        f"{escape(advice.tool.id)}</td>"
    )
    why = f'<td class="{advice.status.value}">{escape(_why(advice))}</td>'
    if before is None:
        return f"<tr>{names}{'<td class=n>–</td>' * 6}{why}</tr>"
    last = after or before
    old, new = before.setting, last.setting
    cells = (
        (f"{mm_min_from_speed(before.feed):.1f}", f"{mm_min_from_speed(last.feed):.1f}"),
        (_plunge_feed(before), _plunge_feed(last)),
        (f"{rpm_from_rev_s(old.speed):.0f}", f"{rpm_from_rev_s(new.speed):.0f}"),
        (f"{old.depth:.3g} × {old.passes}", f"{new.depth:.3g} × {new.passes}"),
        (f"{kw_from_watts(before.motor_power):.2f}", f"{kw_from_watts(last.motor_power):.2f}"),
        (f"{before.time:.1f}", f"{last.time:.1f}"),
    )
    numbers = "".join(
        f"<td class=n>{one if one == two else f'{one} → {two}'}</td>" for one, two in cells
    )
    return f"<tr>{names}{numbers}{why}</tr>"


def _plunge_feed(state: State) -> str:
    """Plunge feed in mm/min; a dash where there is none of its own."""
    return "–" if state.plunge_feed is None else f"{mm_min_from_speed(state.plunge_feed):.1f}"


def _why(advice: Advice) -> str:
    """The reason, with what is left untouched or impossible said first."""
    if advice.status is Status.ADVISED:
        plunge = f"; plunge feed: {advice.plunge_reason}" if advice.plunge_reason else ""
        return advice.reason + plunge
    return f"{advice.status.value}: {advice.reason}"


def _findings(plan: Plan) -> str:
    """All findings, equal ones once."""
    unique = {str(finding): finding.severity.value for finding in plan.findings}
    items = "\n".join(
        f'<li class="{severity}">{escape(text)}</li>' for text, severity in unique.items()
    )
    return f"<ul>{items}</ul>" if items else "<p>none</p>"
