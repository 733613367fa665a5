"""``control`` from Python: its band, its records, and its exit code."""

from pathlib import Path

import pytest

import stepnc
from stepnc_model.errors import StepNcError

PAPER = Path(__file__).parents[4] / "examples" / "parts" / "paper002.stpnc"


def test_a_harder_material_is_found(tmp_path: Path) -> None:
    place = tmp_path / "k.db"
    found = stepnc.control(
        PAPER, machine="vmc15", material="c45", disturbances=["kc:1.2"], band="30,110", kb=place
    )
    assert found.exit_code == 0
    record = found.record()
    assert record["override_band"] == [0.3, 1.1]
    (step,) = [each for each in record["workingsteps"] if each["kc_factor"]]
    assert step["kc_factor"]["value"] == pytest.approx(1.2, abs=0.02)
    assert max(found.table("workingsteps")["override.greatest"].to_pylist()) <= 1.1
    assert place.exists()


def test_a_bad_band_is_refused() -> None:
    with pytest.raises(StepNcError, match="override band"):
        stepnc.control(PAPER, machine="vmc15", material="c45", band="30")
