"""Every workingstep of the printed parts keeps its promise: 5 % of loads, 1 % of time."""

from collections.abc import Iterator
from functools import cache

import pytest

from benchmarks.promised import EX1, PARTS, confirmed
from service.confirmation import Confirmation, Figure

LOADS, TIME = 0.05, 0.01


@cache
def run(name: str) -> Confirmation:
    if name == EX1.name and not EX1.exists():
        pytest.skip("ex1.stp is not beside the project")
    (part,) = (part for part in PARTS if part[0].name == name)
    return confirmed(*part)


def figures(name: str) -> Iterator[tuple[str, Figure]]:
    """All that must hold, with the workingstep."""
    for step in run(name).steps:
        for figure in step.figures:
            yield step.id, figure


@pytest.mark.parametrize(
    ("name", "steps"), [("bracket.stpnc", 16), ("shaft.stpnc", 5), ("ex1.stp", 5)]
)
def test_every_figure_is_found_as_promised(name: str, steps: int) -> None:
    assert len(run(name).steps) == steps
    for step, figure in figures(name):
        if figure.ratio is None:
            assert figure.found == 0.0, (step, figure.key)
            continue
        tolerance = TIME if figure.key == "time_s" else LOADS
        assert figure.ratio == pytest.approx(1.0, abs=tolerance), (step, figure.key)


@pytest.mark.parametrize("name", ["bracket.stpnc", "shaft.stpnc", "ex1.stp"])
def test_no_bound_is_passed(name: str) -> None:
    assert run(name).passed == ()
