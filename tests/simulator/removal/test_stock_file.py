"""Stock that a run leaves and a later one takes."""

import zipfile
from io import BytesIO
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.errors import LibraryError
from simulator.motion.segments import Floats, lines
from simulator.removal.cutter import Cutter, Insert
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from simulator.removal.stock_file import MOST_BYTES, kept_stock, stock_bytes
from simulator.removal.zmap import OUTSIDE
from stepnc_model.programs.program import Stock
from tests.every_case import every_case

BLOCK = Stock(low=(-1.0, -2.0, -10.0), high=(39.0, 28.0, 0.0))
ROUND = Stock(low=(-15.0, -5.0, -10.0), high=(15.0, 25.0, 0.0), radius=15.0)
BAR = Stock(low=(-20.0, -20.0, -30.0), high=(20.0, 20.0, 0.0), radius=20.0)
MILL = Cutter(diameter=8.0, teeth=2)
FIRST = [(-8.0, 4.0, -3.0), (30.0, 4.0, -3.0)]
SECOND = [(30.0, 4.0, -3.0), (30.0, 4.0, -5.0), (30.0, 20.0, -5.0), (-8.0, 20.0, -5.0)]


def milled(stock: MillingStock, *paths: list[tuple[float, float, float]]) -> MillingStock:
    for path in paths:
        stock.cut(lines(path), MILL)
    return stock


def reread(stock: MillingStock | TurningStock) -> MillingStock | TurningStock:
    return kept_stock(stock_bytes(stock), "kept.npz")[1]


@pytest.mark.parametrize("raw", [BLOCK, ROUND])
def test_a_milled_stock_comes_back(raw: Stock) -> None:
    stock = milled(MillingStock(raw, cell=0.25), FIRST)
    bounds, read = kept_stock(stock_bytes(stock), "kept.npz")
    assert bounds == raw
    assert isinstance(read, MillingStock)
    np.testing.assert_array_equal(read.map.grid.heights, stock.map.grid.heights)
    outside = stock.map.grid.owner == OUTSIDE
    np.testing.assert_array_equal(read.map.grid.owner == OUTSIDE, outside)
    assert read.map.grid[2:] == pytest.approx(stock.map.grid[2:])


def test_two_runs_leave_what_one_run_leaves() -> None:
    whole = milled(MillingStock(BLOCK, cell=0.25), FIRST, SECOND)
    first = reread(milled(MillingStock(BLOCK, cell=0.25), FIRST))
    assert isinstance(first, MillingStock)
    second = milled(first, SECOND)
    np.testing.assert_array_equal(second.map.grid.heights, whole.map.grid.heights)


@settings(max_examples=12, deadline=None)
@given(at=st.floats(0.0, 20.0), depth=st.floats(0.5, 9.0))
def test_the_section_of_a_kept_slot_is_known_to_a_cell(at: float, depth: float) -> None:
    """Beside a kept slot the engagement agrees with that of one run to within a cell."""
    cell, beside = 0.1, [(-8.0, 8.0, -depth), (47.0, 8.0, -depth)]
    before = milled(MillingStock(BLOCK, cell=cell), [(-8.0, at, -depth), (47.0, at, -depth)])
    kept = reread(before)
    assert isinstance(kept, MillingStock)
    one, other = before.cut(lines(beside), MILL), kept.cut(lines(beside), MILL)
    volumes = [float(stock.map.volume) for stock in (before, kept)]
    assert volumes[0] == pytest.approx(volumes[1])
    # Inside the kept slot nothing is left to cut.
    middles = [
        each.section[(each.station > 15.0) & (each.station < 40.0)] for each in (one, other)
    ]
    steady = [np.median(each) if each.size else 0.0 for each in middles]
    assert abs(steady[0] - steady[1]) <= cell * depth


def test_a_turned_bar_comes_back() -> None:
    bar = TurningStock(BAR, 0.1)
    bar.cut(lines([(15.0, 0.0, 5.0), (15.0, 0.0, -20.0)]), Insert(nose_radius=0.4))
    bounds, read = kept_stock(stock_bytes(bar), "kept.npz")
    assert isinstance(read, TurningStock)
    assert bounds.radius == bar.outer.max()
    assert (bounds.low[2], bounds.high[2]) == pytest.approx((-30.0, 0.0))
    np.testing.assert_array_equal(read.outer, bar.outer)
    np.testing.assert_allclose(read.z, bar.z)
    assert read.volume == pytest.approx(bar.volume)


def archive(**arrays: Floats) -> bytes:
    into = BytesIO()
    np.savez(into, **arrays)  # type: ignore[arg-type]
    return into.getvalue()


def mill(**changes: Floats) -> bytes:
    arrays = {
        "version": np.array([1.0]),
        "bounds": np.array([0.0, 0.0, -5.0, 4.0, 3.0, 0.0, 0.0]),
        "heights": np.zeros((4, 3)),
    }
    return archive(**{key: value for key, value in (arrays | changes).items() if value.size})


def turned(**changes: Floats) -> bytes:
    arrays = {
        "version": np.array([1.0]),
        "bounds": np.array([-5.0, -5.0, -5.0, 5.0, 5.0, 0.0, 5.0]),
        "outer": np.full(10, 5.0),
        "inner": np.zeros(10),
    }
    return archive(**{key: value for key, value in (arrays | changes).items() if value.size})


NONE = np.empty(0)


@every_case(
    ("data", "key", "word"),
    [
        (b"", "", "zip"),
        (b"PK\x03\x04", "", "zip"),
        (mill(version=np.array([2.0])), "version", "version 2"),
        (mill(version=NONE), "version", "missing"),
        (mill(bounds=np.zeros(6)), "bounds", "(7,)"),
        (
            mill(bounds=np.array([0.0, 0.0, 0.0, 4.0, 3.0, 0.0, 0.0])),
            "bounds",
            "z from 0 to 0",
        ),
        (
            mill(bounds=np.array([0.0, 0.0, -5.0, 4e6, 3.0, 0.0, 0.0])),
            "bounds",
            "x from 0 to 4e+06",
        ),
        (
            mill(bounds=np.array([0.0, 0.0, -5.0, 4.0, 3.0, 0.0, -1.0])),
            "bounds",
            "radius -1",
        ),
        (mill(bounds=np.full(7, inf)), "bounds", "not finite"),
        (
            mill(heights=np.full((4, 3), 0.5)),
            "heights",
            "between -5 and 0",
        ),
        (mill(heights=np.full((4, 3), np.nan)), "heights", "between -5 and 0"),
        (mill(heights=np.zeros(12)), "heights", "two sides"),
        (mill(heights=NONE), "outer", "missing"),
        (turned(inner=NONE), "inner", "missing"),
        (turned(inner=np.zeros(9)), "inner", "(10,)"),
        (turned(outer=np.full(10, 6.0)), "outer", "between 0 and 5"),
        (turned(inner=np.full(10, 5.1)), "outer - inner", "between 0 and 5"),
        (mill(heights=np.zeros((4, 3), dtype=object)), "", "64-bit"),
        (mill(heights=np.zeros((4, 3), dtype=np.float32)), "", "64-bit"),
    ],
)
def test_a_damaged_file_is_refused_with_its_key(data: bytes, key: str, word: str) -> None:
    with pytest.raises(LibraryError) as refused:
        kept_stock(data, "kept.npz")
    assert refused.value.path == "kept.npz"
    assert refused.value.key == key
    assert word in refused.value.message


def test_a_refusal_reads_file_key_value_and_bound() -> None:
    with pytest.raises(LibraryError) as refused:
        kept_stock(mill(heights=np.full((4, 3), 0.5)), "kept.npz")
    assert str(refused.value) == "kept.npz: heights: 0.5 mm is not between -5 and 0 mm"


def test_a_header_that_promises_more_than_there_is_makes_no_room() -> None:
    into, content = BytesIO(), BytesIO()
    np.lib.format.write_array_header_1_0(
        content, {"descr": "<f8", "fortran_order": False, "shape": (10**12,)}
    )
    with zipfile.ZipFile(into, "w") as packed:
        packed.writestr("heights.npy", content.getvalue())
    with pytest.raises(
        LibraryError, match="is not a kept stock: an array that is not of 64-bi"
    ):
        kept_stock(into.getvalue(), "kept.npz")


def test_an_archive_that_unpacks_too_far_is_refused() -> None:
    into = BytesIO()
    with zipfile.ZipFile(into, "w", compression=zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("heights.npy", bytes(MOST_BYTES + 1))
    with pytest.raises(LibraryError, match=f"at most {MOST_BYTES} are accepted"):
        kept_stock(into.getvalue(), "kept.npz")


@settings(max_examples=60)
@given(at=st.integers(0, 600), byte=st.integers(0, 255))
def test_any_changed_byte_is_read_or_refused_by_the_tree(at: int, byte: int) -> None:
    data = bytearray(mill())
    data[at % len(data)] = byte
    try:
        kept_stock(bytes(data), "kept.npz")
    except LibraryError as error:
        assert error.path == "kept.npz"  # noqa: PT017 (either outcome is right)
