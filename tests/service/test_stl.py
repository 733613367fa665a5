"""STL files, binary and text."""

from pathlib import Path

import numpy as np
import pytest

from service.inputs.part_file import read_part
from stepnc_model.errors import StepNcError
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box

BOX = box((0.0, 0.0, -10.0), (40.0, 20.0, 0.0))


def text_of(triangles: np.ndarray) -> str:
    facets = "".join(
        "facet normal 0 0 1\nouter loop\n"
        + "".join(f"vertex {x} {y} {z}\n" for x, y, z in triangle)
        + "endloop\nendfacet\n"
        for triangle in triangles.tolist()
    )
    return f"solid box\n{facets}endsolid box\n"


def test_text_is_read(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    path.write_text(text_of(BOX), encoding="utf-8")
    assert np.array_equal(read_part(path, tolerance=1.0).triangles, BOX)


def test_binary_is_read(tmp_path: Path) -> None:
    path = tmp_path / "box.stl"
    write_stl(path, BOX)
    assert np.array_equal(read_part(path, tolerance=1.0).triangles, BOX)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no triangles"),
        ("vertex 1 2 3\nvertex 1 2 3\n", "triangles have three"),
        ("vertex 1 2 x\n", "damaged vertex"),
        ("vertex 1 2 nan\n" * 3, "not finite"),
    ],
)
def test_damaged_files_are_refused(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "box.stl"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(StepNcError, match=message):
        read_part(path, tolerance=1.0)


def test_a_file_that_is_cut_off_says_what_it_lacks(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "box.stl", BOX)
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(StepNcError, match="its 12 triangles need 684 bytes; it has 300"):
        read_part(path, tolerance=1.0)
