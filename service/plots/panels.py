"""Plotly figure of a run: panels stacked above each other with a common time axis.

Lines drawn by :meth:`Panels.peaks` go through the minimum and the maximum of each bucket of the
run, so that peaks stay visible. Colours are those of Okabe and Ito (2008), which the
colour-blind tell apart; lines and text are legible on light and dark backgrounds.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
import plotly.graph_objects as go

from service.plots.buckets import BucketedRun
from simulator.motion.segments import Floats
from stepnc_model.units import SECONDS_PER_HOUR, SECONDS_PER_MINUTE

GREY, SKY, ORANGE, GREEN, PINK, BLUE, RED = (
    "#8c8c8c", "#56B4E9", "#E69F00", "#009E73", "#CC79A7", "#0072B2", "#D55E00",
)  # fmt: skip
DIM = "#757575"
"""Colour of secondary lines, as far from white as from black."""
CLEAR = "rgba(0,0,0,0)"
FAINT = "rgba(128,128,128,0.25)"
BAND = "rgba(128,128,128,0.10)"
LEGEND = {"orientation": "h", "y": 1.0, "yanchor": "bottom", "x": 1.0, "xanchor": "right"}
"""Place of a legend above its figure, to the right."""
STRIPES = ("rgba(86,180,233,0.45)", "rgba(230,159,0,0.45)")
"""Alternating colours of workingsteps."""

MOST_BANDS = 200
"""Largest number of workingsteps whose bands are drawn behind the panels."""

GAP = 52
"""Gap between two panels, with room for a title of two lines, in pixels."""

MARGIN = 46
"""Margin to the left of the panels, in pixels."""

TOP, BOTTOM = 26, 48
"""Margins above and below all panels, in pixels."""

MINUTES, HOURS = 900.0, 3.0 * SECONDS_PER_HOUR
"""Durations from which the time axis is in minutes or hours, in s."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeSpan:
    """Span of a workingstep on the time axis."""

    name: str
    begin: float
    """Start of the workingstep, in s."""
    duration: float
    """Duration of the workingstep, in s."""


class Panels:
    """Builder of a figure to which panels are added one by one. Running state."""

    def __init__(self, trace: BucketedRun) -> None:
        last = float(trace.end[-1]) if len(trace.end) else 0.0
        self.second, self.unit = _clock(last)
        self.end = last * self.second
        self.figure = go.Figure()
        self._trace = trace
        self._heights: list[int] = []
        self._titles: list[str] = []

    def begin(self, title: str, *, height: int, **axis: object) -> None:
        """Start the next panel, below those before."""
        self._heights.append(height)
        self._titles.append(title)
        number = len(self._heights)
        self.figure.layout[_name("yaxis", number)] = {"automargin": True, **axis}
        self.figure.layout[_name("xaxis", number)] = {"anchor": _name("y", number)}

    def add(self, drawn: go.Scatter | go.Bar) -> None:
        """Draw a trace in the last panel."""
        number = len(self._heights)
        self.figure.add_trace(drawn.update(xaxis=_name("x", number), yaxis=_name("y", number)))

    def strip(self, stretches: Sequence[TimeSpan]) -> None:
        """Draw the first panel: workingstep names where they run."""
        hidden = {"showticklabels": False, "showgrid": False, "zeroline": False}
        self.begin(
            "<b>Workingsteps</b>", height=26, fixedrange=True, range=[0.0, 1.0], **hidden
        )
        self.add(
            go.Bar(
                x=[(each.begin + 0.5 * each.duration) * self.second for each in stretches],
                width=[each.duration * self.second for each in stretches],
                y=[1.0] * len(stretches),
                text=[escape(each.name) for each in stretches],
                customdata=[
                    f"{each.begin:.1f} s for {each.duration:.1f} s" for each in stretches
                ],
                hovertemplate="%{text}<br>from %{customdata}<extra></extra>",
                textposition="inside",
                insidetextanchor="middle",
                textangle=0,
                marker_color=[STRIPES[number % 2] for number in range(len(stretches))],
                marker_line_width=0,
            )
        )

    def peaks(self, name: str, colour: str, signal: int, *, scale: float = 1.0) -> None:
        """Draw a line through the minimum and maximum of each bucket."""
        trace, curve = self._trace, self._trace.curve(signal)
        times = np.column_stack((trace.begin, trace.end)).ravel()
        values = np.column_stack((curve.low, curve.high)).ravel()
        is_point = np.repeat(trace.begin == trace.end, 2)
        is_point[::2] = False
        at, shown = times[~is_point] * self.second, values[~is_point] * scale
        self.add(line(name, colour, at, shown))

    def done(self, stretches: Sequence[TimeSpan]) -> go.Figure:
        """Lay out all panels and return the figure."""
        figure, last = self.figure, _name("x", len(self._heights))
        inside = self._stack()
        figure.update_xaxes(
            matches=last, showticklabels=False, showspikes=True, spikemode="across",
            spikethickness=1, spikecolor=GREY, spikedash="dot", gridcolor=FAINT,
            zeroline=False, unifiedhovertitle_text=f"%{{x:.5~r}} {self.unit}",
        )  # fmt: skip
        bottom = figure.layout[_name("xaxis", len(self._heights))]
        bottom.update(showticklabels=True, matches=None, range=[0.0, self.end])
        bottom.title = f"time, {self.unit}"
        figure.update_yaxes(gridcolor=FAINT, zerolinecolor=GREY, nticks=5)
        return figure.update_layout(
            height=inside + TOP + BOTTOM,
            margin={"l": MARGIN, "r": 12, "t": TOP, "b": BOTTOM},
            modebar={"bgcolor": CLEAR, "color": GREY, "activecolor": BLUE},
            showlegend=False, hovermode="x unified", hoverlabel_bgcolor="#ffffff",
            paper_bgcolor=CLEAR, plot_bgcolor=CLEAR, shapes=self._bands(stretches, last),
            uniformtext={"mode": "hide", "minsize": 9},
            font={"family": "system-ui, sans-serif", "size": 12},
        )  # fmt: skip

    def _stack(self) -> int:
        """Stack the panels and return their total height, in pixels."""
        inside = sum(self._heights) + GAP * (len(self._heights) - 1)
        top = 0
        for number, (height, title) in enumerate(
            zip(self._heights, self._titles, strict=True), 1
        ):
            above, below = 1.0 - top / inside, max(1.0 - (top + height) / inside, 0.0)
            self.figure.layout[_name("yaxis", number)].update(
                domain=[below, above], anchor=_name("x", number)
            )
            self.figure.add_annotation(
                text=title, x=0.0, y=above, xref="paper", yref="paper", xanchor="left",
                yanchor="bottom", showarrow=False, align="left", xshift=-MARGIN,
            )  # fmt: skip
            top += height + GAP
        return inside

    def _bands(self, stretches: Sequence[TimeSpan], axis: str) -> list[dict[str, object]]:
        """Shaded bands of every second workingstep, behind all panels."""
        if len(stretches) > MOST_BANDS:
            return []
        return [
            {
                "type": "rect", "layer": "below", "fillcolor": BAND, "line": {"width": 0},
                "xref": axis, "yref": "paper", "y0": 0.0, "y1": 1.0,
                "x0": each.begin * self.second,
                "x1": (each.begin + each.duration) * self.second,
            }
            for each in stretches[1::2]
        ]  # fmt: skip


def key(name: str, colour: str, mark: str = "■") -> str:
    """Return a legend entry for a panel title: the name preceded by its colour mark."""
    return f'<span style="color:{colour}">{mark}</span> {name}'


def line(name: str, colour: str, times: Floats, values: Floats) -> go.Scatter:
    """Line trace of a signal, in 32-bit floats: more digits than any screen resolves."""
    return go.Scatter(
        name=name,
        x=times.astype(np.float32),
        y=values.astype(np.float32),
        mode="lines",
        line={"color": colour, "width": 1},
        hovertemplate="%{y:.4~r}",
    )


def _clock(last: float) -> tuple[float, str]:
    """Return the factor from seconds to the unit of the time axis, and that unit."""
    if last < MINUTES:
        return 1.0, "s"
    return (1.0 / SECONDS_PER_MINUTE, "min") if last < HOURS else (1.0 / SECONDS_PER_HOUR, "h")


def _name(kind: str, number: int) -> str:
    """Plotly's name of an axis; the first axis has no number."""
    return kind if number == 1 else f"{kind}{number}"
