"""No mode, no program and no grid over passes and feeds beats the plan of the bracket."""

from benchmarks.least_time import Comparison, comparisons


def test_no_rival_beats_the_bracket() -> None:
    """In this material ROUGH POCKET in two passes once was faster and took less energy."""
    found = list(comparisons("bracket", "vmc15", "42crmo4"))
    assert len(found) == 28
    assert [each for each in found if each.is_beaten] == []
    pockets = [each for each in found if each.workingstep == "ROUGH POCKET"]
    assert all(any("grid" in rival.name for rival in each.rivals) for each in pockets)


def test_no_rival_beats_the_shaft() -> None:
    found: list[Comparison] = list(comparisons("shaft", "lathe22", "42crmo4"))
    assert found
    assert [each for each in found if each.is_beaten] == []
