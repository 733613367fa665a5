"""Stocks that runs leave, hand on, or never touch."""

from pathlib import Path

import numpy as np
import pytest

from service.programs.raw_stock import raw_stock_of
from service.requests.program_facts import StockFile, raw_part_in
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles, Simulation, simulate
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from stepnc_model.errors import StepNcError, WriteError
from tests.asking import asked_simulation
from tests.every_case import every_case

TOOLS = "number,kind,diameter_mm,teeth\n1,endmill,10,4\n2,turning,,\n"
BEGIN = "G21 G90 G94 G17\nT1 M6\nM3 S3000\nG0 X-10 Y10 Z5\nG1 Z-2 F600\n"
ALONG, ACROSS, END = "G1 X50\n", "G0 Z5\nG0 X30 Y-10\nG1 Z-4\nG1 Y40\n", "G0 Z5\nM30\n"
RAW = "0,0,-10,40,30,0"


def run(folder: Path, code: str, stock: str, kept: str = "", **more: str) -> Simulation:
    program, tools = folder / "part.ngc", folder / "tools.csv"
    program.write_text(code, encoding="ascii")
    tools.write_text(TOOLS, encoding="ascii")
    request, files = asked_simulation(
        code=CodeRequest(code=program, tools=tools, stock=raw_part_in(stock)),
        machine=more.get("machine", "vmc15"),
        material="c45",
        control="exact-stop",
    )
    place = folder / kept if kept else None
    return simulate(request, RunFiles(code=files.code, kept=place))


def test_a_run_goes_on_with_what_another_left(tmp_path: Path) -> None:
    whole = run(tmp_path, BEGIN + ALONG + ACROSS + END, RAW, "whole.npz")
    first = run(tmp_path, BEGIN + ALONG + END, RAW, "first.npz")
    rest = run(tmp_path, BEGIN + ACROSS + END, str(tmp_path / "first.npz"), "both.npz")
    found = first.whole.volume + rest.whole.volume
    assert found == pytest.approx(whole.whole.volume, rel=2e-3)
    kept = [
        raw_stock_of(StockFile(path=tmp_path / f"{name}.npz")).kept
        for name in ("whole", "both")
    ]
    heights = [each.map.grid.heights for each in kept if isinstance(each, MillingStock)]
    assert len(heights) == 2
    assert np.array_equal(heights[0], heights[1])


def test_a_turned_bar_goes_on(tmp_path: Path) -> None:
    code = (
        "G21 G90 G94 G18\nT2 M6\nM3 S1000\nG0 X45 Z5\nG0 X{0} Z2\nG1 Z-20 F100\nG0 X40\nM30\n"
    )
    whole = run(tmp_path, code.format(18), "40,50", machine="lathe22")
    first = run(tmp_path, code.format(19), "40,50", "bar.npz", machine="lathe22")
    second = run(tmp_path, code.format(18), str(tmp_path / "bar.npz"), machine="lathe22")
    assert first.whole.volume > 0.0
    found = first.whole.volume + second.whole.volume
    assert found == pytest.approx(whole.whole.volume, rel=1e-3)
    assert isinstance(raw_stock_of(StockFile(path=tmp_path / "bar.npz")).kept, TurningStock)


def test_a_stock_that_no_tool_touches_is_told_with_both_spans(tmp_path: Path) -> None:
    simulation = run(tmp_path, BEGIN + ALONG + END, "100,100,-10,140,130,0")
    (finding,) = [each for each in simulation.findings if "touched" in each.message]
    assert finding.message == (
        "no tool touched the stock, which spans x 100 to 140, y 100 to 130, z -10 to 0 mm; the "
        "feed moves span x -10 to 50, y 10 to 10, z -2 to 5 mm: is it in coordinates of the "
        "program?"
    )


def test_a_stock_that_is_cut_already_is_told(tmp_path: Path) -> None:
    run(tmp_path, BEGIN + ALONG + END, RAW, "a.npz")
    simulation = run(tmp_path, BEGIN + ALONG + END, str(tmp_path / "a.npz"))
    (finding,) = [each for each in simulation.findings if "touched" in each.message]
    assert finding.message.endswith("y 10 to 10, z -2 to 5 mm: is it cut already?")


def test_a_stock_that_is_cut_is_not_told(tmp_path: Path) -> None:
    simulation = run(tmp_path, BEGIN + ALONG + END, RAW)
    assert not [each for each in simulation.findings if "touched" in each.message]


def test_rapids_alone_touch_nothing_and_are_not_told(tmp_path: Path) -> None:
    simulation = run(tmp_path, "G21 G90\nT1 M6\nG0 X1 Y1 Z9\nG0 X2\nM30\n", RAW)
    assert not [each for each in simulation.findings if "touched" in each.message]


@every_case(
    ("stock", "kept", "told"),
    [
        ("", "a.npz", "no stock is known that could be kept"),
        (RAW, "a.csv", "must end with .npz"),
        (RAW, "none/a.npz", "the folder does not exist"),
        (RAW, "part.npz", ""),
    ],
)
def test_a_stock_that_cannot_be_kept_is_told_before_the_run(
    tmp_path: Path, stock: str, kept: str, told: str
) -> None:
    if not told:
        run(tmp_path, BEGIN + ALONG + END, stock, kept)
        assert (tmp_path / kept).is_file()
        return
    with pytest.raises(StepNcError, match=told):
        run(tmp_path, BEGIN + ALONG + END, stock, kept)
    assert not (tmp_path / kept).exists()


def test_the_stock_that_is_read_is_not_overwritten(tmp_path: Path) -> None:
    run(tmp_path, BEGIN + ALONG + END, RAW, "a.npz")
    with pytest.raises(WriteError, match="is the same file as"):
        run(tmp_path, BEGIN + ACROSS + END, str(tmp_path / "a.npz"), "a.npz")
