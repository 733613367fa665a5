"""Stocks of the sample parts, one for each setup."""

from pathlib import Path

import pytest

from optimiser.cuts.fixtured_stock import ClampedStocks, met_by
from simulator.library import load_machine
from simulator.motion.segments import Leg, lines
from simulator.motion.tool_path import ToolPathRun
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.zmap import MOST_CELLS
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, Stock

PARTS = Path(__file__).parents[3] / "examples" / "parts"

BLOCK = Stock(low=(-3.0, -3.0, -40.0), high=(153.0, 93.0, 2.0))
"""Raw part of the bracket."""


def program(part: str, *change: str) -> Program:
    text = (PARTS / f"{part}.stpnc").read_text()
    if change:
        assert change[0] in text
        text = text.replace(change[0], change[1])
    return Program(Part21File.from_bytes(text.encode(), name=part), name=part)


def straight(*points: tuple[float, float, float], speed: float = 5.0) -> ToolPathRun:
    """A path that ends nowhere near a control."""
    segments = lines(points, speed=speed)
    count = len(segments)
    return ToolPathRun(
        moves=(),
        segments=segments,
        spindle=segments.speed,
        is_clockwise=True,
        legs=(Leg(first=0, last=count, wait=0.0),),
    )


ALONG = ((9.0, -12.0, 0.0), (9.0, 312.0, 0.0))


def test_what_is_cut_is_gone_for_the_next() -> None:
    """18 mm × 300 mm × 3 mm, once."""
    part = program("paper002")
    step = part.workingsteps[0]
    stocks = ClampedStocks(part, load_machine("paper002"))
    for expected in (18.0 * 300.0 * 3.0, 0.0):
        found = met_by(part, step, straight(*ALONG), stocks.before(step))
        assert found.why == ""
        assert found.met is not None
        assert found.met.volume == pytest.approx(expected, rel=1e-3)
        stocks.leave(step, found.change)


@pytest.mark.parametrize("part", ["paper002", "shaft"])
def test_only_the_path_that_was_left_last_counts(part: str) -> None:
    mill = part == "paper002"
    read = program(part)
    step = read.workingsteps[0]
    stocks = ClampedStocks(read, load_machine("paper002" if mill else "lathe22"))
    along = ALONG if mill else ((40.0, 0.0, 9.0), (15.0, 0.0, 0.0), (15.0, 0.0, -60.0))
    found = met_by(read, step, straight(*along), stocks.before(step))
    stocks.leave(step, found.change)
    stocks.leave(step, None)
    again = met_by(read, step, straight(*along), stocks.before(step))
    stocks.leave(step, again.change)
    last = met_by(read, step, straight(*along), stocks.before(step))
    volumes = [each.met.volume for each in (found, again, last) if each.met is not None]
    assert volumes[0] == volumes[1] > 1.0
    assert volumes[2] < 1e-6


def test_cells_suit_the_smallest_tool_within_reason() -> None:
    """Tools of 6 mm in 156 mm × 96 mm."""
    part = program("bracket")
    stock = ClampedStocks(part, load_machine("vmc15")).before(part.workingsteps[0])
    assert isinstance(stock, MillingStock)
    assert stock.map.cell <= 6.0 / 16.0
    # Slivers thinner than a cell must be met alike by plan and run.
    as_run = MillingStock(BLOCK, smallest_diameter=6.0)
    assert stock.map.cell == as_run.map.cell
    assert stock.map.grid.heights.size < MOST_CELLS


def test_a_lathe_holds_a_bar() -> None:
    part = program("shaft")
    stock = ClampedStocks(part, load_machine("lathe22")).before(part.workingsteps[0])
    assert isinstance(stock, TurningStock)


def test_a_file_without_a_stock_has_none() -> None:
    part = program("paper002", "0.1,$,$,#13,());", "0.1,$,$,$,());")
    step = part.workingsteps[0]
    stock = ClampedStocks(part, load_machine("paper002")).before(step)
    assert met_by(part, step, straight(*ALONG), stock).why == "the stock is not known"


def test_a_stock_without_volume_is_none() -> None:
    part = program("paper002", "18.,300.,43.);", "18.,300.,0.);")
    assert ClampedStocks(part, load_machine("paper002")).before(part.workingsteps[0]) is None


def test_what_is_not_modelled_is_said() -> None:
    part = program("shaft")
    lathe, mill = load_machine("lathe22"), program("paper002")
    thread = next(step for step in part.workingsteps if step.id == "THREAD M30 X 2")
    bar = ClampedStocks(part, lathe).before(thread)
    box = ClampedStocks(mill, load_machine("vmc15")).before(mill.workingsteps[0])
    assert (
        met_by(part, thread, straight(*ALONG), bar).why
        == "threads and knurls are not simulated in the stock"
    )
    roughing = part.workingsteps[0]
    assert met_by(part, roughing, straight(*ALONG), box).why == "a turning insert cannot mill"
    # A rotating tool beside the axis of a bar.
    why = met_by(mill, mill.workingsteps[0], straight((9, 0, 0), (9, 0, -50)), bar).why
    assert "beside its axis" in why
