"""Raw parts that are bodies: their shape gives engagement and air in plan, feeds and run."""

from pathlib import Path

import numpy as np
import pytest

from optimiser.cuts.fixtured_stock import ClampedStocks
from service.programs.raw_stock import body_map, user_stock
from service.programs.reading import read_program, user_data
from service.requests.advice import AdviceRequest
from service.requests.program_facts import ProgramRequest, RawPart, StockFile
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from service.verbs.optimise.plan_result import ProgramAdvice
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from simulator.library import load_machine
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stock_file import stock_bytes
from stepnc_model.editing.user_data import completed
from stepnc_model.errors import Severity, StepNcError
from stepnc_model.programs.program import Stock
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box

SLOT = Path("examples/parts/paper003_case1.stpnc")
HALF = 50.8 * 8.0 * 6.0
"""Volume of the half of the slot that is still to be milled, mm³."""
PLAN = {"machine": "paper003", "material": "aisi1018"}


@pytest.fixture
def without_raw(tmp_path: Path) -> Path:
    """The slot's program, which says nothing about its raw part."""
    path = tmp_path / "slot.stpnc"
    path.write_text(SLOT.read_text("utf-8").replace("0.1,$,$,#13,", "0.1,$,$,$,"), "utf-8")
    return path


@pytest.fixture
def half_cut(tmp_path: Path) -> StockFile:
    """The plate as a mesh; half of its slot is there already."""
    path = tmp_path / "half.stl"
    plate = [
        box((0.0, 0.0, -12.7), (50.8, 46.8, 0.0)),
        box((0.0, 54.8, -12.7), (50.8, 101.6, 0.0)),
        box((0.0, 46.8, -12.7), (50.8, 54.8, -6.0)),
        box((50.8, 0.0, -12.7), (101.6, 101.6, 0.0)),
    ]
    write_stl(path, np.concatenate(plate))
    return StockFile(path=path)


def advised(file: Path, stock: RawPart) -> ProgramAdvice:
    request = AdviceRequest(stock=stock, is_along_path=True, **PLAN)  # type: ignore[arg-type]
    return optimise(request, AdviceFiles(file=file, dry_run=True))


def test_plan_and_feeds_see_the_shape_of_a_stock(
    without_raw: Path, half_cut: StockFile
) -> None:
    whole = advised(without_raw, "0,0,-12.7,101.6,101.6,0")
    half = advised(without_raw, half_cut)
    volumes = [each.plan.advices[0].cut for each in (whole, half)]
    assert [None if cut is None else cut.volume for cut in volumes] == pytest.approx(
        [2.0 * HALF, HALF], rel=0.03
    )
    assert half.along is not None
    assert whole.along is not None
    run = sum(each.before.volume for each in half.along.steps)
    assert run == pytest.approx(HALF, rel=0.02)
    # Half of the path is in air: there the feed rises, but for the margin before the material.
    assert half.along.time_before == pytest.approx(whole.along.time_before, abs=0.01)
    assert half.along.time_after < whole.along.time_after - 0.5
    [told] = [each for each in half.told if "is a body" in each.message]
    assert told.severity is Severity.NOTE
    assert told.message == (
        "the raw part is a body: engagement, air and removal see its shape; "
        "tool paths are made for the box around it, 0,0,-12.7 to 101.6,101.6,0 mm"
    )
    assert not [each for each in whole.told if "is a body" in each.message]


def test_a_run_cuts_the_shape_of_a_stock(without_raw: Path, half_cut: StockFile) -> None:
    request = SimulationRequest(**PLAN, stock=half_cut)  # type: ignore[arg-type]
    found = simulate(request, RunFiles(file=without_raw))
    assert found.whole.volume == pytest.approx(HALF, rel=0.02)
    told: list[str] = []
    again = simulate(request, RunFiles(file=SLOT), tell=told.append)
    assert again.whole.volume == pytest.approx(found.whole.volume)
    assert any("as given, in place of that of" in each for each in told)


def test_given_data_keep_the_shape_of_a_stock(without_raw: Path, half_cut: StockFile) -> None:
    program = read_program(without_raw, units="iso", stock=half_cut)
    technology = program.workingsteps[0].technology_ref
    request = ProgramRequest(given=(f"{technology}.feedrate=0.005",))
    whole = completed(program, user_data(request))
    assert whole.attributes
    for each in (program, whole.program):
        cut = body_map(each, None, is_turning=False, cell=0.5)
        assert isinstance(cut, MillingStock)
        assert cut.map.volume == pytest.approx(101.6 * 101.6 * 12.7 - HALF, rel=5e-3)


def test_a_body_that_cannot_be_turned_counts_as_the_bar_around_it(tmp_path: Path) -> None:
    path = tmp_path / "block.stl"
    write_stl(path, box((-20.0, -20.0, -150.0), (20.0, 20.0, 2.0)))
    shaft = tmp_path / "shaft.stpnc"
    text = Path("examples/parts/shaft.stpnc").read_text("utf-8")
    shaft.write_text(text.replace("0.02,$,$,#33,", "0.02,$,$,$,"), "utf-8")
    program = read_program(shaft, units="iso", stock=StockFile(path=path))
    stocks = ClampedStocks(program, load_machine("lathe22"), body_map)
    bar = stocks.before(program.workingsteps[0])
    assert isinstance(bar, TurningStock)
    [text] = stocks.assumed.values()
    assert text.startswith("the bar around the raw part counts as solid: ")


def test_a_kept_stock_is_refused_for_a_program(tmp_path: Path) -> None:
    path = tmp_path / "kept.npz"
    stock = MillingStock(Stock(low=(0.0, 0.0, -5.0), high=(9.0, 9.0, 0.0)), cell=0.5)
    path.write_bytes(stock_bytes(stock))
    with pytest.raises(StepNcError, match=r"kept.npz: a kept stock serves NC code only"):
        user_stock(StockFile(path=path))
