"""Places that are too deep for their width, by the rule of a workingstep."""

from dataclasses import replace

import numpy as np
import pytest

from optimiser.along_path.deep_places import deep_places, with_deep_places
from optimiser.along_path.stretch import PathStretch
from optimiser.bounds.limits import depth_by_diameter
from tests.optimiser.along_path.stretches import BOUNDS, half_cut, straight, stretch_of


def cut_at(depth: float, exit_angle: float) -> PathStretch:
    """20 mm that cut on the second half, from φ = 0 to an exit angle."""
    met = half_cut([10.0, 10.0], [False, True])
    angle = np.array([0.0, exit_angle])
    met = replace(
        met,
        segment=np.arange(2),
        axial_depth=np.array([0.0, depth]),
        exit_angle=angle,
        contact_angle=angle,
        section=np.array([0.0, depth * 6.0 * (1.0 - np.cos(exit_angle))]),
        radial_width=np.array([0.0, 6.0 * (1.0 - np.cos(exit_angle))]),
    )
    return replace(stretch_of(straight([10.0, 10.0])), met=met, bounds=BOUNDS, workingstep="T1")


@pytest.mark.parametrize("exit_angle", [0.5 * np.pi, 0.7 * np.pi, np.pi])
def test_the_bound_is_that_of_a_workingstep_of_this_width(exit_angle: float) -> None:
    width = 6.0 * (1.0 - np.cos(exit_angle))
    cut, at = replace(BOUNDS.cut, radial_width=width), BOUNDS.at
    assert at.grade is not None
    bound = depth_by_diameter(cut, at, at.grade)
    assert bound is not None
    assert deep_places(cut_at(bound, exit_angle)) is None
    found = deep_places(cut_at(1.1 * bound, exit_angle))
    assert found is not None
    assert found.load.bound == pytest.approx(bound)
    assert found.load.value == pytest.approx(1.1 * bound)
    assert found.width == pytest.approx(width)
    assert found.length == pytest.approx(10.0)
    assert found.block == cut_at(1.0, exit_angle).segments.block[1]


def test_a_path_in_air_is_not_too_deep() -> None:
    assert deep_places(stretch_of(straight([10.0]))) is None
    air = replace(stretch_of(straight([10.0])), bounds=BOUNDS)
    assert deep_places(air) is None
    assert with_deep_places({}, air) == {}


def test_lengths_are_added_and_the_deepest_place_is_kept() -> None:
    deep, deeper = cut_at(40.0, np.pi), cut_at(50.0, np.pi)
    one = with_deep_places(with_deep_places({}, deep), deeper)["T1"]
    other = with_deep_places(with_deep_places({}, deeper), deep)["T1"]
    assert one == other
    assert one.length == pytest.approx(20.0)
    assert one.load.value == pytest.approx(50.0)
