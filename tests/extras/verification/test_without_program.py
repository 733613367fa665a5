"""Logs are verified against a required part where there is no program."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from extras.verification.facts import surface_deviations
from extras.verification.model.deviation import SurfaceKind
from extras.verification.requests import VerificationRequest
from extras.verification.run import Verification, VerificationInputs, verify
from service.cli.main import main
from service.errors import BAD_INPUT, LIMIT_EXCEEDED
from service.requests.program_facts import StockFile
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from tests.extras.verification.files import AXES, write_log, write_stl, write_tools
from tests.extras.verification.model import test_required_bar as test_revolved
from tests.extras.verification.model import test_required_part as test_required
from tests.extras.verification.model.block import sampled
from tests.extras.verification.model.meshes import revolved

BLOCK = "0,0,-12,40,30,0"
MILL = VerificationRequest(machine="vmc15", stock=BLOCK, cell_mm=0.2)
LATHE = VerificationRequest(machine="lathe22", stock="40,-50,0.5")
POCKET = sampled(test_required.pocket_way(), 0.0417)
TURNED = sampled(test_revolved.WAY, 0.0437)
OFFSET = np.array([0.0254, 0.0, 0.0])
ENDMILL = 'number = 1\nkind = "endmill"\ndiameter_mm = 6'
INSERT = 'number = 1\nkind = "turning"'


def pocket_inputs(folder: Path, *, mesh: Floats = test_required.MESH) -> VerificationInputs:
    return VerificationInputs(
        tools=write_tools(folder / "tools.toml", ENDMILL),
        required=write_stl(folder / "part.stl", mesh),
    )


def turned_inputs(folder: Path) -> VerificationInputs:
    return VerificationInputs(
        tools=write_tools(folder / "tools.toml", INSERT),
        required=write_stl(folder / "part.stl", revolved(test_revolved.PROFILE)),
    )


def milled(folder: Path, points: Floats) -> Verification:
    path = write_log(folder / "log.csv", points)
    return verify(path, None, MILL, inputs=pocket_inputs(folder))


def turned(folder: Path, points: Floats) -> Verification:
    path = write_log(folder / "log.csv", points)
    return verify(path, None, LATHE, inputs=turned_inputs(folder))


def test_a_clean_log_has_no_errors(tmp_path: Path) -> None:
    for found in (milled(tmp_path, POCKET), turned(tmp_path, TURNED)):
        assert not found.places.is_beyond.any()
        assert [step.tool for step in found.steps] == [1]
        assert found.program == "part.stl"
        assert found.volumes.logged == pytest.approx(found.volumes.programmed, rel=1e-3)


def test_an_offset_is_found_on_the_surface_of_the_tool(tmp_path: Path) -> None:
    rows = {
        (row.workingstep, row.kind): row
        for row in surface_deviations(milled(tmp_path, POCKET + OFFSET))
    }
    wall = rows["T1", SurfaceKind.WALL]
    for spot in (wall.gouge, wall.excess):
        assert spot.size == pytest.approx(0.0254, abs=spot.uncertainty)
        assert spot.is_beyond
        assert spot.cut_by == "T1"
    found = turned(tmp_path, TURNED + OFFSET)
    assert found.has_errors
    diameter = next(
        row for row in surface_deviations(found) if row.kind is SurfaceKind.DIAMETER
    )
    assert diameter.excess.size == pytest.approx(0.0254, abs=diameter.excess.uncertainty)


def test_workingsteps_of_the_log_are_told_with_their_tools(tmp_path: Path) -> None:
    rows = [
        f"{0.01 * row:.2f},{x:.5f},{y:.5f},{z:.5f},1,{'ROUGH' if row < 900 else 'FINISH'}"
        for row, (x, y, z) in enumerate(POCKET.tolist())
    ]
    path = tmp_path / "log.csv"
    path.write_text(f"time_s,{AXES},tool_number,workingstep\n" + "\n".join(rows), "utf-8")
    found = verify(path, None, MILL, inputs=pocket_inputs(tmp_path))
    assert [(step.workingstep, step.tool) for step in found.steps] == [
        ("ROUGH", 1), ("FINISH", 1),
    ]  # fmt: skip
    walls = found.places[found.places.is_wall]
    assert {found.steps[index].workingstep for index in walls.workingstep.tolist()} == {
        "FINISH"
    }


def test_the_command_writes_json_page_and_places(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, given = write_log(tmp_path / "log.csv", POCKET + OFFSET), pocket_inputs(tmp_path)
    page, places = tmp_path / "page.html", tmp_path / "places.csv"
    with pytest.raises(SystemExit) as ended:
        main([
            "verify", str(log), "--tools", str(given.tools), "--required", str(given.required),
            "--stock", BLOCK, "--machine", "vmc15", "--cell-mm", "0.2", "--json",
            "--report", str(page), "-o", str(places),
        ])  # fmt: skip
    assert ended.value.code == LIMIT_EXCEEDED
    found = json.loads(capsys.readouterr().out)
    assert found["program"] == "part.stl"
    assert {row["tool"] for row in found["surfaces"]} == {None, 1}
    assert "part.stl" in page.read_text("utf-8")
    assert places.read_text("utf-8").startswith('"x_mm"')


def test_what_is_missing_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["verify", "log.csv", "--stock", "40,-50,0"])
    assert ended.value.code == BAD_INPUT
    message = capsys.readouterr().err
    assert "missing: --required FILE, --tools TABLE, --machine NAME" in message


@pytest.mark.parametrize(
    ("mesh", "message"),
    [
        (test_required.MESH / 25.4, "fits 25.4 times into it: is it in inches"),
        (test_required.MESH + 500.0, "they do not overlap"),
    ],
)
def test_a_part_in_inches_or_elsewhere_is_refused(
    tmp_path: Path, mesh: Floats, message: str
) -> None:
    path = write_log(tmp_path / "log.csv", POCKET)
    with pytest.raises(StepNcError, match=message):
        verify(path, None, MILL, inputs=pocket_inputs(tmp_path, mesh=mesh))


def test_a_zero_is_given_and_not_fitted(tmp_path: Path) -> None:
    zero = replace(MILL, zero="-300,-200,-400")
    log = write_log(tmp_path / "log.csv", POCKET + np.array([-300.0, -200.0, -400.0]))
    assert not verify(log, None, zero, inputs=pocket_inputs(tmp_path)).has_errors
    with pytest.raises(StepNcError, match="fit needs a program"):
        verify(log, None, replace(MILL, zero="fit"), inputs=pocket_inputs(tmp_path))


def test_a_table_without_a_tool_of_the_machine_is_refused(tmp_path: Path) -> None:
    inputs = replace(pocket_inputs(tmp_path), tools=write_tools(tmp_path / "t.toml", INSERT))
    log = write_log(tmp_path / "log.csv", POCKET)
    with pytest.raises(StepNcError, match="no tool rotates: vmc15 needs one"):
        verify(log, None, MILL, inputs=inputs)
    with pytest.raises(StepNcError, match="needs a program"):
        verify(log, None, replace(MILL, has_deflection=True), inputs=inputs)


def test_a_cast_part_is_a_stock(tmp_path: Path) -> None:
    """Half of the pocket is cast; the log removes the other half."""
    stock = write_stl(tmp_path / "cast.stl", test_required.HALF_CAST)
    given = pocket_inputs(tmp_path)
    log = write_log(tmp_path / "log.csv", POCKET)
    found = verify(log, None, replace(MILL, stock=StockFile(path=stock)), inputs=given)
    assert not found.has_errors
    half = 12.0 * 16.0 * 5.0 - 0.5 * (4.0 - np.pi) * 9.0 * 5.0
    assert found.volumes.logged == pytest.approx(half, rel=0.01)
    assert found.volumes.programmed == pytest.approx(half, rel=0.01)
    aside = write_log(tmp_path / "aside.csv", POCKET + 4.0 * OFFSET)
    found = verify(aside, None, replace(MILL, stock=StockFile(path=stock)), inputs=given)
    assert found.has_errors
    beyond = found.places[found.places.is_beyond & found.places.is_wall]
    assert beyond.position[:, 0].min() > 19.5


def test_a_turned_blank_is_a_stock(tmp_path: Path) -> None:
    """A mesh of the bar removes what the numbers of the bar remove; a thinner one less."""
    given = turned_inputs(tmp_path)
    log = write_log(tmp_path / "log.csv", TURNED)
    volumes = []
    for radius in (20.0, 19.0):
        ends = ((-50.0, 0.0), (-50.0, radius), (0.5, radius), (0.5, 0.0))
        stock = write_stl(tmp_path / f"bar{radius:g}.stl", revolved(ends))
        found = verify(log, None, replace(LATHE, stock=StockFile(path=stock)), inputs=given)
        assert not found.places.is_beyond.any()
        volumes.append(found.volumes.logged)
    bar = verify(log, None, LATHE, inputs=given)
    assert volumes[0] == pytest.approx(bar.volumes.logged, rel=2e-3)
    assert volumes[1] < volumes[0]
