"""One plotly figure of a simulated run.

Powers are stacked by their mean in each bucket of the trace; all else is drawn through the
least and the greatest value of each bucket.
"""

from collections.abc import Sequence

import numpy as np
import plotly.graph_objects as go

from service.buckets import BucketedRun
from service.panels import (
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
from service.simulation.trace import SimulationSignal

AXES = (
    ("X", ORANGE, SimulationSignal.X_POWER),
    ("Y", GREEN, SimulationSignal.Y_POWER),
    ("Z", PINK, SimulationSignal.Z_POWER),
)

ROOM = 1.15
"""times the greatest feed of the program: what the panel of feed shows"""


def run_figure(found: Sequence[SimulationRow], trace: BucketedRun) -> go.Figure:
    """Workingsteps, powers, feed, spindle speed, force and removal rate against time.

    Parameters
    ----------
    found : sequence of SimulationRow
        The run's workingsteps.
    trace : BucketedRun

    Returns
    -------
    plotly.graph_objects.Figure
    """
    stretches = [
        TimeSpan(name=row.name, begin=row.begin, duration=row.total.duration) for row in found
    ]
    panels = Panels(trace)
    panels.strip(stretches)
    _power(panels, trace)
    _axes(panels, trace)
    _feed(panels, trace)
    panels.begin("<b>Spindle speed</b>, rpm", height=90)
    panels.peaks("rpm", BLUE, SimulationSignal.SPINDLE_SPEED, scale=60.0)
    panels.begin("<b>Cutting force</b>, tangential, N", height=140)
    panels.peaks("N", RED, SimulationSignal.FORCE)
    panels.begin("<b>Removal rate</b>, cm³/min", height=140)
    panels.peaks("cm³/min", GREEN, SimulationSignal.REMOVAL_RATE, scale=0.06)
    return panels.done(stretches)


def _power(panels: Panels, trace: BucketedRun) -> None:
    """Components stacked, the greatest total, and where the drive is overloaded."""
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
        shown_line = line(name, colour, middle, trace.curve(signal).mean * 1e-3)
        panels.add(shown_line.update(stackgroup="power", line_width=0, fillcolor=colour))
    panels.add(line("peak of the total", DIM, middle, total.high * 1e-3))
    if loaded.any():
        marks = line("above a limit", RED, middle[loaded], total.high[loaded] * 1e-3)
        panels.add(marks.update(mode="markers", marker={"color": RED, "size": 5}))


def _axes(panels: Panels, trace: BucketedRun) -> None:
    """The axes by themselves: they vanish beside the spindle."""
    shown = [part for part in AXES if _is_used(trace, part[2])]
    keys = " ".join(key(name, colour) for name, colour, _ in shown)
    panels.begin(f"<b>Axis power</b>, W<br>{keys}", height=130)
    for name, colour, signal in shown:
        panels.peaks(name, colour, signal)


def _feed(panels: Panels, trace: BucketedRun) -> None:
    """Feed as programmed and as it is; rapids are far above and leave the panel."""
    keys = f"{key('commanded', GREY)} {key('actual', BLUE)}"
    # fmax passes over what is missing.
    most = (
        np.fmax.reduce(trace.curve(SimulationSignal.FEED_PROGRAMMED).high, initial=0.0) * 60.0
    )
    title = f"<b>Feed</b>, mm/min<br>{keys} (rapids leave the frame)"
    panels.begin(title, height=150, range=[0.0, ROOM * most] if most > 0.0 else None)
    panels.peaks("actual", BLUE, SimulationSignal.FEED_ACTUAL, scale=60.0)
    panels.peaks("commanded", GREY, SimulationSignal.FEED_PROGRAMMED, scale=60.0)


def _is_used(trace: BucketedRun, signal: SimulationSignal) -> bool:
    curve = trace.curve(signal)
    return bool((curve.high > 0.0).any() or (curve.low < 0.0).any())
