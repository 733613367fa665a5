"""Raw parts that NC programs state."""

import pytest

from stepnc_model.nc.program import read_program
from stepnc_model.nc.stated_stock import StatedStock, stated_stock
from stepnc_model.post.blocks import MachineType
from stepnc_model.post.dialect import Dialect
from stepnc_model.programs.program import Stock


def stock_of(code: str, dialect: Dialect, machine: MachineType | None = None) -> StatedStock:
    """Raw part that a program states."""
    return stated_stock(read_program(code.encode(), dialect=dialect, machine=machine))


def klartext(*lines: str, unit: str = "MM") -> StatedStock:
    """Raw part of a Klartext program."""
    body = "\n".join((f"BEGIN PGM A {unit}", *lines, f"END PGM A {unit}", ""))
    return stock_of(body, Dialect.HEIDENHAIN)


PLATE = Stock(low=(-50.0, -40.0, -20.0), high=(50.0, 40.0, 0.0))
BAR = Stock(low=(-25.0, -25.0, -80.0), high=(25.0, 25.0, 1.0), radius=25.0)


@pytest.mark.parametrize(
    "corners",
    [
        ("BLK FORM 0.1 Z X-50 Y-40 Z-20", "BLK FORM 0.2 X+50 Y+40 Z+0"),
        ("1 BLK FORM 0.1 Z  X-50  Y-40 Z-20", "2 BLK FORM 0.2 IX+100 IY+80 IZ+20"),
    ],
)
def test_klartext_names_two_corners(corners: tuple[str, str]) -> None:
    assert klartext(*corners).stock == PLATE


def test_klartext_names_a_bar_by_radius_or_diameter() -> None:
    assert klartext("BLK FORM CYLINDER Z R25 L81 DIST+1").stock == BAR
    assert klartext("BLK FORM CYLINDER Z D50 L81 DIST+1 ; bar").stock == BAR


def test_inches_become_mm() -> None:
    found = klartext("BLK FORM 0.1 Z X+0 Y+0 Z-1", "BLK FORM 0.2 X+2 Y+1 Z+0", unit="INCH")
    assert found.stock is not None
    assert found.stock.high == pytest.approx((50.8, 25.4, 0.0))


@pytest.mark.parametrize(
    ("arguments", "stock"),
    [
        (',"",,"BOX",112,0,-20,-80,-50,-40,50,40', PLATE),
        (',,,"BOX",0,0,-20,-80,-50,-40,100,80', PLATE),
        (',"",,"RECTANGLE",64,0,-20,-80,100,80', PLATE),
        (',,,"CYLINDER",192,1,-80,-80,50', BAR),
        (',,,"CYLINDER",0,1,-81,-81,50', BAR),
    ],
)
def test_sinumerik_names_shape_and_corners(arguments: str, stock: Stock) -> None:
    code = f"G17 G710\nWORKPIECE({arguments})\nM30\n"
    assert stock_of(code, Dialect.SINUMERIK).stock == stock


def test_a_box_is_no_bar_of_a_lathe() -> None:
    code = 'G18\nWORKPIECE(,,,"BOX",112,0,-20,-80,0,0,9,9)\nM30\n'
    found = stock_of(code, Dialect.SINUMERIK, MachineType.LATHE)
    assert found.stock is None
    assert "lathe" in found.findings[0].message


def test_a_comment_names_the_size_and_the_zero_in_it() -> None:
    found = stock_of("(STOCK/BLOCK, 100., 80., 20., 50., 40., 20.)\nG21\n", Dialect.FANUC)
    assert found.stock == PLATE
    assert found.line == 1


@pytest.mark.parametrize(
    "code",
    [
        "(STOCK/BLOCK,1,2)\nG21\n",
        "(STOCK/BLOCK,0,2,3,0,0,0)\nG21\n",
        "(STOCK/BLOCK,1,2,3,0,0,0)\n(STOCK/BLOCK,1,2,4,0,0,0)\nG21\n",
    ],
)
def test_what_cannot_be_read_or_contradicts_itself_is_told(code: str) -> None:
    found = stock_of(code, Dialect.FANUC)
    assert found.stock is None
    assert found.findings


def test_a_program_without_a_statement_has_none() -> None:
    assert stock_of("G21\nG1 X1 F1\n", Dialect.FANUC) == StatedStock(stock=None)
