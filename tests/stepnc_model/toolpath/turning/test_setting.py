"""Numbers of a strategy."""

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import SchemaError
from stepnc_model.toolpath.task import ToolPathTask
from stepnc_model.toolpath.turning.profile import HalfPlane
from stepnc_model.toolpath.turning.setting import (
    DEFAULT_OVERCUT,
    clearance_of,
    cumulative,
    setting_of,
)


def test_depths_end_at_the_total_and_the_last_is_shallower() -> None:
    assert cumulative(5.0, (2.0,)) == [2.0, 4.0, 5.0]


def test_a_sliver_makes_all_passes_equal() -> None:
    assert cumulative(6.1, (3.0,)) == pytest.approx([6.1 / 3.0, 12.2 / 3.0, 6.1])


def test_a_list_gives_each_pass_its_depth_and_repeats_its_last() -> None:
    assert cumulative(6.0, (3.0, 1.0)) == [3.0, 4.0, 5.0, 6.0]


def test_no_depth_takes_all_at_once_and_nothing_takes_no_pass() -> None:
    assert cumulative(6.0, ()) == [6.0]
    assert cumulative(0.0, (1.0,)) == []


@given(st.floats(0.01, 50.0), st.floats(0.05, 10.0))
def test_no_pass_is_deeper_than_asked(total: float, depth: float) -> None:
    sums = cumulative(total, (depth,))
    assert sums[-1] == total
    assert all(0.0 < b - a <= depth + 1e-5 for a, b in zip([0.0, *sums], sums, strict=False))


def test_directions_and_lengths_are_those_of_the_file(job: Callable[..., ToolPathTask]) -> None:
    setting = setting_of(job("ROUGH CONTOUR"), HalfPlane())
    assert (setting.overcut, setting.link.lift_height) == (1.0, 1.0)
    assert not setting.is_reversed
    assert setting_of(job("FINISH CONTOUR"), HalfPlane()).overcut == DEFAULT_OVERCUT


def test_a_ratio_scales_the_feed(job: Callable[..., ToolPathTask]) -> None:
    at = job("ROUGH CONTOUR", ("(2.),$,#504", "(2.),0.5,#504"))
    assert setting_of(at, HalfPlane()).feeds.cutting.ratio == 0.5


def test_the_clearance_is_the_retract_plane(job: Callable[..., ToolPathTask]) -> None:
    assert (
        clearance_of(job("ROUGH CONTOUR", ("'ROUGH CONTOUR',5.", "'ROUGH CONTOUR',7."))) == 7.0
    )
    with pytest.raises(SchemaError, match="must not be negative"):
        clearance_of(job("ROUGH CONTOUR", ("'ROUGH CONTOUR',5.", "'ROUGH CONTOUR',-7.")))
