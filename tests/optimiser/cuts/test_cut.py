"""A cut is a value."""

from dataclasses import FrozenInstanceError, replace

import pytest

from optimiser.cuts.cut import CriticalPlace, Cut, CutKind, Texture
from optimiser.solver.problem import Setting
from simulator.physics.engagement import full_immersion
from simulator.spec import ToolKind
from stepnc_model.programs.tool import Tool

CUT = Cut(
    kind=CutKind.MILLING,
    tool=Tool(id="mill", keyword="TAPERED_ENDMILL", diameter=10.0, teeth=3),
    tool_kind=ToolKind.ENDMILL,
    diameter=10.0,
    programmed=Setting(feed=0.05, depth=2.0, passes=2, speed=50.0),
    length=120.0,
    total_depth=4.0,
    is_depth_free=True,
)


def test_nothing_is_assumed_of_a_bare_cut() -> None:
    assert CUT.texture is Texture.NONE
    assert CUT.floor is None
    assert CUT.depth_bound is None
    assert not CUT.is_finishing
    assert not CUT.is_finish_operation
    assert CUT.link_length == 0.0


def test_cut_does_not_change() -> None:
    with pytest.raises(FrozenInstanceError):
        CUT.length = 1.0  # type: ignore[misc]


def test_equal_cuts_are_equal() -> None:
    assert replace(CUT, length=120.0) == CUT
    assert replace(CUT, length=121.0) != CUT


def test_the_hardest_place_is_that_of_the_engagement() -> None:
    assert CUT.hardest is None
    place = replace(CUT, engagement=full_immersion(), depth_share=1.5).hardest
    assert place == CriticalPlace(engagement=full_immersion(), depth_share=1.5)


def test_a_cut_is_air_where_it_is_known_to_remove_nothing() -> None:
    assert not CUT.is_air
    assert not replace(CUT, volume=0.1).is_air
    assert replace(CUT, volume=0.0).is_air
