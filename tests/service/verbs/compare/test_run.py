"""Plans side by side: totals, what differs, and what is refused."""

from pathlib import Path

import pytest

import stepnc
from service.verbs.compare.result import ComparisonResult
from stepnc_model.errors import StepNcError

PARTS = Path(__file__).parents[4] / "examples" / "parts"
PART = PARTS / "paper002.stpnc"


@pytest.fixture(scope="module")
def plans(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Plans of one part, as files, and one of another part."""
    folder = tmp_path_factory.mktemp("plans")
    mill = {"machine": "vmc15", "material": "c45"}
    lathe = {"machine": "lathe22", "workingsteps": ("FINISH FACE",)}
    asked: dict[str, tuple[Path, dict[str, object]]] = {
        "usual": (PART, {**mill}),
        "again": (PART, {**mill}),
        "fast": (PART, {**mill, "free": ("feed", "depth", "speed")}),
        "rough": (PARTS / "shaft.stpnc", {**lathe}),
        "fine": (PARTS / "shaft.stpnc", {**lathe, "mode": "QC", "roughness_um": 0.8}),
    }
    for name, (part, words) in asked.items():
        stepnc.optimise(part, dry_run=True, **words).save(folder / f"{name}.json")  # type: ignore[arg-type]
    return {name: folder / f"{name}.json" for name in asked}


def compared(*files: Path) -> ComparisonResult:
    """Comparison of plans in files."""
    found = stepnc.compare(files)
    assert isinstance(found, ComparisonResult)
    return found


def test_totals_are_those_of_the_plans(plans: dict[str, Path]) -> None:
    found = compared(plans["usual"], plans["fast"])
    plan = stepnc.optimise(PART, machine="vmc15", material="c45", dry_run=True)
    assert found.totals[0].time == pytest.approx(plan.time_after, rel=1e-12)
    assert found.totals[1].time < found.totals[0].time
    assert [row.name for row in found.rows] == ["usual", "fast"]


def test_what_differs_is_told_by_workingstep(plans: dict[str, Path]) -> None:
    (line,) = compared(plans["usual"], plans["fast"]).differences
    assert line.startswith("ROUGH THE FACE: fast takes ")
    assert " s less than usual; rpm: 707, not 619" in line


def test_equal_plans_are_told_with_the_limit_of_both(plans: dict[str, Path]) -> None:
    (line,) = compared(plans["usual"], plans["again"]).differences
    assert line == ("again is the same as usual in ROUGH THE FACE: tool deflection limits both")


def test_a_roughness_that_rules_a_plan_out_is_told(plans: dict[str, Path]) -> None:
    (line,) = compared(plans["rough"], plans["fine"]).differences
    assert line.startswith("FINISH FACE: fine takes ")
    assert line.endswith("of rough is above the required 0.8 µm")


def test_the_page_has_totals_and_differences(plans: dict[str, Path]) -> None:
    page = compared(plans["usual"], plans["fast"]).page()
    assert "plans side by side: usual, fast" in page
    assert "ROUGH THE FACE: fast takes" in page


@pytest.mark.parametrize(
    ("names", "words"),
    [
        (("usual",), "1 plan"),
        (("usual", "rough"), "other workingsteps"),
        (("usual",) * 13, "12"),
    ],
)
def test_what_cannot_be_compared_is_refused(
    names: tuple[str, ...], words: str, plans: dict[str, Path]
) -> None:
    with pytest.raises((StepNcError, ValueError), match=words):
        compared(*(plans[name] for name in names))


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"program": 1}', "\x00", '{"along_path": {}}']
)
def test_what_is_no_plan_is_refused(text: str, plans: dict[str, Path], tmp_path: Path) -> None:
    file = tmp_path / "none.json"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(StepNcError, match=r"none\.json: is no"):
        compared(plans["usual"], file)
