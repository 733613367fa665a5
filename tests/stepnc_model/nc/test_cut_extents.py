"""Box around the cutting moves of a program."""

import numpy as np
import pytest

from stepnc_model.nc.cut_extents import MARGIN, CutExtents, cut_extents
from stepnc_model.nc.program import read_program

HEAD = "G21 G90 G17\nT1 M6\nS1000 M3\n"


def extents(body: str, *, radius: float = 5.0, drills: tuple[int, ...] = ()) -> CutExtents:
    """Box around the moves of a program."""
    moves = read_program((HEAD + body).encode()).moves
    found = cut_extents(
        moves,
        np.ones(len(moves), dtype=np.bool_),
        radius=lambda _: radius,
        drills=frozenset(drills),
    )
    assert found is not None
    return found


def test_the_box_holds_the_tools_at_all_places() -> None:
    box = extents("G0 X0 Y0 Z5\nG1 Z-2 F100\nX50 Y20\n").box
    out = 5.0 + MARGIN
    assert box.low == pytest.approx((-out, -out, -2.0 - MARGIN))
    assert box.high[:2] == pytest.approx((50.0 + out, 20.0 + out))


def test_arcs_bulge() -> None:
    box = extents("G0 X0 Y0 Z5\nG1 Z-1 F100\nG2 X20 Y0 I10 J0\n", radius=0.0).box
    assert box.high[1] == pytest.approx(10.0 + MARGIN)
    assert box.low[1] == pytest.approx(-MARGIN)


@pytest.mark.parametrize(
    ("body", "top"),
    [
        ("G0 X0 Y0 Z5\nG1 Z-2 F100\nX50\n", 5.0),  # a plunge
        ("G0 X0 Y0 Z15\nG1 Z5 F500\nZ-2 F100\nX50\n", 5.0),  # behind its approach
        ("G0 X0 Y0 Z5\nG1 Z-1 F100\nZ-2\nX50\n", 5.0),  # in two pieces at one feed
        ("G0 X0 Y0 Z15\nG1 Z1 F500\nG3 I-5 J0 Z-1\nX50\n", 1.0),  # a helix
        ("G0 X0 Y0 Z1\nG1 X20 Z-2 F100\nX50\n", 1.0),  # a ramp
        ("G0 X0 Y0 Z40\nX-20\nZ-2\nG1 X50 F100\n", 40.0),  # beside the part in a rapid
        ("G0 Z40\nX-20 Y0\nZ-1\nZ-2\nG1 X50 F100\n", 40.0),  # in two rapids
        ("G0 X-20 Y0\nZ7\nZ-2\nG1 X50 F100\nG0 Z30\n", 30.0),  # no plane is known
        ("G0 X0 Y0 Z5\nG1 Z0 F100\nX50\nG0 Z9\nX0\nZ8\nG1 Z-1\nX50\n", 8.0),  # the highest
    ],
)
def test_the_top_is_where_tools_go_down_into_material(body: str, top: float) -> None:
    assert extents(body).box.high[2] == pytest.approx(top)


def test_planes_of_drills_count_only_without_mills() -> None:
    drilled = "T2 M6\nG0 X0 Y0 Z50\nG81 X0 Y0 Z-5 R22 F100\nG80\n"
    milled = "G0 X0 Y0 Z5\nG1 Z-2 F100\nX50\nG0 Z50\n"
    assert extents(milled + drilled, drills=(2,)).box.high[2] == pytest.approx(5.0)
    assert extents(drilled, drills=(2,)).box.high[2] == pytest.approx(22.0)


def test_a_program_without_cuts_has_no_box() -> None:
    moves = read_program(b"G21\nG0 X1\n").moves
    rows = np.ones(len(moves), dtype=np.bool_)
    assert cut_extents(moves, rows, radius=lambda _: 1.0, drills=frozenset()) is None
