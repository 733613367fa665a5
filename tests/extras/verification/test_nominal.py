"""The programmed path of the bracket makes its nominal features."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.verification import SHAFT, SHAFT_REQUEST
from extras.verification.run import VerificationInputs, verified, verify
from stepnc_model.errors import StepNcError
from tests.extras.verification.files import write_stl
from tests.extras.verification.model.box import box
from tests.extras.verification.model.meshes import revolved
from tests.extras.verification.runs import REQUEST, clean, fast_log, program, shaft, shaft_log


def test_the_programmed_surface_is_nominal(tmp_path: Path) -> None:
    found = clean(tmp_path)
    is_known = np.isfinite(found.nominal)
    # All but the bottoms of the holes and what no feature describes.
    assert is_known.mean() > 0.95
    assert np.abs(found.nominal[is_known]).max() < 1.1e-3


def test_a_required_part_takes_the_place_of_the_features(tmp_path: Path) -> None:
    path = fast_log().write(tmp_path / "log.parquet", program())
    # The part is 150 mm wide, and its finished face lies at z = 0.
    block = box((-0.1, -3.0, -40.0), (150.0, 93.0, 0.05))
    found = verified(path, replace(program(), required=block), REQUEST)
    places = found.places
    faces = ~places.is_wall & (places.workingstep == 1)
    assert found.nominal[faces] == pytest.approx(-0.05)
    x, y, _ = places.position.T
    left = places.is_wall & (x < 1e-3) & (places.workingstep == 3) & (np.abs(y - 45.0) < 20.0)
    assert left.any()
    assert found.nominal[left] == pytest.approx(-0.1, abs=2e-3)


def test_a_turned_profile_is_nominal_but_for_its_inner_corners(tmp_path: Path) -> None:
    found = verified(
        shaft_log().write(tmp_path / "log.parquet", shaft()), shaft(), SHAFT_REQUEST
    )
    contour = [step.workingstep for step in found.steps].index("FINISH CONTOUR")
    own = (found.places.workingstep == contour) & (found.places.position[:, 2] > -109.0)
    nominal = found.nominal[own & np.isfinite(found.nominal)]
    # The nose of 0.8 mm leaves its fillet in sharp inner corners, and nothing else.
    assert nominal.max() == pytest.approx(0.8 * (1.0 - 0.5**0.5), abs=0.005)
    assert nominal.min() > -1e-3
    z = found.places.position[:, 2]
    smooth = own & (z < -45.0) & (z > -75.0)
    assert np.abs(found.nominal[smooth]).max() < 1e-3


SHAFT_PROFILE = (
    (0.0, 0.0), (0.0, 13.5), (-1.5, 15.0), (-40.0, 15.0), (-40.0, 20.0), (-60.0, 20.0),
    (-80.0, 22.0), (-80.0, 27.0), (-110.0, 27.0), (-110.0, 0.0),
)  # fmt: skip


def test_a_turned_part_is_compared_with_an_stl_file(tmp_path: Path) -> None:
    log = shaft_log().write(tmp_path / "log.parquet", shaft())
    wider = tuple((z, r - 0.05 if r else 0.0) for z, r in SHAFT_PROFILE)
    path = write_stl(tmp_path / "part.stl", revolved(wider))
    found = verify(log, SHAFT, SHAFT_REQUEST, inputs=VerificationInputs(required=path))
    z = found.places.position[:, 2]
    own = ~found.places.is_wall & (z < -62.0) & (z > -75.0)
    assert found.nominal[own] == pytest.approx(0.05, abs=1e-3)
    write_stl(path, revolved(wider) * [1.01, 1.0, 1.0])
    with pytest.raises(StepNcError, match=r"part\.stl: .*no body of revolution"):
        verify(log, SHAFT, SHAFT_REQUEST, inputs=VerificationInputs(required=path))
