"""Panels share the axis of time, and show least and greatest of each bucket."""

import numpy as np
import pytest

from service.plots.buckets import Buckets
from service.plots.panels import BLUE, MOST_BANDS, Panels, TimeSpan, key


def panels(last: float = 100.0) -> Panels:
    buckets = Buckets(1)
    time = np.linspace(0.0, last, 1000)
    buckets.add(time, np.sin(time)[:, None])
    return Panels(buckets.trace())


STEPS = (
    TimeSpan(name="A <b>", begin=0.0, duration=40.0),
    TimeSpan(name="B", begin=40.0, duration=60.0),
)


def test_a_line_goes_through_every_peak() -> None:
    made = panels()
    made.begin("<b>Sine</b>", height=100)
    made.peaks("sine", BLUE, 0, scale=2.0)
    (drawn,) = made.done(STEPS).data
    sine = 2.0 * np.sin(np.linspace(0.0, 100.0, 1000))
    assert max(drawn.y) == pytest.approx(sine.max())
    assert min(drawn.y) == pytest.approx(sine.min())


def test_workingsteps_stand_where_they_run_and_names_are_no_markup() -> None:
    made = panels()
    made.strip(STEPS)
    figure = made.done(STEPS)
    (bars,) = figure.data
    assert list(bars.x) == [20.0, 70.0]
    assert list(bars.width) == [40.0, 60.0]
    assert bars.text[0] == "A &lt;b&gt;"
    (band,) = figure.layout.shapes
    assert (band.x0, band.x1) == (40.0, 100.0)


def test_many_workingsteps_have_no_bands() -> None:
    made = panels()
    made.strip(STEPS)
    assert not made.done(STEPS * MOST_BANDS).layout.shapes


@pytest.mark.parametrize(
    ("last", "unit", "end"), [(60.0, "s", 60.0), (3600.0, "min", 60.0), (36_000.0, "h", 10.0)]
)
def test_long_runs_are_in_longer_units(last: float, unit: str, end: float) -> None:
    made = panels(last)
    made.begin("<b>Sine</b>", height=100)
    axis = made.done(()).layout.xaxis
    assert axis.title.text == f"time, {unit}"
    assert axis.range[1] == pytest.approx(end)


def test_a_key_has_its_colour() -> None:
    assert key("force", "#D55E00", "●") == '<span style="color:#D55E00">●</span> force'
