import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.signals.preview import Preview
from simulator.physics.tooth_means import Arcs
from tests.every_case import every_case

STEP = Preview(until=np.arange(1.0, 11.0), force=np.array([1.0] * 5 + [2.0] * 2 + [0.5] * 3))
"""seconds of force 1, 2 and 0.5 from 0, 5 and 7 s on"""


def test_a_step_is_seen_one_revolution_before_it_and_kept_one_behind() -> None:
    ahead = STEP.ahead(0.5, revolution=1.0, count=9)
    # Revolution j lasts from 0.5 + j to 1.5 + j; the step lies in 4.5 to 5.5.
    assert ahead == (1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 0.5)


def test_a_slower_feed_sees_less_far() -> None:
    assert max(STEP.ahead(0.0, revolution=1.0, count=6)) == 2.0
    assert max(STEP.ahead(0.0, revolution=0.5, count=6)) == 1.0


def test_beyond_the_end_the_last_force_stays() -> None:
    assert STEP.ahead(9.5, revolution=1.0, count=3) == (0.5, 0.5, 0.5)


def test_the_mean_is_that_of_the_stretches_that_are_touched() -> None:
    assert STEP.mean(0.0, 1.0) == 1.0
    assert STEP.mean(4.5, 5.5) == 1.5
    assert STEP.mean(6.2, 6.3) == 2.0
    assert STEP.mean(20.0, 30.0) == 0.5


@given(
    st.lists(st.floats(0.0, 1e4), min_size=1, max_size=60),
    st.floats(0.0, 70.0),
    st.floats(1e-3, 5.0),
    st.integers(1, 20),
)
def test_no_force_within_a_revolution_of_its_place_is_overlooked(
    forces: list[float], progress: float, revolution: float, count: int
) -> None:
    force = np.array(forces)
    preview = Preview(until=np.arange(1.0, len(force) + 1.0), force=force)
    ahead = preview.ahead(progress, revolution=revolution, count=count)
    assert len(ahead) == count
    for j, value in enumerate(ahead):
        places = progress + revolution * (j + np.linspace(-1.0, 2.0, 50))
        rows = np.clip(np.floor(places).astype(int), 0, len(force) - 1)
        assert value >= force[rows].max()
        assert value in force


@every_case(
    ("until", "force", "why"),
    [
        ([], [], "at least one"),
        ([1.0, 2.0], [1.0], "equal numbers"),
        ([1.0, 1.0], [1.0, 1.0], "ascend"),
        ([1.0, 2.0], [1.0, -1.0], "negative"),
        ([1.0, 2.0], [1.0, float("nan")], "finite"),
    ],
)
def test_impossible_previews_are_refused(
    until: list[float], force: list[float], why: str
) -> None:
    with pytest.raises(ValueError, match=why):
        Preview(until=np.array(until), force=np.array(force))


def test_teeth_are_expected_to_take_what_is_there_when_they_are_the_last_to_enter() -> None:
    at = np.arange(10.0)
    arcs = Arcs(entry_angle=at, exit_angle=at + 1.0, lag=0.1 * at)
    preview = Preview(until=STEP.until, force=STEP.force, arcs=arcs)
    # From 3 to 7 s, a second for each of four teeth, of which the third comes first.
    found = preview.expected(3.0, 7.0, teeth=4, first=2)
    assert found is not None
    assert found.force.tolist() == [2.0, 2.0, 1.0, 1.0]
    assert found.change.tolist() == [1.0, 1.5, 0.0, 1.0]
    assert found.arcs.entry_angle.tolist() == [5.0, 6.0, 3.0, 4.0]
    assert found.arcs.lag == pytest.approx([0.5, 0.6, 0.3, 0.4])


def test_without_arcs_nothing_is_expected_of_single_teeth() -> None:
    assert STEP.expected(3.0, 7.0, teeth=4, first=0) is None
