"""Compensated contours as the tool follows them; LinuxCNC's interpreter is the judge."""

import random
from math import cos, hypot, isnan, radians, sin
from pathlib import Path

import numpy as np
import pytest

from stepnc_model.nc.compensation import tool_moves
from stepnc_model.nc.moves import ModalSetting, MoveFlag, MoveKind, NcMoves
from stepnc_model.nc.program import read_program
from stepnc_model.post.dialect import Dialect
from tests.stepnc_model.nc.conftest import Oracle

RADIUS = 5.08
"""Radius in mm of all tools of the oracle's table."""

SAMPLES = [
    "comp.ngc",
    "comp-g1.ngc",
    "comp311.ngc",
    "comp311_2.ngc",
    "gmoccapy_2_tools_with_cutter_radius_compensation.ngc",
]
CONTOURS = (
    "G21 G90 G17 G40\nT1 M6\nF100\nG0 X0 Y0 Z5\nG1 Z-1\nG41 D1 G1 X20 Y0\nG1 X40 Y20\nX60\n"
    "G3 X70 Y30 I0 J10\nG1 Y60\nX30\nY30\nG1 X-20\nZ-2\nY0\nG40 X-40 Y-10\n"
    "G42 D1 G1 X-40 Y20\nG2 X-10 Y50 I30\nG1 X10\nY20\nG40 X0 Y0\n"
    "G41.1 D6 G1 X30 Y0\nG3 X50 Y20 I0 J20\nG2 X70 Y40 I20 J0\nG1 X90 Y40\nG40 G0 Z5\nX0\nM2\n"
)


def radius_of(setting: ModalSetting) -> float | None:
    side = setting.side
    assert side is not None
    return RADIUS if side.diameter is None else 0.5 * side.diameter


def followed(text: str, dialect: Dialect = Dialect.LINUXCNC) -> NcMoves:
    program = read_program(text.encode("latin-1"), dialect=dialect)
    return tool_moves(program.moves, radius_of, is_square=dialect is Dialect.LINUXCNC)


def zigzag(seed: int, word: str) -> str:
    """Contour of lines that turn by 5° to 100°, none of which is short."""
    chance = random.Random(seed)
    x, y, heading = 30.0, 0.0, 0.0
    lines = ["G21 G90 G17 G40", "T1 M6", "F100", "G0 X0 Y0 Z0", f"{word} D1 G1 X30 Y0"]
    for _ in range(12):
        heading += radians(chance.choice((-1.0, 1.0)) * chance.uniform(5.0, 100.0))
        length = chance.uniform(25.0, 60.0)
        x, y = x + length * cos(heading), y + length * sin(heading)
        lines.append(f"X{x:.4f} Y{y:.4f}")
    return "\n".join([*lines, f"G40 X{x + 40.0:.4f} Y{y:.4f}", "M2", ""])


def require_same(text: str, linuxcnc: Oracle) -> None:
    """Require the moves that LinuxCNC's interpreter gives."""
    moves, truth = followed(text), linuxcnc(text.encode("latin-1"))
    rows = np.flatnonzero(moves.kind <= MoveKind.ARC)
    assert len(rows) == len(truth)
    unit = 25.4 if "G20" in text.upper() else 1.0
    for row, true in zip(rows.tolist(), truth, strict=True):
        move = moves.move(row)
        for value, wanted in zip(move.end, true.end, strict=True):
            assert isnan(value) or value == pytest.approx(wanted, abs=2e-4 * unit)
        assert (move.arc is None) is (true.centre is None)
        if move.arc is not None and true.centre is not None:
            centre = [move.arc.centre[axis] for axis in true.axes[:2]]
            assert centre == pytest.approx(true.centre, abs=3e-4 * unit)
            assert (move.arc.turn > 0.0) is (true.rotation > 0)
    assert not (moves.flags & int(MoveFlag.COMPENSATED)).any()


@pytest.mark.parametrize("name", SAMPLES)
def test_a_sample_is_followed_as_by_linuxcnc(
    name: str, samples: Path, linuxcnc: Oracle
) -> None:
    require_same((samples / name).read_text("latin-1"), linuxcnc)


def test_corners_arcs_and_heights_are_followed_as_by_linuxcnc(linuxcnc: Oracle) -> None:
    require_same(CONTOURS, linuxcnc)


@pytest.mark.parametrize("word", ["G41", "G42"])
@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_lines_are_followed_as_by_linuxcnc(seed: int, word: str, linuxcnc: Oracle) -> None:
    require_same(zigzag(seed, word), linuxcnc)


HEAD = "G21 G90 G17\nT1 M6\nG0 X0. Y0.\nG1 Z-1. F100.\n"
REFUSED = {
    "an inside arc smaller than the tool": (
        "G41 D1 G1 X20. Y0.\nX40.\nG3 X44. Y4. R4.\nG40 G1 X80. Y80.\n"
    ),
    "a line between inside corners that is too short": (
        "G41 D1 G1 X20. Y0.\nX40.\nY4.\nX20.\nG40 G1 X0. Y80.\n"
    ),
    "an arc in another plane": "G41 D1 G1 X20. Y0.\nG18 G2 X40. Z-1. R10.\nG17 G40 X80.\n",
    "inverse time": "G93 G41 D1 G1 X20. Y0. F5.\nX60. F5.\nG94 G40 X80. Y9. F100.\n",
    "a beginning with an arc": "G41 D1 G2 X20. Y20. R20.\nG1 X60.\nG40 X80. Y9.\n",
    "an unknown point": "G41 D1 G1 X20. Y0.\nX#1\nY20.\nG40 X80. Y9.\n",
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_no_control_follows_stays_as_commanded(what: str) -> None:
    text = HEAD + REFUSED[what] + "M30\n"
    program = read_program(text.encode(), dialect=Dialect.FANUC)
    found = followed(text, Dialect.FANUC)
    np.testing.assert_array_equal(found.end, program.moves.end)
    assert (found.flags & int(MoveFlag.COMPENSATED)).any()
    assert not (found.flags & int(MoveFlag.BESIDE)).any()


def test_a_tool_of_unknown_radius_stays_on_the_contour() -> None:
    program = read_program(CONTOURS.encode(), dialect=Dialect.LINUXCNC)
    assert tool_moves(program.moves, lambda _: None, is_square=True) is program.moves


@pytest.mark.parametrize(
    ("dialect", "lines"),
    [
        (Dialect.FANUC, HEAD + "G41 D1 G1 X20. Y0.\nX40. Y20.\nX80.\nG40 X90. Y0.\nM30\n"),
        (
            Dialect.SINUMERIK,
            "G71 G90 G17\nT1 D1\nM6\nG0 X0 Y0\nG1 Z-1 F100\nG41 X20 Y0\nX40 Y20\nX80\n"
            "G40 X90 Y0\nM30\n",
        ),
        (
            Dialect.HEIDENHAIN,
            "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S3000 F100\n2 L X+0 Y+0 R0 FMAX\n3 L Z-1 F100\n"
            "4 L X+20 Y+0 RL\n5 L X+40 Y+20\n6 L X+80\n7 L X+90 Y+0 R0\n8 END PGM A MM\n",
        ),
    ],
)
def test_other_controls_begin_square_to_the_contour(dialect: Dialect, lines: str) -> None:
    moves = followed(lines, dialect)
    beside = moves.end[(moves.flags & int(MoveFlag.BESIDE)) != 0][:, :2]
    aside = RADIUS * np.array([-sin(radians(45.0)), cos(radians(45.0))])
    assert beside[0] == pytest.approx(np.array([20.0, 0.0]) + aside)
    assert hypot(*(beside[1] - (40.0, 20.0))) == pytest.approx(RADIUS)
    assert beside[2] == pytest.approx([40.0, 20.0 + RADIUS])
    assert beside[-1] == pytest.approx([90.0, 0.0])
    assert not moves.is_splittable[(moves.flags & int(MoveFlag.BESIDE)) != 0].any()


def test_the_way_up_after_a_contour_stays_beside_it_until_the_axes_move() -> None:
    lines = HEAD + "G41 D1 G1 X20. Y0.\nX60.\nG40\nG0 Z5.\nX0. Y50.\nM30\n"
    moves = followed(lines, Dialect.FANUC)
    assert moves.end[-2].tolist() == pytest.approx([60.0, RADIUS, 5.0])
    assert moves.start[-1].tolist() == pytest.approx([60.0, RADIUS, 5.0])
    assert moves.end[-1].tolist() == pytest.approx([0.0, 50.0, 5.0])
