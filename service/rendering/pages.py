"""Self-contained HTML pages from Jinja templates; they load nothing from the network.

Templates are in ``service/templates``; all values filled in are escaped. ``page.html.jinja`` is
the frame of all pages; ``parts.html.jinja`` has the macros for tables of columns, lists and key
figures.
"""

from collections.abc import Iterable, Sequence
from functools import cache
from typing import TYPE_CHECKING

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from service.rendering.columns import clock, grouped, visible
from stepnc_model.errors import Finding

if TYPE_CHECKING:
    import plotly.graph_objects as go

TOUCH = """
if (window.matchMedia("(pointer: coarse)").matches)
  Plotly.relayout("{plot_id}", {dragmode: false});
"""
"""Script that lets a finger on the plot scroll the page."""

PLOT = {
    "displaylogo": False,
    "showSendToCloud": False,
    "modeBarButtonsToRemove": ["select2d", "lasso2d"],
}
"""Plot options without the button that would upload the plot to another host."""


def rendered(template: str, /, **values: object) -> str:
    """Return a template of ``service/templates`` filled in with values.

    Parameters
    ----------
    template : str
        File name of the template.
    **values
        Values of the variables in the template.
    """
    return _environment().get_template(template).render(**values)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("service"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        auto_reload=False,
    )
    environment.filters |= {"clock": clock, "findings": findings, "bad": bad}
    environment.globals |= {"visible": visible, "grouped": grouped, "plotly": _plotly}
    return environment


def _plotly() -> Markup:
    from plotly.offline import get_plotlyjs  # noqa: PLC0415 (slow to import)

    return Markup(get_plotlyjs())


def plot(figure: "go.Figure", name: str) -> Markup:
    """Return a figure as an HTML fragment; its name must be unique on the page."""
    return Markup(
        figure.to_html(
            full_html=False, include_plotlyjs=False, div_id=name, post_script=TOUCH, config=PLOT
        )
    )


def bad(texts: Iterable[str]) -> list[tuple[str, str]]:
    """Return CSS class and text of each problem."""
    return [("bad", text) for text in texts]


def findings(items: Sequence[Finding]) -> list[tuple[str, str]]:
    """Return CSS class and text of each finding, without duplicates."""
    unique = {str(each): each.severity.value for each in items}
    return [(kind, text) for text, kind in unique.items()]
