"""The trace is bounded, keeps every peak, and does not see how samples come in chunks."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from service.plots.buckets import MOST, BucketedRun
from service.simulation.run_collector import SimulationSignal, TraceKeeper
from simulator.machine.samples import Samples
from simulator.motion.segments import Floats

SampleMaker = Callable[[Floats, Floats], Samples]
HOUR = 3600.0


def traced(
    make: SampleMaker, time: Floats, force: Floats, ends: Sequence[int] = ()
) -> BucketedRun:
    """The trace of samples that come in chunks."""
    keeper = TraceKeeper()
    borders = [0, *sorted(ends), len(time)]
    for begin, end in pairwise(borders):
        keeper.add(make(time[begin:end], force[begin:end]))
    return keeper.trace()


def columns(trace: BucketedRun) -> Floats:
    """All of a trace."""
    curves = [(curve.low, curve.mean, curve.high) for curve in trace.curves]
    rows = [row for curve in curves for row in curve]
    return np.array([trace.begin, trace.end, *rows])


@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**32 - 1),
    longest=st.sampled_from([0.1, 1.0, 60.0, HOUR, 100.0 * HOUR]),
    ends=st.lists(st.integers(0, 500), max_size=6),
)
def test_chunks_do_not_matter(
    samples_at: SampleMaker, seed: int, longest: float, ends: list[int]
) -> None:
    random = np.random.default_rng(seed)
    time = np.sort(random.uniform(0.0, longest, 500))
    force = random.normal(0.0, 1000.0, 500)
    force[random.random(500) < 0.1] = np.nan
    whole = traced(samples_at, time, force)
    parts = traced(samples_at, time, force, ends)
    assert parts.width == whole.width
    np.testing.assert_array_equal(columns(parts), columns(whole))


@pytest.mark.parametrize(
    ("seconds", "rate"), [(1.0, 10_000.0), (600.0, 100.0), (HOUR, 10.0), (100.0 * HOUR, 0.5)]
)
def test_any_run_takes_at_most_the_same_room(
    samples_at: SampleMaker, seconds: float, rate: float
) -> None:
    time = np.arange(seconds * rate + 1.0) / rate
    trace = traced(samples_at, time, np.sin(time))
    assert len(trace.begin) <= MOST
    # Half of the buckets at least are in use, unless there are fewer samples.
    assert len(trace.begin) >= min(MOST // 2, len(time) // 2)
    assert (trace.begin[0], trace.end[-1]) == (0.0, time[-1])


def test_a_peak_of_one_sample_survives_a_long_run(samples_at: SampleMaker) -> None:
    time = np.arange(200_000.0)
    force = np.full(len(time), 10.0)
    force[123_456], force[150_000] = 5000.0, -7.0
    curve = traced(samples_at, time, force).curve(SimulationSignal.FORCE)
    assert (curve.high.max(), curve.low.min()) == (5000.0, -7.0)


def test_a_bucket_lies_between_its_samples(samples_at: SampleMaker) -> None:
    time = np.arange(50_000) / 10.0
    trace = traced(samples_at, time, 100.0 * np.sin(time))
    curve = trace.curve(SimulationSignal.FORCE)
    assert (curve.low <= curve.mean).all()
    assert (curve.mean <= curve.high).all()
    assert (trace.end - trace.begin < trace.width).all()
    assert (trace.end[:-1] < trace.begin[1:]).all()


def test_components_add_up_to_the_total(trace: BucketedRun) -> None:
    parts = [
        trace.curve(SimulationSignal(row)).mean for row in range(SimulationSignal.TOTAL_POWER)
    ]
    np.testing.assert_allclose(
        sum(parts), trace.curve(SimulationSignal.TOTAL_POWER).mean, rtol=1e-12
    )


def test_signals_are_what_they_are_called(samples_at: SampleMaker) -> None:
    trace = traced(samples_at, np.zeros(1), np.full(1, 1000.0))
    found = {signal: float(trace.curve(signal).mean[0]) for signal in SimulationSignal}
    assert found == {
        SimulationSignal.X_POWER: 1.0,
        SimulationSignal.Y_POWER: 2.0,
        SimulationSignal.Z_POWER: 3.0,
        SimulationSignal.SPINDLE_POWER: 2100.0,
        SimulationSignal.COOLANT_POWER: 500.0,
        SimulationSignal.BASE_POWER: 1200.0,
        SimulationSignal.TOTAL_POWER: 3806.0,
        SimulationSignal.FEED_PROGRAMMED: 5.0,
        SimulationSignal.FEED_ACTUAL: 5.0,
        SimulationSignal.SPINDLE_SPEED: 20.0,
        SimulationSignal.FORCE: 1000.0,
        SimulationSignal.REMOVAL_RATE: 100.0,
        SimulationSignal.OVERLOAD: 1.0,
    }


def test_missing_samples_leave_a_gap_and_no_trace_elsewhere(samples_at: SampleMaker) -> None:
    time = np.arange(3.0)
    trace = traced(samples_at, time, np.array([1.0, np.nan, 3.0]))
    np.testing.assert_array_equal(trace.curve(SimulationSignal.FORCE).mean, [1.0, np.nan, 3.0])
    assert trace.curve(SimulationSignal.BASE_POWER).low.min() == 1200.0


def test_no_samples_make_no_trace() -> None:
    assert columns(TraceKeeper().trace()).shape[1] == 0
