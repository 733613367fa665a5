"""The figure shows what the trace holds, in the units that its titles say."""

from itertools import pairwise

import numpy as np
import plotly.graph_objects as go
import pytest

from service.plots.buckets import BucketedRun
from service.plots.panels import MOST_BANDS
from service.simulation.facts import rows
from service.simulation.figures import run_figure
from service.simulation.run import Simulation
from service.simulation.run_collector import SimulationSignal, TraceKeeper


@pytest.fixture(scope="module")
def figure(simulation: Simulation, trace: BucketedRun) -> go.Figure:
    return run_figure(rows(simulation), trace)


def drawn(figure: go.Figure, panel: str) -> list[go.Scatter]:
    """The lines of one panel, by the beginning of its title."""
    titles = [note.text for note in figure.layout.annotations]
    number = next(row for row, text in enumerate(titles, 1) if text.startswith(f"<b>{panel}"))
    name = "y" if number == 1 else f"y{number}"
    return [line for line in figure.data if line.yaxis == name]


def test_every_panel_has_its_title_and_unit(figure: go.Figure) -> None:
    titles = [note.text.split("<br>")[0] for note in figure.layout.annotations]
    assert titles == [
        "<b>Workingsteps</b>",
        "<b>Power</b>, kW",
        "<b>Axis power</b>, W",
        "<b>Feed</b>, mm/min",
        "<b>Spindle speed</b>, rpm",
        "<b>Cutting force</b>, tangential, N",
        "<b>Removal rate</b>, cm³/min",
    ]


def test_all_panels_share_one_axis_of_time(figure: go.Figure) -> None:
    axes = list(figure.select_xaxes())
    assert {axis.matches for axis in axes[:-1]} == {"x7"}
    assert axes[-1].title.text == "time, s"
    assert tuple(axes[-1].range) == (0.0, 100.0)


def test_panels_do_not_overlap(figure: go.Figure) -> None:
    domains = [axis.domain for axis in figure.select_yaxes()]
    for above, below in pairwise(domains):
        assert below[1] < above[0]


def test_the_stack_is_the_mean_total(figure: go.Figure, trace: BucketedRun) -> None:
    stack = [line for line in drawn(figure, "Power") if line.stackgroup]
    assert [line.name for line in stack] == ["base", "coolant", "X", "Y", "Z", "spindle"]
    total = trace.curve(SimulationSignal.TOTAL_POWER).mean * 1e-3
    np.testing.assert_allclose(sum(np.asarray(line.y) for line in stack), total, rtol=1e-6)


def test_peaks_are_drawn(figure: go.Figure, trace: BucketedRun) -> None:
    (force,) = drawn(figure, "Cutting force")
    curve = trace.curve(SimulationSignal.FORCE)
    assert max(force.y) == pytest.approx(curve.high.max())
    assert min(force.y) == pytest.approx(curve.low.min())


def test_units_are_those_of_the_shop(figure: go.Figure) -> None:
    """20 rev/s, 5 mm/s, and 0.1 mm³/s of each N."""
    (speed,) = drawn(figure, "Spindle speed")
    assert set(speed.y) == {1200.0}
    assert {line.y[0] for line in drawn(figure, "Feed")} == {300.0}
    (rate,), (force,) = drawn(figure, "Removal rate"), drawn(figure, "Cutting force")
    np.testing.assert_allclose(rate.y, force.y * 0.1 * 0.06, rtol=1e-6)


def test_overload_is_marked(figure: go.Figure, trace: BucketedRun) -> None:
    marks = next(line for line in drawn(figure, "Power") if line.mode == "markers")
    assert len(marks.x) == int((trace.curve(SimulationSignal.OVERLOAD).high > 0.0).sum())


def test_a_component_that_draws_nothing_is_left_out(simulation: Simulation) -> None:
    figure = run_figure(rows(simulation), TraceKeeper().trace())
    assert not [line for line in drawn(figure, "Power") if line.stackgroup]


def test_workingsteps_stand_where_they_run(figure: go.Figure) -> None:
    (bars,) = drawn(figure, "Workingsteps")
    begins = np.array(bars.x) - 0.5 * np.array(bars.width)
    np.testing.assert_allclose(begins, [0.0, 1.0, 61.0])
    (band,) = figure.layout.shapes
    assert (band.x0, band.x1) == (1.0, 61.0)
    assert "<" not in "".join(bars.text)


def test_thousands_of_workingsteps_have_no_bands(
    simulation: Simulation, trace: BucketedRun
) -> None:
    many = rows(simulation) * (MOST_BANDS // 3 + 1)
    assert not run_figure(many, trace).layout.shapes


@pytest.mark.parametrize(("seconds", "unit"), [(60.0, "s"), (3600.0, "min"), (1e5, "h")])
def test_long_runs_are_in_longer_units(
    simulation: Simulation, trace: BucketedRun, seconds: float, unit: str
) -> None:
    longer = BucketedRun(
        width=1.0,
        begin=trace.begin * seconds / 100.0,
        end=trace.end * seconds / 100.0,
        curves=trace.curves,
    )
    figure = run_figure(rows(simulation), longer)
    assert list(figure.select_xaxes())[-1].title.text == f"time, {unit}"
