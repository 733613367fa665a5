"""The picture has the colours of the moves that are in it."""

import io

import matplotlib.colors
import matplotlib.image
import numpy as np
import pytest
from numpy.typing import NDArray

from service.verbs.toolpath.plot import COLOURS, path_png, sections_of_code, sections_of_paths
from stepnc_model.nc.program import read_program
from stepnc_model.toolpath.path import MoveType
from tests.service.verbs.toolpath.test_run import PARTS, paths_of

Picture = NDArray[np.float64]


def read_picture(data: bytes) -> Picture:
    return np.asarray(matplotlib.image.imread(io.BytesIO(data)))[..., :3]


def drawn(name: str) -> Picture:
    paths = paths_of(PARTS / name)
    sections = sections_of_paths(paths.paths)
    return read_picture(path_png(sections, paths.stock, title=name))


def shows(picture: Picture, kind: MoveType) -> bool:
    colour = np.array(matplotlib.colors.to_rgb(COLOURS[kind]))
    return bool((np.abs(picture - colour).max(axis=-1) < 0.02).any())


@pytest.mark.parametrize("name", ["bracket.stpnc", "shaft.stpnc"])
def test_every_type_of_move_is_drawn_in_its_colour(name: str) -> None:
    picture = drawn(name)
    assert all(shows(picture, kind) for kind in MoveType)


def test_a_type_that_is_not_there_is_not_drawn() -> None:
    paths = [path for path in paths_of(PARTS / "bracket.stpnc").paths if "REAM" in path.id]
    used = {move.type for path in paths for move in path.moves}
    assert MoveType.CONTACT in used
    assert MoveType.APPROACH not in used
    picture = read_picture(path_png(sections_of_paths(paths), None, title="holes"))
    shown = {kind for kind in MoveType if shows(picture, kind)}
    # The way out of a hole lies under the cut that made it.
    assert MoveType.CONTACT in shown
    assert shown <= used


CODE = b"""G21 G90 G17
T1 M6
G0 X0 Y0 Z5
G1 Z-1 F100
G2 X20 Y0 I10 J0
G28 Z0
T2 M6
G0 X0 Y0 Z2
G1 Z-3 F50
M2
"""


def test_code_has_a_section_for_each_tool_with_rapids_and_feeds() -> None:
    one, other = sections_of_code(read_program(CODE))
    assert (one.name, other.name) == ("T1", "T2")
    assert [stroke.label for stroke in one.strokes] == ["feed"]
    arc = one.strokes[0].points
    assert max(y for _, y, _ in arc) == pytest.approx(10.0, abs=0.02)
    assert [stroke.points for stroke in other.strokes] == [((0.0, 0.0, 2.0), (0.0, 0.0, -3.0))]


def test_a_move_after_an_unknown_place_begins_a_stroke_of_its_own() -> None:
    code = b"G21 G90\nG0 X0 Y0 Z0\nG1 X10 F100\nG28 X0\nG0 X0 Y5\nG1 X10\nM2\n"
    (section,) = sections_of_code(read_program(code))
    ends = [(stroke.points[0], stroke.points[-1]) for stroke in section.strokes]
    assert ((0.0, 5.0, 0.0), (10.0, 5.0, 0.0)) in ends
    assert all(start[1] == end[1] for start, end in ends)


def test_a_picture_of_code_shows_its_moves() -> None:
    sections = sections_of_code(read_program(CODE))
    picture = read_picture(path_png(sections, None, title="code"))
    assert shows(picture, MoveType.CONTACT)
    assert not shows(picture, MoveType.APPROACH)
