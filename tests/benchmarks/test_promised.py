"""Plans keep their word: figures of the run within 5 % of the plan, and no bound passed."""

import pytest

from benchmarks.promised import WITHIN, cases, confirmed, is_compared, off

KINDS = (
    "bracket vmc15 inconel718",
    "bracket vmc15 feed only",
    "shaft lathe22 inconel718",
    "shaft lathe22 free speed",
    "paper003_pocket paper003",
)
"""Short holes, slivers on the stock, shoulders, late spindles, stated limits."""


@pytest.mark.parametrize("name", KINDS)
def test_a_run_finds_what_its_plan_promised(name: str) -> None:
    (case,) = (each for each in cases() if each.name == name)
    found = confirmed(case)
    far = [
        (step.id, figure.heading, figure.ratio)
        for step in found.steps
        for figure in step.figures
        if is_compared(figure) and off(figure) > WITHIN
    ]
    assert far == []
    passed = [
        (step.id, figure.heading)
        for step in found.steps
        for figure in step.figures
        if step.is_advised and figure.is_passed
    ]
    assert passed == []
