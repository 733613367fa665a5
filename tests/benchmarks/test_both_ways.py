"""The same part as STEP-NC and as our own NC code gets the same feeds along its paths."""

import pytest

from benchmarks.both_ways import SAMPLES, both_ways

SAME = 1e-3
"""Greatest relative difference of the time of the moves whose feeds are chosen."""

SLOWER_AS_CODE = {
    "FINISH CONTOUR": "code does not say that only the wall is left, not the floor"
}
"""Milling workingsteps of which STEP-NC knows more."""

FASTER_AS_CODE = {"CENTRE HOLE 1", "CENTRE HOLE 2"}
"""Cycles of one feed whose way back at a feed is a block of its own in code."""

COUNTS = {"bracket": 14, "paper002": 1, "paper003_pocket": 1, "shaft": 5}
"""Workingsteps whose feeds are chosen: reaming is locked, and a thread's feed is its pitch."""


@pytest.mark.parametrize("part", SAMPLES)
def test_code_gets_the_feeds_of_the_step_nc_program(part: str) -> None:
    rows = {row.name: row for row in both_ways(part)}
    assert len(rows) == COUNTS[part]
    for name, row in rows.items():
        if part == "bracket" and name in SLOWER_AS_CODE:
            assert row.ratio > 2.0, name
        elif name in FASTER_AS_CODE:
            assert row.ratio < 0.5, name
        else:
            assert row.ratio == pytest.approx(1.0, abs=SAME), name
