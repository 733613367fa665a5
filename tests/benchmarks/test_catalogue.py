"""Advice for tools and materials of the library beside catalogue windows."""

import random
from dataclasses import replace

import pytest

from benchmarks.catalogue import Case, Verdict, every_case, verdict_of, window_of
from simulator.spec import CuttingMaterial, ToolKind
from tests.every_case import every_case as each_case

CERAMIC, HSS, CARBIDE = CuttingMaterial.CERAMIC, CuttingMaterial.HSS, CuttingMaterial.CARBIDE
STEEL = Case(material="c45", edge=CARBIDE, kind=ToolKind.ENDMILL, diameter=12.0)
CERAMIC_MILL = replace(STEEL, edge=CERAMIC, kind=ToolKind.FACEMILL)


def test_no_advice_lies_above_a_window_without_a_mark() -> None:
    """A sample; ``python -m benchmarks.catalogue`` takes every case."""
    cases = random.Random(59).sample(list(every_case()), 80)
    assert [case for case in cases if verdict_of(case) is Verdict.ABOVE] == []


@each_case(
    ("case", "expected"),
    [
        (STEEL, Verdict.WITHIN),
        (replace(STEEL, edge=HSS, material="hardened_55hrc"), Verdict.IMPOSSIBLE),
        (replace(STEEL, edge=CERAMIC, kind=ToolKind.DRILL), Verdict.IMPOSSIBLE),
        (replace(CERAMIC_MILL, diameter=160.0), Verdict.MARKED),
        (
            replace(STEEL, edge=CERAMIC, kind=ToolKind.TURNING, material="aisi304"),
            Verdict.MARKED,
        ),
        (replace(STEEL, edge=HSS, kind=ToolKind.CENTER_DRILL), Verdict.WITHIN),
    ],
)
def test_what_becomes_of_a_tool_in_a_material(case: Case, expected: Verdict) -> None:
    assert verdict_of(case) is expected


def test_ratios_of_the_diameter_end_at_the_sizes_of_their_source() -> None:
    """c45, ISCAR: 0.01 × D; at D 160 no more than at 20 mm."""
    window = window_of(replace(STEEL, diameter=160.0))
    assert window.feed == pytest.approx(0.2)
    assert window.depth == pytest.approx(40.0)
