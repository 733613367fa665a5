"""B-rep of raw and finished parts in programs of ISO 14649 and AP238."""

import sys
from pathlib import Path

import numpy as np
import pytest

import stepnc
from benchmarks.verification import FAST, SHAFT_REQUEST, run_log
from extras.verification.preparation import prepared
from extras.verification.requests import VerificationRequest
from extras.verification.run import Verification, verify
from extras.verification.verbs.verify.result import VerificationResult
from service.inputs.program_bodies import ProgramBodies, body_triangles
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from service.progress import silent
from service.simulation.setup import prepared_program
from simulator.library import load_machine
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.toolpath.task import finished_body, raw_body, stock_of
from tests.extras.brep.programs import solid_instances, with_instances
from tests.extras.brep.shapes import block, bore, revolved, without, write_step
from tests.extras.brep.test_solid import STEPPED, stepped, volume
from tests.stepnc_model.ap238.long_form import deviations, schema
from tests.stepnc_model.ap238.samples import long_form

PARTS = Path("examples/parts")
SLOT = PARTS / "paper003_case1.stpnc"
REQUEST = VerificationRequest(
    machine="paper003", cell_mm=0.2, tolerance_mm=0.05, material="aisi1018"
)
PLATE = ((0.0, 0.0, -12.7), (101.6, 101.6, 0.0))


def slotted(aside: float = 0.0) -> object:
    """The plate with its slot of 8 mm, 6 mm deep, moved aside in Y."""
    low, high = (-1.0, 46.8 + aside, -6.0), (103.0, 54.8 + aside, 1.0)
    return without(block(*PLATE), block(low, high))


def finished(folder: Path, shape: object) -> Path:
    """The slot's program with B-rep of its finished part."""
    solid, root = solid_instances(write_step(folder / "part.step", shape))
    text = SLOT.read_text("utf-8").replace("0.1,$,$,#13,", f"0.1,$,#{root},#13,")
    path = folder / "slot.stpnc"
    path.write_text(with_instances(text, solid), "utf-8")
    return path


def cast(folder: Path, shape: object, program: Path, old: str, new: str) -> Path:
    """A program with B-rep of its raw part in place of its bounding geometry."""
    solid, root = solid_instances(write_step(folder / "raw.step", shape))
    text = program.read_text("utf-8")
    assert old in text
    raw = f"#99000=WORKPIECE('CASTING',$,$,$,#{root},$,());"
    path = folder / program.name
    path.write_text(with_instances(text.replace(old, new), [raw, *solid]), "utf-8")
    return path


@pytest.mark.parametrize("is_related", [False, True])
def test_a_body_in_an_ap238_program_is_read(is_related: bool, tmp_path: Path) -> None:
    path = tmp_path / "bracket.238"
    stepnc.convert(PARTS / "bracket.stpnc", to="ap238", output=path)
    text = path.read_text("utf-8")
    workpiece = text.partition("=PRODUCT_DEFINITION('BRACKET'")[0].rpartition("#")[2]
    solid, root = solid_instances(write_step(tmp_path / "p.step", stepped(), unit="INCH"))
    shown = 99_003 if is_related else root
    solid += [
        f"#99001=PRODUCT_DEFINITION_SHAPE('','',#{workpiece});",
        f"#99002=SHAPE_DEFINITION_REPRESENTATION(#99001,#{shown});",
    ]
    if is_related:
        solid += [
            "#99003=SHAPE_REPRESENTATION('',(),$);",
            f"#99004=SHAPE_REPRESENTATION_RELATIONSHIP('','',#99003,#{root});",
        ]
    path.write_text(with_instances(text, solid), "utf-8")
    program = read_program(path, units="iso")
    body = finished_body(program)
    assert body is not None
    triangles = body_triangles(program.file, body, tolerance=0.0254)
    assert triangles.min(axis=(0, 1)) == pytest.approx((0.0, 0.0, -20.0), abs=1e-6)
    assert triangles.max(axis=(0, 1)) == pytest.approx((60.0, 40.0, 0.0), abs=1e-6)
    assert volume(triangles) == pytest.approx(STEPPED, abs=1.0)


def test_the_finished_part_of_a_program_is_its_required_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = finished(tmp_path, slotted(aside=0.15))
    ready = prepared(SLOT, REQUEST)
    log = run_log(ready, rate=10.0, feed=lambda speed: np.full_like(speed, FAST))
    path = log.write(tmp_path / "log.parquet", ready)
    found = verify(path, program, REQUEST)
    assert not found.has_errors
    assert "in place of the features" in str(VerificationResult(verification=found))
    # Excess is positive: the wall at greater Y lies 0.15 mm before that of the body.
    assert _nominal(found, 46.8) == pytest.approx(-0.15, abs=2e-3)
    assert _nominal(found, 54.8) == pytest.approx(0.15, abs=2e-3)
    monkeypatch.setitem(sys.modules, "OCP", None)
    found = verify(path, program, REQUEST)
    [warning] = [each for each in found.findings if "B-rep" in each.message]
    assert "the features are compared in place of this body: slot.stpnc: #10001" in str(warning)
    assert "pip install 'stepnc-optimiser[brep]'" in warning.message
    assert _nominal(found, 46.8) == pytest.approx(0.0, abs=2e-3)


def _nominal(found: Verification, y: float) -> float:
    """Greatest deviation from the required part at a wall of the slot."""
    places = found.places
    at = places.is_wall & (np.abs(places.position[:, 1] - y) < 0.01)
    assert at.sum() > 100
    values = found.nominal[at]
    return float(values[np.abs(values).argmax()])


def test_the_raw_part_of_a_program_is_its_stock(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    casting = without(block(*PLATE), bore((20.0, 20.0, 1.0), radius=10.0, depth=20.0))
    path = cast(tmp_path, casting, SLOT, "0.1,$,$,#13,", "0.1,#99000,$,$,")
    program = read_program(path, units="iso")
    around = stock_of(program, program.workingsteps[0].setup)
    assert around is not None
    assert (*around.low, *around.high) == pytest.approx((*PLATE[0], *PLATE[1]), abs=1e-6)
    assert around.radius is None
    mill = load_machine("paper003")
    run = prepared_program(program, mill, material_for("aisi1018", program), tell=silent)
    stock = run.stock(program.workingsteps[0].id)
    assert isinstance(stock, MillingStock)
    exact = (101.6 * 101.6 - np.pi * 100.0) * 12.7
    assert stock.map.volume == pytest.approx(exact, rel=1e-3)
    monkeypatch.setitem(sys.modules, "OCP", None)
    told: list[str] = []
    program = read_program(path, units="iso", tell=told.append)
    assert [stock_of(program, each.setup) for each in program.workingsteps * 2] == [None, None]
    [text] = told
    assert text.startswith("the raw part is not known: paper003_case1.stpnc: #10001")
    assert "pip install 'stepnc-optimiser[brep]'" in text


def test_volumes_are_removed_from_the_raw_part(tmp_path: Path) -> None:
    """Half of the slot is cast: milling it removes the other half."""
    casting = without(block(*PLATE), block((-1.0, 46.8, -6.0), (50.8, 54.8, 1.0)))
    program = cast(tmp_path, casting, SLOT, "0.1,$,$,#13,", "0.1,#99000,$,$,")
    ready = prepared(program, REQUEST)
    log = run_log(ready, rate=10.0, feed=lambda speed: np.full_like(speed, FAST))
    found = verify(log.write(tmp_path / "log.parquet", ready), program, REQUEST)
    assert not found.has_errors
    half = 50.8 * 8.0 * 6.0
    assert found.volumes.programmed == pytest.approx(half, rel=0.01)
    assert found.volumes.logged == pytest.approx(half, rel=0.01)


def test_a_turned_casting_is_a_bar(tmp_path: Path) -> None:
    """A bar of 60 mm as in the program, with a neck of 58 mm over its first 40 mm."""
    bar = PARTS / "shaft.stpnc"
    profile = (
        (2.0, 0.0),
        (2.0, 29.0),
        (-40.0, 29.0),
        (-40.0, 30.0),
        (-150.0, 30.0),
        (-150.0, 0.0),
    )
    path = cast(tmp_path, revolved(profile), bar, "0.02,$,$,#33,", "0.02,#99000,$,$,")
    program = read_program(path, units="iso")
    setup = program.workingsteps[0].setup
    around = stock_of(program, setup)
    assert around is not None
    assert around.radius == pytest.approx(30.0, abs=0.01)
    run = prepared_program(
        program, load_machine("lathe22"), material_for("c45", program), tell=silent
    )
    stock = run.stock(program.workingsteps[0].id)
    assert isinstance(stock, TurningStock)
    front = stock.outer[(stock.z > -39.9) & (stock.z < 1.9)]
    assert front == pytest.approx(29.0, abs=1e-3)
    assert stock.outer.max() == pytest.approx(30.0, abs=1e-3)
    ready = prepared(bar, SHAFT_REQUEST)
    log = run_log(ready, rate=10.0, feed=lambda speed: np.full_like(speed, FAST))
    place = log.write(tmp_path / "log.parquet", ready)
    whole, less = (verify(place, each, SHAFT_REQUEST).volumes for each in (bar, path))
    ring = np.pi * (30.0**2 - 29.0**2) * 42.0
    assert whole.programmed - less.programmed == pytest.approx(ring, rel=1e-3)
    assert whole.logged - less.logged == pytest.approx(ring, rel=1e-3)


def test_a_program_without_bodies_asks_for_nothing() -> None:
    program = read_program(SLOT, units="iso")
    assert (raw_body(program), finished_body(program)) == (None, None)
    assert isinstance(program.bodies, ProgramBodies)


def both_ways(path: Path, folder: Path) -> tuple[Path, Path]:
    """A program by AP238, and back by ISO 14649, with nothing left out of its geometry."""
    there, back = folder / "there.238", folder / "back.stpnc"
    told = stepnc.convert(path, to="ap238", output=there).findings
    # Products around the solid, to which the program does not refer.
    assert {each.message for each in told} <= {
        "nothing that AP238 expresses refers to it",
    }
    assert not [each for each in told if "ADVANCED" in each.entity or "FACE" in each.entity]
    assert (
        list(deviations(Part21File.from_bytes(there.read_bytes()), schema(long_form()))) == []
    )
    assert stepnc.convert(there, to="iso14649", output=back).findings == ()
    return there, back


def test_a_finished_part_is_converted_both_ways(tmp_path: Path) -> None:
    program = finished(tmp_path, slotted(aside=0.15))
    ready = prepared(SLOT, REQUEST)
    log = run_log(ready, rate=10.0, feed=lambda speed: np.full_like(speed, FAST))
    path = log.write(tmp_path / "log.parquet", ready)
    for each in both_ways(program, tmp_path):
        found = verify(path, each, REQUEST)
        assert _nominal(found, 46.8) == pytest.approx(-0.15, abs=2e-3)
        assert _nominal(found, 54.8) == pytest.approx(0.15, abs=2e-3)


def test_a_raw_part_is_converted_both_ways(tmp_path: Path) -> None:
    casting = without(block(*PLATE), block((-1.0, 46.8, -6.0), (50.8, 54.8, 1.0)))
    program = cast(tmp_path, casting, SLOT, "0.1,$,$,#13,", "0.1,#99000,$,$,")
    exact = 101.6 * 101.6 * 12.7 - 50.8 * 8.0 * 6.0
    for path in (program, *both_ways(program, tmp_path)):
        read = read_program(path, units="iso")
        body = raw_body(read)
        assert body is not None
        triangles = body_triangles(read.file, body, tolerance=0.0254)
        assert volume(triangles) == pytest.approx(exact, rel=1e-6)
        around = stock_of(read, read.workingsteps[0].setup)
        assert around is not None
        assert (*around.low, *around.high) == pytest.approx((*PLATE[0], *PLATE[1]), abs=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("CLOSED_SHELL('',(", "CLOSED_SHELL('',(#7,", "#7 does not exist"),
        ("CYLINDRICAL_SURFACE(", "HELICAL_SURFACE(", "514 has no HELICAL_SURFACE"),
    ],
)
def test_a_body_that_cannot_be_carried_is_told(
    old: str, new: str, told: str, tmp_path: Path
) -> None:
    casting = without(block(*PLATE), bore((20.0, 20.0, 1.0), radius=10.0, depth=20.0))
    path, output = finished(tmp_path, casting), tmp_path / "slot.238"
    text = path.read_text("utf-8")
    assert old in text
    path.write_text(text.replace(old, new), "utf-8")
    found = stepnc.convert(path, to="ap238", output=output).findings
    [reason] = [each for each in found if "faces of the body are left out" in each.message]
    assert told in reason.message
    assert reason.entity.endswith("ADVANCED_BREP_SHAPE_REPRESENTATION")
    assert read_program(output, units="iso").workingsteps[0].id == "MILL SLOT"


def test_a_damaged_body_is_told(tmp_path: Path) -> None:
    path = finished(tmp_path, slotted())
    text = path.read_text("utf-8").replace("CLOSED_SHELL('',(", "CLOSED_SHELL('',(#7")
    path.write_text(text, "utf-8")
    program = read_program(path, units="iso")
    body = finished_body(program)
    assert body is not None
    with pytest.raises(StepNcError, match=r"slot.stpnc: #10\d+ .*: line \d+, column"):
        body_triangles(program.file, body, tolerance=0.0254)
