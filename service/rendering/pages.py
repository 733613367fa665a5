"""Self-contained HTML pages from Jinja templates; they fetch nothing from anywhere.

Templates stand in ``service/templates``; everything that is filled in is escaped.
``page.html.jinja`` is the frame of all pages; ``parts.html.jinja`` has the macros for tables
of columns, lists and key figures.
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
"""a finger on the plot scrolls the page"""

PLOT = {
    "displaylogo": False,
    "showSendToCloud": False,
    "modeBarButtonsToRemove": ["select2d", "lasso2d"],
}
"""without the button that sends a plot to another host, which plotly.js shows by itself"""


def rendered(template: str, /, **values: object) -> str:
    """A template of ``service/templates``, filled in.

    Parameters
    ----------
    template : str
        Name of its file.
    **values
        As the template names them.
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
    """A figure as a part of the page; the name is unique on it."""
    return Markup(
        figure.to_html(
            full_html=False, include_plotlyjs=False, div_id=name, post_script=TOUCH, config=PLOT
        )
    )


def bad(texts: Iterable[str]) -> list[tuple[str, str]]:
    """Class and text of what is wrong."""
    return [("bad", text) for text in texts]


def findings(found: Sequence[Finding]) -> list[tuple[str, str]]:
    """Class and text of each finding, equal ones once."""
    unique = {str(each): each.severity.value for each in found}
    return [(kind, text) for text, kind in unique.items()]
