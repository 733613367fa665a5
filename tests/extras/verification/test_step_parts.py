"""Required parts and stocks from STEP files are what STL files of the same parts are."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extras.verification.run import Verification, VerificationInputs, verify
from service.programs.raw_stock import raw_stock_of, stock_map
from service.requests.program_facts import StockFile
from simulator.library import load_machine
from simulator.motion.segments import Floats
from simulator.removal.engage import MillingStock
from simulator.removal.lathe import TurningStock
from tests.extras.brep.shapes import block, revolved, rounded, without, write_step
from tests.extras.verification.files import write_log
from tests.extras.verification.model import test_required_bar as test_revolved
from tests.extras.verification.test_without_program import (
    LATHE,
    MILL,
    POCKET,
    TURNED,
    pocket_inputs,
    turned_inputs,
)

OFFSET = 0.15


def pocketed() -> Any:
    """A plate with a pocket that has round corners."""
    return without(
        block((0.0, 0.0, -12.0), (40.0, 30.0, 0.0)),
        rounded((8.0, 7.0, -5.0), (32.0, 23.0, 1.0), 3.0),
    )


def pair(
    folder: Path, given: VerificationInputs, step: Path, *, is_turned: bool = False
) -> tuple[Verification, Verification]:
    """Verifications of a log with an offset in X against STL and STEP."""
    points: Floats = TURNED if is_turned else POCKET
    log = write_log(folder / "log.csv", points + np.array([OFFSET, 0.0, 0.0]))
    request = LATHE if is_turned else MILL
    both = (given, VerificationInputs(tools=given.tools, required=step))
    one, other = (verify(log, None, request, inputs=each) for each in both)
    return one, other


def test_an_offset_is_found_against_a_milled_solid(tmp_path: Path) -> None:
    step = write_step(tmp_path / "part.step", pocketed(), schema="AP242DIS", unit="INCH")
    mesh, solid = pair(tmp_path, pocket_inputs(tmp_path), step)
    assert mesh.has_errors
    assert solid.has_errors
    assert len(solid.places) == pytest.approx(len(mesh.places), rel=2e-3)
    assert solid.program == "part.step"
    for found in (mesh, solid):
        walls = found.places[found.places.is_wall]
        x, y, _ = walls.position.T
        is_straight = np.abs(y - 15.0) < 4.0
        for side, sign in ((x > 20.0, -1.0), (x < 20.0, 1.0)):
            assert walls.deviation[side & is_straight] == pytest.approx(sign * OFFSET, abs=1e-3)
    # Straight walls that end in arcs are as certain as the solid's triangles.
    walls = solid.places[
        solid.places.is_wall & (np.abs(solid.places.position[:, 1] - 15.0) < 4.0)
    ]
    assert walls.uncertainty.max() < 0.002 + MILL.tolerance_mm / 5.0
    assert solid.volumes.gouge == pytest.approx(mesh.volumes.gouge, rel=0.01)
    assert solid.volumes.excess == pytest.approx(mesh.volumes.excess, rel=0.01)
    worst = [np.abs(found.places.deviation).max() for found in (mesh, solid)]
    assert worst[1] == pytest.approx(worst[0], abs=MILL.tolerance_mm / 5.0)


def test_an_offset_is_found_against_a_turned_solid(tmp_path: Path) -> None:
    step = write_step(tmp_path / "part.step", revolved(test_revolved.PROFILE))
    mesh, solid = pair(tmp_path, turned_inputs(tmp_path), step, is_turned=True)
    for found in (mesh, solid):
        assert found.has_errors
        r, _, z = found.places.position.T
        side = found.places[(np.abs(r - 15.0) < 0.2) & (z < -1.0) & (z > -19.0)]
        assert len(side) > 100
        assert side.deviation == pytest.approx(OFFSET, abs=2e-3)
    assert solid.volumes.excess == pytest.approx(mesh.volumes.excess, rel=0.01)


def test_a_solid_is_a_stock(tmp_path: Path) -> None:
    path = write_step(tmp_path / "raw.stp", pocketed(), revolved(test_revolved.PROFILE))
    milled = stock_map(load_machine("vmc15"), raw_stock_of(StockFile(path=path, solid="1")))
    assert isinstance(milled, MillingStock)
    pocket = 24.0 * 16.0 - (4.0 - np.pi) * 9.0
    assert milled.map.volume == pytest.approx(14_400.0 - 5.0 * pocket, rel=1e-3)
    turned = stock_map(load_machine("lathe22"), raw_stock_of(StockFile(path=path, solid="2")))
    assert isinstance(turned, TurningStock)
    assert turned.outer.max() == pytest.approx(18.0, abs=1e-6)
