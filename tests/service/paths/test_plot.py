"""The picture has the colours of the moves that are in it."""

import io
from pathlib import Path

import matplotlib.colors
import matplotlib.image
import numpy as np
import pytest

from service.paths.plot import COLOURS, path_png
from service.paths.toolpaths import tool_paths
from stepnc_model.toolpath.path import MoveType
from stepnc_model.toolpath.task import stock_of

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def drawn(
    name: str, *, count: int | None = None
) -> "np.ndarray[tuple[int, ...], np.dtype[np.float64]]":
    paths = tool_paths(PARTS / name)
    stock = stock_of(paths.program, paths.program.workingsteps[0].setup)
    data = path_png(paths.paths, stock, title=name)
    return np.asarray(matplotlib.image.imread(io.BytesIO(data)))[..., :3]


def shows(picture: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]", kind: MoveType) -> bool:
    colour = np.array(matplotlib.colors.to_rgb(COLOURS[kind]))
    return bool((np.abs(picture - colour).max(axis=-1) < 0.02).any())


@pytest.mark.parametrize("name", ["bracket.stpnc", "shaft.stpnc"])
def test_every_type_of_move_is_drawn_in_its_colour(name: str) -> None:
    picture = drawn(name)
    assert all(shows(picture, kind) for kind in MoveType)


def test_a_type_that_is_not_there_is_not_drawn() -> None:
    paths = [path for path in tool_paths(PARTS / "bracket.stpnc").paths if "REAM" in path.id]
    used = {move.type for path in paths for move in path.moves}
    assert MoveType.CONTACT in used
    assert MoveType.APPROACH not in used
    data = path_png(paths, None, title="holes")
    picture = np.asarray(matplotlib.image.imread(io.BytesIO(data)))[..., :3]
    shown = {kind for kind in MoveType if shows(picture, kind)}
    # The way out of a hole lies under the cut that made it.
    assert MoveType.CONTACT in shown
    assert shown <= used
