"""A self-contained HTML page: style, tables, lists; it fetches nothing from anywhere."""

from collections.abc import Iterable, Sequence
from html import escape

import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

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


def page(title: str, body: str) -> str:
    """A whole page.

    Parameters
    ----------
    title : str
    body : str
        As HTML.
    """
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{escape(title)}</title><style>{STYLE}</style>
<script>{get_plotlyjs()}</script></head><body>
{body}
</body></html>
"""


def plot(figure: go.Figure, name: str) -> str:
    """A figure as a part of the page; the name is unique on it."""
    text: str = figure.to_html(
        full_html=False, include_plotlyjs=False, div_id=name, post_script=TOUCH, config=PLOT
    )
    return text


def headline(facts: Iterable[tuple[str, str]]) -> str:
    """Names and values that are looked at first."""
    items = "".join(f"<div>{escape(name)}<b>{escape(value)}</b></div>" for name, value in facts)
    return f'<div class="figures">{items}</div>'


def clock(seconds: float) -> str:
    """Time as people say it."""
    if seconds < 120.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s"


def bullets(items: Iterable[tuple[str, str]]) -> str:
    """Class and text of each item."""
    shown = "\n".join(f'<li class="{kind}">{escape(text)}</li>' for kind, text in items)
    return f"<ul>{shown}</ul>" if shown else "<p>none</p>"


def table(
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
