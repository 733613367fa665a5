"""Caution with NC code: moves that meet no stock, straight plunges, and the greatest rise."""

import gc
import re
import weakref
from dataclasses import replace

import numpy as np
import pytest

from service.requests.advice import AdviceRequest
from service.verbs.optimise.code_result import CodeAdvice
from simulator.removal.engage import MillingStock
from tests.every_case import every_case
from tests.service.along_path.foreign import MILL, advised

TOOLS = "number,kind,diameter_mm,teeth,centre_cutting\n1,endmill,10,3,true\n2,drill,8,2,true\n"
UNKNOWN_CENTRE = TOOLS.replace(",true", ",")
BLOCK = replace(MILL, stock="-20,-20,-20,70,40,0")
HEAD = "%\nO0001\nG21 G90 G17\nT1 M6\nS5000 M3\nG0 G54 X-10. Y5.\nG43 H1 Z5.\n"
SLOT = "G1 Z-2. F500.\nX60. F500.\nG0 Z50.\n"
END = "M30\n%\n"
DRILL = "T2 M6\nS2000 M3\nG0 G54 X10. Y20.\nG43 H2 Z50.\n"
IN_BLOCK = "G81 X10. Y20. Z-10. R2. F200.\nG80\n"
PLUNGE = HEAD.replace("X-10. Y5.", "X20. Y20.") + "G1 Z-15. F100.\nX50. F400.\nG0 Z50.\n" + END

FEED = re.compile(rb"F([0-9.]+)")


def advice(text: str, request: AdviceRequest = BLOCK, *, tools: str = TOOLS) -> CodeAdvice:
    return advised(text, request, tools=tools)


def lines_of(text: str, request: AdviceRequest = BLOCK, *, tools: str = TOOLS) -> list[str]:
    return advice(text, request, tools=tools).rewritten.data.decode().splitlines()


def said(found: CodeAdvice, words: str) -> list[str]:
    return [each.message for each in found.findings if words in each.message]


@every_case(
    "moves",
    [
        "G81 X90. Y30. Z5. R22. F200.\nG80\n",  # beside the stock and above it
        "G83 X20. Y20. Z5. R22. Q4. F200.\nG80\n",  # above the stock
        "G0 X90. Y30.\nG1 Z5. F200.\nG0 Z50.\n",  # without a cycle
    ],
)
def test_a_drill_that_meets_no_stock_keeps_its_feed(moves: str) -> None:
    found = advice(HEAD + SLOT + DRILL + moves + IN_BLOCK + "G0 Z50.\n" + END)
    assert moves.encode() in found.rewritten.data
    (text,) = said(found, "drilling move")
    assert text.startswith(
        "T2: 1 drilling move at cutting feed meets no stock: its feed is kept"
    )
    assert b"G81 X10. Y20. Z-10. R2. F200." not in found.rewritten.data


def test_a_move_near_the_stock_that_meets_none_keeps_its_feed() -> None:
    found = advice(HEAD + SLOT + "X-30. Y5.\nZ3.\nG1 X60. F300.\nG0 Z50.\n" + END)
    assert b"G1 X60. F300." in found.rewritten.data
    (text,) = said(found, "within 5 mm of it")
    assert text.startswith("T1: 1 move at cutting feed meets no stock")


@every_case(
    "moves",
    [
        "X-30. Y5.\nZ10.\nG1 X60. F300.\nG0 Z50.\n",  # outside with clearance
        "X-10. Y5.\nZ-2.\nG1 X60. F300.\nG0 Z50.\n",  # where the first pass was
    ],
)
def test_air_that_the_stock_or_the_program_explains_is_faster(moves: str) -> None:
    found = advice(HEAD + SLOT + "G0 " + moves + END)
    assert not said(found, "meets no stock")
    last = found.rewritten.data.splitlines()[-4]
    assert float(FEED.findall(last)[0]) == 900.0


BESIDE = "G0 X-30. Y{y}.\nZ-2.\nG1 X80. F300.\nG0 Z50.\n"
"""Pass along the far edge of the block, which ends at y = 40, with a mill of 10 mm."""


def test_a_pass_beside_the_stock_is_not_explained_by_the_one_before_it() -> None:
    """The first pass took the last 7 mm of the given block; the second lies beside it."""
    found = advice(HEAD + SLOT + BESIDE.format(y=38) + BESIDE.format(y=44) + END)
    first, second = (
        float(FEED.findall(line)[-1])
        for line in found.rewritten.data.splitlines()
        if line.startswith(b"G1 X80.") or line.startswith(b"X80.")
    )
    assert first > 300.0
    assert second == 300.0
    (text,) = said(found, "within 5 mm of it")
    assert text.startswith("T1: 1 move at cutting feed meets no stock")


def test_no_stock_outlives_its_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where the larger one was asked for; a circle would keep it until a collection."""
    made: list[weakref.ref[MillingStock]] = []
    make = MillingStock.__init__

    def noted(self: MillingStock, *args: object, **named: object) -> None:
        make(self, *args, **named)  # type: ignore[arg-type]
        made.append(weakref.ref(self))

    monkeypatch.setattr(MillingStock, "__init__", noted)
    other = (HEAD + SLOT).replace("F500", "F510")  # no test has asked for its advice
    gc.disable()
    try:
        found = advice(other + BESIDE.format(y=38) + BESIDE.format(y=44) + END)
        left = [each for each in made if each() is not None]
    finally:
        gc.enable()
    assert said(found, "within 5 mm of it")
    assert len(made) > 4
    assert not left


def test_a_way_back_through_a_pass_that_goes_beyond_the_stock_is_faster() -> None:
    back = BESIDE.format(y=38).replace("G0 Z50.\n", "X-30. F300.\nG0 Z50.\n")
    found = advice(HEAD + SLOT + back + END)
    assert not said(found, "meets no stock")
    assert b"X-30. F900." in found.rewritten.data


def test_a_straight_plunge_keeps_its_feed_unless_it_may_be_faster() -> None:
    for tools in (TOOLS, UNKNOWN_CENTRE):
        assert "G1 Z-15. F100." in lines_of(PLUNGE, tools=tools)
    allowed = replace(BLOCK, allow_plunge=True, greatest_rise=100.0)
    # 750 mm/min, half of 0.1 mm a tooth, over the depth in diameters
    assert "F500." in next(each for each in lines_of(PLUNGE, allowed) if "G1 Z-1" in each)
    pecks = PLUNGE.replace("G1 Z-15. F100.", "G1 Z-8. F100.\nG0 Z1.\nZ-7.9\nG1 Z-15. F100.")
    feeds = FEED.findall(advice(pecks, allowed).rewritten.data)
    assert set(map(float, feeds[:2])) == {750.0}


def test_a_rise_is_bounded_and_its_cost_is_told_by_tool() -> None:
    slow = HEAD + SLOT.replace("F500", "F100") + END
    found = advice(slow)
    feeds = list(map(float, FEED.findall(found.rewritten.data)))
    assert max(feeds) == 300.0
    (text,) = said(found, "--greatest-rise")
    (cost,) = map(float, re.findall(r"costs T1 ([0-9.]+) s", text))
    more = advice(slow, replace(BLOCK, greatest_rise=100.0))
    assert max(map(float, FEED.findall(more.rewritten.data))) == 1125.0
    gained = found.along.time_after - more.along.time_after
    assert abs(cost - gained) < 0.1 * gained


@every_case("rise", [3.0, 1.5, 6.0])
def test_feeds_that_rose_rise_no_further(rise: float) -> None:
    request = replace(BLOCK, greatest_rise=rise)
    once = advice(HEAD + SLOT.replace("F500", "F100") + END, request)
    text = once.rewritten.data.decode()
    twice = advice(text, request)
    assert twice.rewritten.data == once.rewritten.data
    assert np.isclose(max(map(float, FEED.findall(once.rewritten.data))), 100.0 * rise)
    assert said(twice, "rose before")
    further = advice(text, replace(BLOCK, greatest_rise=2.0 * rise))
    assert np.isclose(
        max(map(float, FEED.findall(further.rewritten.data))), min(200.0 * rise, 1125.0)
    )
