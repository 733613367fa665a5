"""Parts come from STL and STEP files; the content tells which."""

import gzip
from pathlib import Path

import pytest

from service.inputs.part_file import part_place, read_part
from tests.extras.brep.shapes import block, write_step
from tests.extras.brep.test_solid import TOLERANCE, edit, volume
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box


def test_packed_files_and_comments_are_read(tmp_path: Path) -> None:
    path = write_step(tmp_path / "part.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    edit(path, r"(#\d+ = )", r"/* #1 = 'a; */ \1/* ' */")
    packed = tmp_path / "part.stl"
    packed.write_bytes(gzip.compress(path.read_bytes()))
    assert volume(read_part(packed, tolerance=TOLERANCE).triangles) == pytest.approx(6.0)


def test_an_stl_file_is_told_by_its_content(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "part.step", box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    path.write_bytes(b"ISO-10303-21;".ljust(80) + path.read_bytes()[80:])
    found = read_part(path, tolerance=TOLERANCE)
    assert (len(found.triangles), found.sag) == (12, float("inf"))


def test_a_solid_is_named_behind_its_file(tmp_path: Path) -> None:
    odd = tmp_path / "part#2.stl"
    odd.touch()
    assert part_place(str(odd)) == (odd, "")
    assert part_place("a/part.step#LID #2") == (Path("a/part.step#LID "), "2")
