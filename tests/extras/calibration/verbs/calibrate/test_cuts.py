"""``calibrate --table`` and ``validate``: batches, refusals, and nothing written on error."""

from pathlib import Path

import numpy as np
import pytest

import stepnc
from simulator.files.material_file import MaterialFile
from simulator.files.toml_file import read_toml
from simulator.library import load_material
from simulator.physics.tool_life import tool_life
from simulator.spec import CuttingMaterial
from stepnc_model.errors import StepNcError
from stepnc_model.units import speed_from_m_min

HEAD = "feed_mm,axial_depth_mm,cutting_force_n"
CUTS = ("0.1,2,420", "0.15,2,570", "0.2,2,700", "0.25,2,830", "0.3,2,950", "0.35,2,1060")


def _table(path: Path, *rows: str, head: str = HEAD) -> str:
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    return str(path)


def _calibrate(folder: Path, name: str, material: str, rows: tuple[str, ...]) -> str:
    out = str(folder / f"{name}.toml")
    table = _table(folder / f"{name}.csv", *rows)
    stepnc.calibrate(table=table, material=material, output=out)
    return out


def test_batches_in_any_order_agree(tmp_path: Path) -> None:
    whole = _calibrate(tmp_path, "whole", "c45", CUTS)
    first = _calibrate(tmp_path, "first", "c45", CUTS[:4])
    then = _calibrate(tmp_path, "then", first, CUTS[4:])
    last = _calibrate(tmp_path, "last", "c45", CUTS[2:])
    back = _calibrate(tmp_path, "back", last, CUTS[:2])
    laws = [read_toml(Path(p), MaterialFile).calibration for p in (whole, then, back)]
    forces = [law.forces for law in laws if law is not None and law.forces is not None]
    sd = np.sqrt(np.diag(forces[0].covariance)) * forces[0].prior_sd
    for law in forces[1:]:
        assert np.all(np.abs(np.subtract(law.mean, forces[0].mean)) < 0.1 * sd)
    assert len({law.digest for law in laws if law is not None}) == 1


def test_the_written_material_is_that_of_the_rows(tmp_path: Path) -> None:
    found = load_material(_calibrate(tmp_path, "m", "c45", CUTS))
    kienzle = found.kienzle
    assert kienzle.k_c11 * 0.2**-kienzle.m_c == pytest.approx(1750.0, rel=0.02)
    assert found.spread is not None
    assert found.spread < 0.1
    assert found.windows == load_material("c45").windows


def test_rows_of_a_calibrated_material_are_predicted_from_its_rows(tmp_path: Path) -> None:
    model = _calibrate(tmp_path, "m", "c45", CUTS[:5])
    test = _table(tmp_path / "test.csv", CUTS[5])
    (row,) = stepnc.validate(table=test, material=model).record()["predictions"]
    assert row["predicted"] == pytest.approx(1060.0, rel=0.03)
    assert row["is_inside"] == "yes"


def test_marked_rows_are_fitted_and_the_others_predicted(tmp_path: Path) -> None:
    rows = [f"{row},{'fit' if at < 4 else 'test'}" for at, row in enumerate(CUTS)]
    table = _table(tmp_path / "t.csv", *rows, head=f"{HEAD},use")
    found = stepnc.validate(table=table, material="c45").record()["predictions"]
    assert [row["measured"] for row in found] == [pytest.approx(950.0), pytest.approx(1060.0)]


def test_the_same_table_twice_is_refused(tmp_path: Path) -> None:
    model = _calibrate(tmp_path, "m", "c45", CUTS)
    with pytest.raises(StepNcError, match="already calibrated"):
        _calibrate(tmp_path, "again", model, CUTS)
    assert not (tmp_path / "again.toml").exists()


def test_edited_rows_are_refused(tmp_path: Path) -> None:
    model = Path(_calibrate(tmp_path, "m", "c45", CUTS[:3]))
    model.write_text(model.read_text().replace("420.0", "520.0"))
    with pytest.raises(StepNcError, match="digest"):
        _calibrate(tmp_path, "next", str(model), CUTS[3:])


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (("0.1,2,x",), "line 2: cutting_force_n: 'x' is not a number"),
        (("0.1,2,420",), "1 row of forces; at least 2"),
        (("0.1,2,",), "no row serves forces, roughness, life"),
    ],
)
def test_a_table_that_teaches_nothing_writes_nothing(
    tmp_path: Path, rows: tuple[str, ...], said: str
) -> None:
    with pytest.raises(StepNcError, match=said):
        _calibrate(tmp_path, "m", "c45", rows)
    assert not (tmp_path / "m.toml").exists()


def test_a_law_that_loses_to_a_simpler_rule_is_written_only_when_forced(tmp_path: Path) -> None:
    # k_c that does not depend on the feed, and so little scatter that the mean is exact.
    rows = tuple(f"{feed},2,{4000 * feed:.6g}" for feed in (0.05, 0.1, 0.2, 0.4, 0.8))
    with pytest.raises(StepNcError, match="--anyway"):
        _calibrate(tmp_path, "m", "c45", rows)
    out = tmp_path / "m.toml"
    assert not out.exists()
    table = _table(tmp_path / "m.csv", *rows)
    found = stepnc.calibrate(table=table, material="c45", output=str(out), anyway=True)
    assert out.exists()
    assert "constant k_c" in str(found)


def test_a_table_needs_its_material(tmp_path: Path) -> None:
    with pytest.raises(StepNcError, match="--material"):
        stepnc.calibrate(table=_table(tmp_path / "t.csv", *CUTS))


def test_exponents_of_tool_life_are_written_for_plans(tmp_path: Path) -> None:
    """Lives of a made shop, T = 20 min·(v/200)^−4·(f/0.2)^−1.6·(a/2)^−0.3."""
    rows = [
        f"{v},{f},{a},{20.0 * (v / 200.0) ** -4.0 * (f / 0.2) ** -1.6 * (a / 2.0) ** -0.3:.4f}"
        for v in (160.0, 200.0, 250.0)
        for f in (0.1, 0.2, 0.4)
        for a in (1.0, 3.0)
    ]
    out = tmp_path / "own.toml"
    head = "cutting_speed_m_min,feed_mm,axial_depth_mm,life_min"
    table = _table(tmp_path / "lives.csv", *rows, head=head)
    stepnc.calibrate(table=table, material="c45", output=str(out))
    law = next(
        each.taylor
        for each in load_material(str(out)).windows
        if each.cutting_material is CuttingMaterial.CARBIDE and each.taylor is not None
    )
    assert law.feed_exponent == pytest.approx(1.6, abs=0.15)
    assert law.depth_exponent == pytest.approx(0.3, abs=0.1)
    # The life that a plan reads at another cut is the shop's.
    life = tool_life(law, speed_from_m_min(180.0)) / 60.0
    life *= (0.3 / law.feed) ** -law.feed_exponent * (1.5 / law.depth) ** -law.depth_exponent
    made = 20.0 * (180.0 / 200.0) ** -4.0 * 1.5**-1.6 * 0.75**-0.3
    assert life == pytest.approx(made, rel=0.1)
