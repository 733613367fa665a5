"""Plotly figure of a simulated run.

Powers are stacked by their mean in each bucket; all other signals are drawn through the minimum
and the maximum of each bucket.
"""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from service.plots.buckets import BucketedRun
from service.plots.panels import (
    BLUE,
    DIM,
    GREEN,
    GREY,
    ORANGE,
    PINK,
    RED,
    SKY,
    Panels,
    TimeSpan,
    key,
    line,
)
from service.simulation.facts import SimulationRow
from service.simulation.run_collector import SimulationSignal
from stepnc_model.units import SECONDS_PER_MINUTE, WATTS_PER_KILOWATT

AXES = (
    ("X", ORANGE, SimulationSignal.X_POWER),
    ("Y", GREEN, SimulationSignal.Y_POWER),
    ("Z", PINK, SimulationSignal.Z_POWER),
)

ROOM = 1.15
"""Ratio of the upper end of the feed panel to the largest programmed feed."""


def run_figure(rows: Sequence[SimulationRow], trace: BucketedRun) -> go.Figure:
    """Figure of workingsteps, powers, feed, spindle speed, force and removal rate over time.

    Parameters
    ----------
    rows : sequence of SimulationRow
        Rows of the workingsteps of the run.

    Returns
    -------
    plotly.graph_objects.Figure
    """
    stretches = [
        TimeSpan(name=row.name, begin=row.begin, duration=row.total.duration) for row in rows
    ]
    panels = Panels(trace)
    panels.strip(stretches)
    _power(panels, trace)
    _axes(panels, trace)
    _feed(panels, trace)
    panels.begin("<b>Spindle speed</b>, rpm", height=90)
    panels.peaks("rpm", BLUE, SimulationSignal.SPINDLE_SPEED, scale=SECONDS_PER_MINUTE)
    panels.begin("<b>Cutting force</b>, tangential, N", height=140)
    panels.peaks("N", RED, SimulationSignal.FORCE)
    panels.begin("<b>Removal rate</b>, cm³/min", height=140)
    panels.peaks("cm³/min", GREEN, SimulationSignal.REMOVAL_RATE, scale=0.06)
    return panels.done(stretches)


def _power(panels: Panels, trace: BucketedRun) -> None:
    """Add the panel of stacked power components, with peaks and overloads of the drive."""
    parts = [
        ("base", GREY, SimulationSignal.BASE_POWER),
        ("coolant", SKY, SimulationSignal.COOLANT_POWER),
        *AXES,
        ("spindle", BLUE, SimulationSignal.SPINDLE_POWER),
    ]
    shown = [part for part in parts if _is_used(trace, part[2])]
    total = trace.curve(SimulationSignal.TOTAL_POWER)
    loaded = trace.curve(SimulationSignal.OVERLOAD).high > 0.0
    keys = [key(name, colour) for name, colour, _ in shown]
    keys.append(key("peak", DIM, "━"))
    if loaded.any():
        keys.append(key("limit", RED, "●"))
    panels.begin(f"<b>Power</b>, kW<br>{' '.join(keys)}", height=230)
    middle = 0.5 * (trace.begin + trace.end) * panels.second
    for name, colour, signal in shown:
        shown_line = line(name, colour, middle, trace.curve(signal).mean / WATTS_PER_KILOWATT)
        panels.add(shown_line.update(stackgroup="power", line_width=0, fillcolor=colour))
    high = total.high / WATTS_PER_KILOWATT
    panels.add(line("peak of the total", DIM, middle, high))
    if loaded.any():
        marks = line("above a limit", RED, middle[loaded], high[loaded])
        panels.add(marks.update(mode="markers", marker={"color": RED, "size": 5}))


def _axes(panels: Panels, trace: BucketedRun) -> None:
    """Add the panel of axis powers, which would not be visible beside the spindle power."""
    shown = [part for part in AXES if _is_used(trace, part[2])]
    keys = " ".join(key(name, colour) for name, colour, _ in shown)
    panels.begin(f"<b>Axis power</b>, W<br>{keys}", height=130)
    for name, colour, signal in shown:
        panels.peaks(name, colour, signal)


def _feed(panels: Panels, trace: BucketedRun) -> None:
    """Add the panel of commanded and actual feed; rapids leave its frame."""
    keys = f"{key('commanded', GREY)} {key('actual', BLUE)}"
    # fmax ignores missing values.
    fastest = np.fmax.reduce(trace.curve(SimulationSignal.FEED_PROGRAMMED).high, initial=0.0)
    most = SECONDS_PER_MINUTE * fastest
    title = f"<b>Feed</b>, mm/min<br>{keys} (rapids leave the frame)"
    panels.begin(title, height=150, range=[0.0, ROOM * most] if most > 0.0 else None)
    panels.peaks("actual", BLUE, SimulationSignal.FEED_ACTUAL, scale=SECONDS_PER_MINUTE)
    panels.peaks("commanded", GREY, SimulationSignal.FEED_PROGRAMMED, scale=SECONDS_PER_MINUTE)


def _is_used(trace: BucketedRun, signal: SimulationSignal) -> bool:
    curve = trace.curve(signal)
    return bool((curve.high > 0.0).any() or (curve.low < 0.0).any())
