"""Time of a program with the pauses of its control."""

import numpy as np
import pytest

from benchmarks.logged_path.cycle_time import (
    NO_PAUSES,
    ObservedTime,
    Pauses,
    ProgramRun,
    fitted_pauses,
)
from simulator.errors import CalibrationError
from simulator.motion.control import ExactStop
from simulator.motion.segments import AxisLimits, lines

# 10 mm at 5 mm/s and 500 mm/s²: 10/5 + 5/500 s each.
PATH = lines([(0, 0, 0), (10, 0, 0), (10, 10, 0), (0, 10, 0)], speed=5.0)
LEG = 2.01
LIMITS = AxisLimits(
    acceleration=np.full(3, 500.0), rapid=np.full(3, np.inf), feed=np.full(3, np.inf)
)
PAUSES = Pauses(per_block=0.02, per_block_half=0.0, at_start=0.5, at_start_half=0.0)


def run(pauses: Pauses) -> ProgramRun:
    return ProgramRun(
        segments=PATH, motion=ExactStop().plan(PATH, LIMITS), pauses=pauses, start_block=1
    )


def test_pauses_come_to_the_motion() -> None:
    assert run(NO_PAUSES).duration == pytest.approx(3 * LEG)
    assert run(PAUSES).duration == pytest.approx(3 * LEG + 0.5 + 3 * 0.02)


def test_spindle_starts_when_its_block_would() -> None:
    assert run(PAUSES).spindle_start == pytest.approx(LEG + 0.02)


def test_axes_stand_while_the_control_pauses() -> None:
    state = run(PAUSES).at(np.array([1.0, LEG + 0.3, LEG + 0.52 + 1.0]))
    np.testing.assert_allclose(np.linalg.norm(state.velocity, axis=1), [5.0, 0.0, 5.0])
    np.testing.assert_allclose(state.position[1], [10.0, 0.0, 0.0], atol=1e-9)


def test_time_at_a_station_is_the_inverse_of_the_position() -> None:
    program = run(PAUSES)
    for station in (0.0, 3.0, 10.0, 14.2, 29.9):
        state = program.at(np.array([program.time_at(station)]))
        found = 10.0 * state.segment[0] + state.station[0]
        assert found == pytest.approx(station, abs=0.02)
    assert program.time_at(30.5) == program.duration


def test_blocks_before_a_station_are_counted() -> None:
    program = run(PAUSES)
    assert [program.blocks_before(station) for station in (5.0, 10.0, 25.0)] == [0, 1, 2]


def observed(blocks: int, seconds: float) -> ObservedTime:
    return ObservedTime(seconds=20.0 + seconds, motion=20.0, blocks=blocks)


def test_pauses_are_found_from_runs_of_different_length() -> None:
    runs = [observed(n, 0.3 + 0.014 * n) for n in (20, 100, 100, 60)]
    found = fitted_pauses(runs)
    assert found.per_block == pytest.approx(0.014)
    assert found.at_start == pytest.approx(0.3)
    assert found.per_block_half == pytest.approx(0.0, abs=1e-9)


def test_interval_holds_the_truth() -> None:
    noise = (0.05, -0.05, 0.03, -0.02, 0.01)
    runs = [
        observed(n, 0.3 + 0.014 * n + e)
        for n, e in zip((20, 100, 100, 60, 40), noise, strict=True)
    ]
    found = fitted_pauses(runs)
    assert abs(found.per_block - 0.014) < found.per_block_half
    assert abs(found.at_start - 0.3) < found.at_start_half


def test_pauses_are_never_negative() -> None:
    found = fitted_pauses([observed(n, -0.1) for n in (20, 60, 100)])
    assert (found.per_block, found.at_start) == (0.0, 0.0)


@pytest.mark.parametrize("blocks", [(10, 20), (10, 10, 10)])
def test_too_little_to_tell_the_pauses_apart_is_refused(blocks: tuple[int, ...]) -> None:
    with pytest.raises(CalibrationError, match="at least 3 runs"):
        fitted_pauses([observed(n, 0.1) for n in blocks])
