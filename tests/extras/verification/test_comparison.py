"""Logs that cannot have made a required part are refused; what its mesh lacks is told."""

from pathlib import Path

import pytest

from extras.verification.run import verify
from simulator.motion.segments import Floats
from stepnc_model.errors import StepNcError
from tests.extras.verification.files import write_log
from tests.extras.verification.model import test_required_part as test_required
from tests.extras.verification.test_without_program import (
    MILL,
    POCKET,
    TURNED,
    milled,
    pocket_inputs,
    turned,
)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (POCKET + 300.0, "never enter the stock"),
        (POCKET / 25.4 - [0.0, 0.0, 0.5], "are they in inches, or is it another part"),
    ],
)
def test_positions_elsewhere_are_refused(tmp_path: Path, points: Floats, message: str) -> None:
    with pytest.raises(StepNcError, match=message):
        milled(tmp_path, points)


def test_turned_positions_in_inches_are_refused(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="in Z; the required part needs a way of"):
        turned(tmp_path, TURNED / 25.4)


def test_an_open_mesh_is_told(tmp_path: Path) -> None:
    log = write_log(tmp_path / "log.csv", POCKET)
    found = verify(log, None, MILL, inputs=pocket_inputs(tmp_path, mesh=test_required.MESH[1:]))
    assert any("3 edges without two triangles" in each.message for each in found.findings)


def test_the_sag_of_facets_is_told(tmp_path: Path) -> None:
    found = turned(tmp_path, TURNED)
    assert any(
        "facets of the required part lie up to 0.0096 mm" in each.message
        for each in found.findings
    )
