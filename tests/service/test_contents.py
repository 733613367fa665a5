from pathlib import Path

from service.contents import check

PARTS = Path(__file__).parents[2] / "examples" / "parts"


def test_a_sample_is_usable_and_told_whole() -> None:
    contents = check(PARTS / "paper002.stpnc")
    assert contents.is_usable
    assert contents.program is not None
    assert [step.id for step in contents.program.workingsteps] == ["ROUGH THE FACE"]
    assert contents.name == "paper002.stpnc"


def test_a_program_without_a_workplan_is_not(tmp_path: Path) -> None:
    path = tmp_path / "empty.stpnc"
    text = (PARTS / "paper002.stpnc").read_text(encoding="utf-8")
    path.write_text(text.replace("=WORKPLAN(", "=GROUP("), encoding="utf-8")
    contents = check(path)
    assert not contents.is_usable
    assert contents.findings


def test_tolerance_that_cannot_be_read_is_a_warning(tmp_path: Path) -> None:
    text = (PARTS / "bracket.stpnc").read_text().replace("(0.05,0.05,3)", "(0.05,-0.05,3)")
    path = tmp_path / "part.stpnc"
    path.write_text(text)
    contents = check(path)
    assert contents.is_usable
    (found,) = (each for each in contents.findings if "ISO 2768-m is used" in each.message)
    assert found.entity == "#511 PLUS_MINUS_VALUE"
    assert found.line > 0
