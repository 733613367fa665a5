"""Usual numbers of teeth."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.spec import ToolKind
from simulator.tools.usual_teeth import usual_teeth


@given(st.sampled_from(ToolKind), st.floats(0.1, 200.0), st.sampled_from(["", *"PMKNSH"]))
def test_the_usual_number_lies_in_its_range(
    kind: ToolKind, diameter: float, group: str
) -> None:
    found = usual_teeth(kind, diameter, iso_group=group)
    assert 1 <= found.least <= found.usual <= found.most


@pytest.mark.parametrize(("group", "least"), [("P", 2), ("N", 1), ("", 1)])
def test_single_flutes_are_for_soft_materials(group: str, least: int) -> None:
    assert usual_teeth(ToolKind.ENDMILL, 6.0, iso_group=group).least == least
