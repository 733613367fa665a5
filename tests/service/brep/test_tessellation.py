"""Open CASCADE has limits: what it cannot do is an error of the file."""

from pathlib import Path

import pytest

from service.brep import tessellation
from service.brep.tessellation import Choice, tessellate
from service.part_file import read_part
from stepnc_model.errors import StepNcError
from tests.service.brep.shapes import block, write_step
from tests.service.brep.test_solid import SAG, TOLERANCE, edit


def test_a_crash_is_an_error_of_the_file(tmp_path: Path) -> None:
    path = write_step(tmp_path / "loop.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    # A surface at a distance from itself.
    edit(path, r"#(\d+) = PLANE\('',#\d+\)", r"#\1 = OFFSET_SURFACE('',#\1,1.,.F.)")
    with pytest.raises(StepNcError, match=r"loop.step: Open CASCADE crashes on .*\(SIG"):
        read_part(path, tolerance=TOLERANCE)


def test_the_time_is_limited(tmp_path: Path) -> None:
    path = write_step(tmp_path / "slow.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    with pytest.raises(StepNcError, match=r"slow.step: Open CASCADE takes longer than 0.01 s"):
        tessellate(path.read_bytes(), name="slow.step", sag=SAG, choice=Choice(), longest=0.01)


def test_too_many_triangles_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tessellation, "MOST_TRIANGLES", 11)
    path = write_step(tmp_path / "fine.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    with pytest.raises(StepNcError, match=r"fine.step: the solid needs 12 triangles .*most 11"):
        read_part(path, tolerance=TOLERANCE)
