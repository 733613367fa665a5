"""What is asked of NC code and cannot be: told or refused, never passed over."""

from pathlib import Path

import pytest

import stepnc
from optimiser.errors import Infeasible
from stepnc_model.errors import StepNcError

CODE = "G21 G90 G17 G94 G54\nT1 M6\nS4000 M3\nG0 X-10 Y0 Z5\nG1 Z-2 F500\nG1 X60\nG0 Z50\nM30\n"
TOOLS = "number,kind,diameter_mm,teeth,cutting_material\n1,endmill,10,4,carbide\n"


@pytest.fixture
def words(tmp_path: Path) -> dict[str, object]:
    """A program with its tools, stock and material."""
    tools = tmp_path / "tools.csv"
    tools.write_text(TOOLS, encoding="utf-8")
    (tmp_path / "part.nc").write_text(CODE, encoding="utf-8")
    stock = "-20,-20,-20,70,40,0"
    return {"tools": tools, "stock": stock, "material": "c45", "machine": "vmc15"}


def test_a_greatest_feed_below_the_program_is_kept(
    words: dict[str, object], tmp_path: Path
) -> None:
    out = tmp_path / "out.nc"
    found = stepnc.optimise(
        tmp_path / "part.nc", output=out, max_feed_mm_min=100.0, **words  # type: ignore[arg-type]
    )  # fmt: skip
    assert "F500" not in out.read_text(encoding="utf-8")
    assert "--max-feed, is less than programmed" in str(found)


def test_a_roughness_that_no_feed_leaves_is_infeasible(
    words: dict[str, object], tmp_path: Path
) -> None:
    with pytest.raises(Infeasible, match=r"Ra 0\.05 µm"):
        stepnc.optimise(
            tmp_path / "part.nc", mode="QC", roughness_um=0.05, dry_run=True, **words  # type: ignore[arg-type]
        )  # fmt: skip


def test_a_tool_that_is_not_called_is_refused(words: dict[str, object], tmp_path: Path) -> None:
    for option in ("keep", "finish"):
        with pytest.raises(StepNcError, match="T9 of --keep or --finish"):
            stepnc.optimise(
                tmp_path / "part.nc", dry_run=True, **{option: ("T9",)}, **words  # type: ignore[arg-type]
            )  # fmt: skip
