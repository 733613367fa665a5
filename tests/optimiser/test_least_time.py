"""No mode, no program and no grid over passes and feeds beats the plan of a sample part."""

from benchmarks.least_time import Sample, comparisons, run_comparisons, sample_of


def test_no_rival_beats_the_bracket() -> None:
    """In this material ROUGH POCKET in two passes once was faster and took less energy."""
    sample = sample_of("bracket", "vmc15", "42crmo4")
    found = list(comparisons(sample))
    assert len(found) == 28
    assert [each for each in found if each.is_beaten] == []
    pockets = [each for each in found if each.workingstep == "ROUGH POCKET"]
    assert all(any("grid" in rival.name for rival in each.rivals) for each in pockets)
    assert_none_is_faster_in_the_run(sample)


def test_no_rival_beats_the_shaft() -> None:
    sample = sample_of("shaft", "lathe22", "42crmo4")
    found = list(comparisons(sample))
    assert found
    assert [each for each in found if each.is_beaten] == []
    assert_none_is_faster_in_the_run(sample)


def assert_none_is_faster_in_the_run(sample: Sample) -> None:
    """The best points of the grid that keep the bounds take no less time on the machine."""
    run = list(run_comparisons(sample, most=2))
    assert run
    assert [each for each in run if each.is_beaten] == []
