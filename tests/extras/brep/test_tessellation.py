"""Open CASCADE has limits: what it cannot do is an error of the file."""

import re
from pathlib import Path
from random import Random

import pytest

from extras.brep import tessellation
from extras.brep.tessellation import Choice, tessellate
from service.inputs.part_file import read_part
from stepnc_model.errors import StepNcError
from tests.extras.brep.shapes import block, torus, write_step
from tests.extras.brep.test_solid import SAG, TOLERANCE, edit


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


def test_a_huge_solid_is_refused_before_it_is_tessellated(tmp_path: Path) -> None:
    path = write_step(tmp_path / "huge.step", torus(3e5, 1e5))
    with pytest.raises(StepNcError, match=r"huge.step: the solid spans 800000 mm; at most 1"):
        read_part(path, tolerance=TOLERANCE)


def test_the_memory_is_limited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A torus that needs a hundred million triangles."""
    monkeypatch.setattr(tessellation, "MOST_MEMORY", 700 << 20)
    path = write_step(tmp_path / "wide.step", torus(3e4, 1e4))
    with pytest.raises(StepNcError, match=r"wide.step: Open CASCADE .*(0.68 GB|memory|alloc)"):
        read_part(path, tolerance=TOLERANCE)


def test_many_solids_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tessellation, "MOST_SOLIDS", 1)
    shapes = [block((0.0, 0.0, z), (1.0, 2.0, z + 1.0)) for z in (0.0, 5.0)]
    path = write_step(tmp_path / "many.step", *shapes)
    with pytest.raises(StepNcError, match=r"many.step: 2 solids; at most 1 are accepted"):
        read_part(path, tolerance=TOLERANCE)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_damaged_body_ends_with_an_error(seed: int, tmp_path: Path) -> None:
    """Numbers, references and entities of a valid body are exchanged at random."""
    random = Random(seed)
    path = write_step(tmp_path / "odd.step", block((0.0, 0.0, 0.0), (30.0, 20.0, 10.0)))
    head, mark, data = path.read_text("latin-1").partition("DATA;")
    pieces = re.split(r"(#\d+(?! =)|\d+\.\d*|[A-Z_]{5,})", data)
    for index in random.sample(range(1, len(pieces), 2), 6):
        like = [each for each in pieces[1::2] if each[0] == pieces[index][0]]
        pieces[index] = random.choice((*like, "1.E300", "-1."))
    path.write_text(head + mark + "".join(pieces), "latin-1")
    with pytest.raises(StepNcError) as refused:
        read_part(path, tolerance=TOLERANCE)
    assert str(refused.value).startswith(str(path))
