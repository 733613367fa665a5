"""Plotly figure of a controlled run, after Fig. 9 of the 2010 paper [1]_.

Feed rate, cutting force with its set point, and removal rate over time as in the paper; below
them override, ratio of measured to expected force, tooth pattern, and spindle power. Changes by
the operator and disturbances are marked across all panels.

References
----------
.. [1] F. Ridwan, X. Xu, G. Liu, "A framework for machining optimisation based on STEP-NC",
   J. Intell. Manuf., 2010, Fig. 9.
"""

from collections.abc import Sequence
from html import escape

import numpy as np
import plotly.graph_objects as go

from controller.orders import EventKind, LoopEvent
from service.control.disturbances import time_of
from service.control.facts import ControlRow, disturbed
from service.control.run import ControlRun
from service.control.trace import ControlSignal
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
from simulator.motion.segments import Floats
from stepnc_model.units import SECONDS_PER_MINUTE

GRAVE = frozenset({
    EventKind.STOP,
    EventKind.BREAKAGE,
    EventKind.HOLD,
    EventKind.OVER,
    EventKind.LOST,
    EventKind.ASTRAY,
})
"""Serious events, which no good run has."""

PLAIN = frozenset({
    EventKind.WORKINGSTEP,
    EventKind.SAFE,
    EventKind.RESUME,
    EventKind.ORDER,
    EventKind.FOLLOWED,
})
"""Events of a normal run."""

MOST_MARKS = 1000
"""Most events that are drawn, serious ones first."""

ROOM = 1.15
"""Ratio of the upper end of a panel to its largest value."""

USUAL = 0.98
"""Quantile of the k_c factor above which values are spikes of tool entry or exit."""

FAR = 1.5
"""Multiple of the largest force above which a set point is drawn outside the panel."""


def control_figure(
    run: ControlRun, rows: Sequence[ControlRow], trace: BucketedRun
) -> go.Figure:
    """Figure of workingsteps, events, feed, force, removal rate, override and more over time.

    Parameters
    ----------
    rows : sequence of ControlRow
        Rows of the workingsteps of the run.
    trace : BucketedRun
        Signals of the same run.

    Returns
    -------
    plotly.graph_objects.Figure
    """
    stretches = [
        TimeSpan(name=row.name, begin=row.begin, duration=row.record.time) for row in rows
    ]
    panels = Panels(trace)
    panels.strip(stretches)
    _events(panels, run)
    _feed(panels, trace)
    _force(panels, trace)
    panels.begin("<b>Removal rate</b>, cm³/min", height=130)
    panels.peaks("cm³/min", GREEN, ControlSignal.REMOVAL_RATE, scale=0.06)
    _override(panels, run)
    _ratio(panels, trace)
    _teeth(panels)
    panels.begin("<b>Spindle power</b>, kW", height=110)
    panels.peaks("kW", BLUE, ControlSignal.SPINDLE_POWER_TRUE, scale=1e-3)
    if _greatest(trace.curve(ControlSignal.FLANK_WEAR).high) > 0.0:
        panels.begin("<b>Flank wear</b>, µm", height=90)
        panels.peaks("µm", DIM, ControlSignal.FLANK_WEAR, scale=1e3)
    figure = panels.done(stretches)
    for time, _ in _interventions(run):
        figure.add_shape(
            type="line", xref="x", yref="paper", x0=time * panels.second,
            x1=time * panels.second, y0=0.0, y1=1.0,
            line={"color": ORANGE, "width": 1, "dash": "dash"},
        )  # fmt: skip
    return figure


def chosen_events(run: ControlRun, most: int) -> tuple[LoopEvent, ...]:
    """Choose up to a number of events, serious ones first; return them in order of time."""
    if len(run.events) <= most:
        return run.events

    def rank(number: int) -> tuple[int, int]:
        kind = run.events[number].kind
        return (0 if kind in GRAVE else 2 if kind in PLAIN else 1), number

    kept = sorted(sorted(range(len(run.events)), key=rank)[:most])
    return tuple(run.events[number] for number in kept)


def colour_of(kind: EventKind) -> str:
    """Return the colour of an event kind by its severity."""
    if kind in GRAVE:
        return RED
    return DIM if kind in PLAIN else ORANGE


def _interventions(run: ControlRun) -> list[tuple[float, str]]:
    """Times and words of the disturbances and orders that came while the program ran."""
    return [
        (time, word)
        for word, has_come in disturbed(run)
        if has_come and (time := time_of(word)) is not None
    ]


def _events(panels: Panels, run: ControlRun) -> None:
    """Add the panel with marks of events and disturbances."""
    keys = " ".join((
        key("serious", RED, "●"),
        key("to be checked", ORANGE, "●"),
        key("normal", DIM, "●"),
        key("disturbance or order", ORANGE, "┆"),
    ))
    hidden = {"showticklabels": False, "showgrid": False, "zeroline": False}
    panels.begin(
        f"<b>Events</b><br>{keys}", height=40, fixedrange=True, range=[-1.0, 1.0], **hidden
    )
    events = chosen_events(run, MOST_MARKS)
    panels.add(
        _marks(
            [event.time * panels.second for event in events],
            [f"{event.kind.value}: {event.text}" for event in events],
            [colour_of(event.kind) for event in events],
        )
    )
    done = _interventions(run)
    marks = _marks(
        [time * panels.second for time, _ in done],
        [word for _, word in done],
        [ORANGE] * len(done),
    )
    panels.add(marks.update(marker_symbol="diamond", marker_size=10))


def _marks(times: Sequence[float], words: Sequence[str], colours: Sequence[str]) -> go.Scatter:
    return go.Scatter(
        x=list(times),
        y=[0.0] * len(times),
        mode="markers",
        marker={"color": list(colours), "size": 8},
        text=[escape(each) for each in words],
        hovertemplate="%{text}<extra></extra>",
        cliponaxis=False,
    )


def _feed(panels: Panels, trace: BucketedRun) -> None:
    """Add the panel of programmed and actual feed; rapids leave its frame."""
    keys = f"{key('programmed', GREY)} {key('actual', BLUE)}"
    most = SECONDS_PER_MINUTE * _greatest(trace.curve(ControlSignal.FEED_PROGRAMMED).high)
    title = f"<b>Feed rate</b>, mm/min<br>{keys} (rapids leave the frame)"
    # A band above 100 % lets the actual feed rise above the programmed.
    shown = [0.0, ROOM * 1.2 * most] if most > 0.0 else None
    panels.begin(title, height=150, range=shown)
    panels.peaks("actual", BLUE, ControlSignal.FEED_ACTUAL, scale=SECONDS_PER_MINUTE)
    panels.peaks("programmed", GREY, ControlSignal.FEED_PROGRAMMED, scale=SECONDS_PER_MINUTE)


def _force(panels: Panels, trace: BucketedRun) -> None:
    """Add the panel of measured force, force expected at the actual feed, and set point."""
    keys = " ".join((
        key("measured", RED), key("expected", SKY), key("set point", DIM, "━"),
    ))  # fmt: skip
    force = _greatest(trace.curve(ControlSignal.FORCE_MEASURED).high)
    bounds = trace.curve(ControlSignal.SET_POINT).mean
    is_far = bounds > FAR * force
    top = ROOM * max(force, _greatest(bounds[~is_far]))
    title = f"<b>Cutting force</b>, tangential, mean of a revolution, N<br>{keys}"
    if is_far.any():
        title += " (set points far above leave the frame)"
    panels.begin(title, height=210, range=[0.0, top] if top > 0.0 else None)
    middle = 0.5 * (trace.begin + trace.end) * panels.second
    for name, colour, signal in (
        ("expected", SKY, ControlSignal.FORCE_EXPECTED),
        ("set point", DIM, ControlSignal.SET_POINT),
    ):
        panels.add(line(name, colour, middle, trace.curve(signal).mean))
    panels.peaks("measured", RED, ControlSignal.FORCE_MEASURED)


def _override(panels: Panels, run: ControlRun) -> None:
    """Add the panel of commanded and actual override."""
    band = run.settings.band
    keys = f"{key('commanded', GREY)} {key('actual', BLUE)}"
    panels.begin(
        f"<b>Feed override</b>, %<br>{keys} (band {100 * band.floor:g} to "
        f"{100 * band.ceiling:g} %)",
        height=130,
        range=[0.0, 100.0 * ROOM * band.ceiling],
    )
    panels.peaks("commanded", GREY, ControlSignal.OVERRIDE_COMMANDED, scale=100.0)
    panels.peaks("actual", BLUE, ControlSignal.OVERRIDE_ACTUAL, scale=100.0)


def _ratio(panels: Panels, trace: BucketedRun) -> None:
    """Add the panel of the k_c factor: measured force over force by the catalogue's k_c."""
    middle = 0.5 * (trace.begin + trace.end) * panels.second
    mean = trace.curve(ControlSignal.FORCE_RATIO).mean
    known = mean[~np.isnan(mean)]
    usual = float(np.quantile(known, USUAL)) if len(known) else 1.0
    title = "<b>Measured over expected force</b>: factor on k_c (spikes leave the frame)"
    panels.begin(title, height=110, range=[0.0, ROOM * max(usual, 1.0)])
    panels.add(line("factor", PINK, middle, mean))


def _teeth(panels: Panels) -> None:
    """Add the panel of tooth-passing and once-per-revolution amplitudes (runout, breakage)."""
    keys = f"{key('tooth passing', GREEN)} {key('once per revolution', ORANGE)}"
    panels.begin(f"<b>Tooth pattern</b>, amplitudes, N<br>{keys}", height=130)
    panels.peaks("tooth passing", GREEN, ControlSignal.TOOTH_PASSING)
    panels.peaks("once per revolution", ORANGE, ControlSignal.ONCE_PER_REVOLUTION)


def _greatest(values: Floats) -> float:
    """Return the largest value, ignoring NaN; 0 if there is none."""
    return float(np.fmax.reduce(values, initial=0.0))
