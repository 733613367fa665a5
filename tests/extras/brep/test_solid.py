"""Solids of STEP files become closed triangles with their volume, in mm."""

import re
import sys
from math import pi
from pathlib import Path

import numpy as np
import pytest

from service.inputs.part_file import read_part, require_part
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from tests.extras.brep.shapes import (
    block,
    bore,
    first_face,
    revolved,
    rounded,
    without,
    write_step,
)

TOLERANCE = 0.0254
SAG = TOLERANCE / 5.0
PROFILE = ((0.0, 0.0), (0.0, 15.0), (-20.0, 15.0), (-30.0, 18.0), (-45.0, 18.0), (-45.0, 0.0))


def stepped() -> object:
    """A block of 60 x 40 x 20 mm with a step, a pocket and a through hole."""
    return without(
        block((0.0, 0.0, -20.0), (60.0, 40.0, 0.0)),
        block((45.0, -1.0, -6.0), (61.0, 41.0, 1.0)),
        rounded((8.0, 7.0, -5.0), (32.0, 33.0, 1.0), 3.0),
        bore((52.0, 20.0, 1.0), radius=4.0, depth=30.0),
    )


STEPPED = (
    60.0 * 40.0 * 20.0
    - 15.0 * 40.0 * 6.0
    - (24.0 * 26.0 - (4.0 - pi) * 9.0) * 5.0
    - 16.0 * pi * 14.0
)
"""Its volume, mm³."""


def volume(triangles: Floats) -> float:
    return float(np.linalg.det(triangles).sum()) / 6.0


def edit(path: Path, pattern: str, text: str) -> Path:
    """Change a STEP file, which must have the pattern."""
    changed, count = re.subn(pattern, text, path.read_text("latin-1"))
    assert count
    path.write_text(changed, "latin-1")
    return path


@pytest.mark.parametrize(
    ("schema", "unit", "named"),
    [
        ("AP203", "MM", "CONFIG_CONTROL_DESIGN"),
        ("AP214IS", "INCH", "AUTOMOTIVE_DESIGN"),
        ("AP242DIS", "INCH", "AP242_MANAGED_MODEL"),
    ],
)
def test_a_milled_part_has_its_size_and_volume(
    schema: str, unit: str, named: str, tmp_path: Path
) -> None:
    path = write_step(tmp_path / "part.step", stepped(), schema=schema, unit=unit)
    text = path.read_text("latin-1")
    assert named in text
    assert ("'INCH'" in text) == (unit == "INCH")
    triangles = read_part(path, tolerance=TOLERANCE).triangles
    assert triangles.min(axis=(0, 1)) == pytest.approx((0.0, 0.0, -20.0), abs=1e-6)
    assert triangles.max(axis=(0, 1)) == pytest.approx((60.0, 40.0, 0.0), abs=1e-6)
    curved = 2.0 * pi * 3.0 * 5.0 + 2.0 * pi * 4.0 * 14.0
    assert volume(triangles) == pytest.approx(STEPPED, abs=SAG * curved)


def test_triangles_lie_within_a_fifth_of_the_tolerance(tmp_path: Path) -> None:
    path = write_step(tmp_path / "turned.step", revolved(PROFILE))
    for tolerance in (0.2, 0.02):
        triangles = read_part(path, tolerance=tolerance).triangles
        z, r = triangles[:, :, 2], np.hypot(triangles[:, :, 0], triangles[:, :, 1])
        is_side = (np.abs(r - 15.0) < 1e-6).all(axis=1) & (np.ptp(z, axis=1) > 1.0)
        middles = 0.5 * (triangles + triangles[:, [1, 2, 0]])[is_side]
        away = 15.0 - np.hypot(middles[:, :, 0], middles[:, :, 1])
        assert 0.1 * tolerance / 5.0 < away.max() < tolerance / 5.0 + 1e-9
    cone = 10.0 * (15.0**2 + 15.0 * 18.0 + 18.0**2) / 3.0
    exact = pi * (20.0 * 15.0**2 + cone + 15.0 * 18.0**2)
    assert volume(triangles) == pytest.approx(exact, rel=2.0 * 0.004 / 15.0)


def test_a_void_is_no_material(tmp_path: Path) -> None:
    whole = block((0.0, 0.0, 0.0), (20.0, 20.0, 20.0))
    path = write_step(
        tmp_path / "void.step", without(whole, bore((10, 10, 15), radius=5, depth=10))
    )
    assert "BREP_WITH_VOIDS" in path.read_text("latin-1")
    triangles = read_part(path, tolerance=TOLERANCE).triangles
    assert volume(triangles) == pytest.approx(8000.0 - 250.0 * pi, abs=SAG * 100.0 * pi)


def test_one_of_several_solids_is_chosen(tmp_path: Path) -> None:
    shapes = (block((0.0, 0.0, 0.0), (10.0, 20.0, 30.0)), revolved(PROFILE))
    path = write_step(tmp_path / "two.step", *shapes, name="HOUSING")
    edit(path, r"(MANIFOLD_SOLID_BREP\(')('.*\n(?:.*\n)*?.*MANIFOLD_SOLID_BREP\(')", r"\1BOX\2")
    with pytest.raises(StepNcError) as refused:
        read_part(path, tolerance=TOLERANCE)
    told = str(refused.value)
    assert re.search(
        r"two.step: 2 solids: choose one by its place or name: 1 'BOX' \(#\d+\) of "
        r"10 x 20 x 30 mm, 2 'HOUSING( \d+)?' \(#\d+\) of 36 x 36 x 45 mm",
        told,
    )
    assert read_part(path, solid="BOX", tolerance=TOLERANCE).triangles.max() == pytest.approx(
        30.0
    )
    assert read_part(path, solid="2", tolerance=TOLERANCE).triangles.min() == pytest.approx(
        -45.0
    )
    with pytest.raises(StepNcError, match="no solid 'LID', or several: choose one"):
        read_part(path, solid="LID", tolerance=TOLERANCE)
    require_part(path)


def test_facets_are_a_solid(tmp_path: Path) -> None:
    """A tetrahedron as a FACETED_BREP, whose faces have points only."""
    corners = [(0, 0, 0), (6, 0, 0), (0, 6, 0), (0, 0, 6)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    normals = ["0.,0.,-1.", "0.,-1.,0.", "-1.,0.,0.", "1.,1.,1."]
    lines = [
        f"#{row + 1}=CARTESIAN_POINT('',({x}.,{y}.,{z}.));"
        for row, (x, y, z) in enumerate(corners)
    ]
    for row, each in enumerate(faces):
        loop = ",".join(f"#{corner + 1}" for corner in each)
        lines += [
            f"#{10 + row}=POLY_LOOP('',({loop}));",
            f"#{20 + row}=FACE_OUTER_BOUND('',#{10 + row},.T.);",
            f"#{30 + row}=FACE_SURFACE('',(#{20 + row}),#{50 + row},.T.);",
            f"#{50 + row}=PLANE('',#{60 + row});",
            f"#{60 + row}=AXIS2_PLACEMENT_3D('',#{each[0] + 1},#{70 + row},#{80 + row});",
            f"#{70 + row}=DIRECTION('',({normals[row]}));",
            f"#{80 + row}=DIRECTION('',({'0.,0.,1.' if row in (1, 2) else '1.,-1.,0.'}));",
        ]
    lines += [
        "#40=CLOSED_SHELL('',(#30,#31,#32,#33));",
        "#41=FACETED_BREP('TETRAHEDRON',#40);",
        "#42=FACETED_BREP_SHAPE_REPRESENTATION('',(#41),#43);",
        "#43=(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNIT_ASSIGNED_CONTEXT((#44)) "
        "REPRESENTATION_CONTEXT('',''));",
        "#44=(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.CENTI.,.METRE.));",
    ]
    path = tmp_path / "facets.step"
    head = "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n"
    path.write_text(head + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n", "ascii")
    triangles = read_part(path, tolerance=TOLERANCE).triangles
    assert len(triangles) == 4
    assert volume(triangles) == pytest.approx(36_000.0)
    require_part(path)


def test_a_part_that_is_not_closed_is_refused(tmp_path: Path) -> None:
    path = write_step(tmp_path / "open.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    edit(path, r"(CLOSED_SHELL\('',\()#\d+,", r"\1")
    with pytest.raises(StepNcError, match=r"open.step: no closed solid .*; 1 open shells"):
        read_part(path, tolerance=TOLERANCE)


def test_a_file_without_a_solid_is_refused(tmp_path: Path) -> None:
    face = first_face(block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    path = write_step(tmp_path / "none.step", face)
    with pytest.raises(StepNcError, match=r"none.step: no closed solid \(such as MANIFOLD_"):
        read_part(path, tolerance=TOLERANCE)
    with pytest.raises(StepNcError, match=r"none.step: no closed solid .*; 1 open shells"):
        require_part(path)


def test_a_file_that_breaks_off_is_refused(tmp_path: Path) -> None:
    path = write_step(tmp_path / "cut.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    content = path.read_bytes()
    path.write_bytes(content[: content.index(b"ADVANCED_FACE") + 5])
    with pytest.raises(StepNcError, match=r"cut.step: line \d+, column \d+: .*#\d+"):
        read_part(path, tolerance=TOLERANCE)


def test_without_open_cascade_the_extra_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = write_step(tmp_path / "part.step", block((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)))
    monkeypatch.setitem(sys.modules, "OCP", None)
    with pytest.raises(StepNcError) as refused:
        read_part(path, tolerance=TOLERANCE)
    assert str(refused.value) == (
        f"{path}: B-rep solids are read by Open CASCADE, which is not installed: "
        "pip install 'stepnc-optimiser[brep]'"
    )
