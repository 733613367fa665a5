"""Raw parts of NC code: numbers, meshes, and what earlier runs left."""

from pathlib import Path

import pytest

from service.programs.raw_stock import GivenStock, raw_stock_of, stock_map
from service.requests.program_facts import StockFile, raw_part_in
from simulator.library import load_machine
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stock_file import stock_bytes
from stepnc_model.errors import StepNcError
from stepnc_model.programs.program import Stock
from tests.every_case import every_case
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box
from tests.extras.verification.model.meshes import revolved

MILL, LATHE = load_machine("vmc15"), load_machine("lathe22")
BLOCK = Stock(low=(0.0, 0.0, -20.0), high=(60.0, 40.0, 0.0))
BAR = Stock(low=(-10.0, -10.0, -30.0), high=(10.0, 10.0, 0.0), radius=10.0)


def mesh_file(folder: Path, *, is_round: bool = False) -> StockFile:
    file = folder / "part.stl"
    ends = [(-30.0, 0.0), (-30.0, 10.0), (0.0, 10.0), (0.0, 0.0)]
    write_stl(file, revolved(ends) if is_round else box((0.0, 0.0, -20.0), (60.0, 40.0, 0.0)))
    return StockFile(path=file)


def kept_file(folder: Path, stock: MillingStock | TurningStock) -> StockFile:
    file = folder / "kept.npz"
    file.write_bytes(stock_bytes(stock))
    return StockFile(path=file)


def test_numbers_are_a_box_or_a_bar() -> None:
    assert raw_stock_of("0,0,-20,60,40,0").bounds == BLOCK
    assert raw_stock_of("20,-30,0").bounds == BAR
    assert raw_stock_of("20,30").bounds == BAR
    assert isinstance(stock_map(MILL, raw_stock_of("20,30")), MillingStock)
    assert isinstance(stock_map(LATHE, raw_stock_of("20,30")), TurningStock)


def test_a_mesh_is_a_stock(tmp_path: Path) -> None:
    raw = raw_stock_of(mesh_file(tmp_path))
    assert raw.bounds == BLOCK
    stock = stock_map(MILL, raw)
    assert isinstance(stock, MillingStock)
    assert stock.map.volume == pytest.approx(60.0 * 40.0 * 20.0)


def test_a_round_mesh_is_turned(tmp_path: Path) -> None:
    stock = stock_map(LATHE, raw_stock_of(mesh_file(tmp_path, is_round=True)))
    assert isinstance(stock, TurningStock)
    assert stock.outer.max() == pytest.approx(10.0)


def test_a_block_as_a_mesh_is_not_turned(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match=r"part.stl: .*a turned part needs a closed mesh"):
        stock_map(LATHE, raw_stock_of(mesh_file(tmp_path)))


def test_a_kept_stock_serves_the_same_kind_of_machine(tmp_path: Path) -> None:
    milled = raw_stock_of(kept_file(tmp_path, MillingStock(BLOCK, cell=0.5)))
    assert milled.bounds == BLOCK
    assert stock_map(MILL, milled) is milled.kept
    with pytest.raises(StepNcError, match=r"kept.npz: was kept by a mill, but lathe22 is none"):
        stock_map(LATHE, milled)
    turned = raw_stock_of(kept_file(tmp_path, TurningStock(BAR, 0.1)))
    assert stock_map(LATHE, turned) is turned.kept
    with pytest.raises(StepNcError, match=r"kept.npz: was kept by a lathe, but vmc15 is none"):
        stock_map(MILL, turned)


def test_a_bar_beside_the_axis_stands_on_a_mill_only() -> None:
    raw = raw_stock_of("5,-7,20,-30,0")
    stock = stock_map(MILL, raw)
    assert isinstance(stock, MillingStock)
    assert stock.map.volume == pytest.approx(100.0 * 3.14159 * 30.0, rel=1e-3)
    with pytest.raises(StepNcError) as refused:
        stock_map(LATHE, raw)
    assert str(refused.value) == (
        "stock: the bar's axis lies at x = 5 mm; lathe22 turns it about x = y = 0"
    )


@every_case(
    ("text", "told"),
    [
        ("raw", "stock 'raw'"),
        ("1,2,3,4", "stock '1,2,3,4'"),
        ("0,0,0,10,0,5", "stock: y from 0 to 0 mm: must span at least 0.01 mm"),
        ("missing.stl", "missing.stl: No such file"),
        ("missing.npz", "missing.npz: No such file"),
    ],
)
def test_what_is_no_stock_is_refused(text: str, told: str) -> None:
    with pytest.raises(StepNcError) as refused:
        raw_stock_of(raw_part_in(text))
    assert str(refused.value).startswith(told)


def test_a_mesh_without_height_is_refused_with_its_file(tmp_path: Path) -> None:
    file = tmp_path / "flat.stl"
    write_stl(file, box((0.0, 0.0, 0.0), (60.0, 40.0, 0.001)))
    with pytest.raises(StepNcError, match=r"flat.stl: stock: z from 0 to 0.001 mm: must span"):
        raw_stock_of(StockFile(path=file))


def test_a_mesh_too_far_away_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="stock: z from 0 to 200000 mm"):
        stock_map(MILL, GivenStock(bounds=Stock(low=(0, 0, 0), high=(1, 1, 2e5))))
