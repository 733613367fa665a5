"""The figure shows what the trace holds, in the units that its titles say."""

from dataclasses import replace

import numpy as np
import plotly.graph_objects as go
import pytest

from controller.orders import EventKind, LoopEvent
from service.control.facts import rows
from service.control.figures import chosen_events, control_figure
from service.control.run import ControlRun
from service.control.trace import ControlSignal
from service.plots.buckets import BucketedRun


def trace_of(run: ControlRun) -> BucketedRun:
    assert run.trace is not None
    return run.trace


@pytest.fixture(scope="module")
def figure(control_run: ControlRun) -> go.Figure:
    return control_figure(control_run, rows(control_run), trace_of(control_run))


def drawn(figure: go.Figure, panel: str) -> list[go.Scatter]:
    """The lines of one panel, by the beginning of its title."""
    titles = [note.text for note in figure.layout.annotations]
    number = next(row for row, text in enumerate(titles, 1) if text.startswith(f"<b>{panel}"))
    name = "y" if number == 1 else f"y{number}"
    return [line for line in figure.data if line.yaxis == name]


def test_panels_are_those_of_the_paper_and_more(figure: go.Figure) -> None:
    titles = [
        note.text.split("</b>")[0].removeprefix("<b>") for note in figure.layout.annotations
    ]
    assert titles == [
        "Workingsteps", "Events", "Feed rate", "Cutting force", "Removal rate",
        "Feed override", "Measured over expected force", "Tooth pattern",
        "Spindle power",
    ]  # fmt: skip


def test_peaks_of_the_force_are_drawn(figure: go.Figure, control_run: ControlRun) -> None:
    expected, set_point, measured = drawn(figure, "Cutting force")
    trace = trace_of(control_run)
    high = trace.curve(ControlSignal.FORCE_MEASURED).high
    assert np.nanmax(measured.y) == pytest.approx(np.nanmax(high), rel=1e-6)
    assert np.nanmax(expected.y) < np.nanmax(measured.y)
    assert (set_point.name, expected.name) == ("set point", "expected")


def test_units_are_those_of_the_shop(figure: go.Figure) -> None:
    """Programmed are 600 mm/min."""
    actual, programmed = drawn(figure, "Feed rate")
    assert np.nanmax(programmed.y) == pytest.approx(600.0)
    commanded, _ = drawn(figure, "Feed override")
    assert 100.0 < np.nanmax(commanded.y) <= 120.0 + 1e-4
    assert np.nanmin(actual.y) >= 0.0


def test_the_factor_on_k_c_is_that_of_the_work(figure: go.Figure) -> None:
    (factor,) = drawn(figure, "Measured over")
    known = np.asarray(factor.y)[~np.isnan(factor.y)]
    assert np.quantile(known, [0.1, 0.9]) == pytest.approx([1.1, 1.54], rel=0.05)


def test_what_was_done_to_the_run_is_marked(figure: go.Figure, control_run: ControlRun) -> None:
    told, done = drawn(figure, "Events")
    assert len(told.x) == len(control_run.events)
    assert (list(done.x), list(done.text)) == ([7.5], ["hardness:+40%@7.5s"])
    assert [shape.x0 for shape in figure.layout.shapes if shape.type == "line"] == [7.5]


def test_words_of_a_file_are_no_markup(control_run: ControlRun) -> None:
    evil = LoopEvent(time=1.0, kind=EventKind.WORKINGSTEP, text="<b>A</b>")
    run = replace(control_run, events=(evil,))
    told, _ = drawn(control_figure(run, rows(run), trace_of(run)), "Events")
    assert list(told.text) == ["workingstep: &lt;b&gt;A&lt;/b&gt;"]


def test_grave_events_are_kept_when_there_are_too_many(control_run: ControlRun) -> None:
    plain = [LoopEvent(time=float(row), kind=EventKind.SAFE, text="") for row in range(50)]
    grave = LoopEvent(time=60.0, kind=EventKind.STOP, text="")
    warning = LoopEvent(time=55.0, kind=EventKind.WARNING, text="")
    run = replace(control_run, events=(*plain, warning, grave))
    assert chosen_events(run, 2) == (warning, grave)
    assert chosen_events(run, 100) == run.events
