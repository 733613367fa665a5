"""The verb ``check``: programs and NC code of any origin, told apart by what they say."""

from pathlib import Path

import pytest

import stepnc
from service.cli.main import main
from service.errors import BAD_INPUT
from service.verbs.check.result import CodeContents
from stepnc_model.errors import StepNcError
from tests.checked import check

PARTS = Path(__file__).parents[4] / "examples" / "parts"


CODE = (
    b"%\nO0100 (PART)\nG21 G90\nT3 M6\nS900 M3\nG0 X0. Y0. Z5.\nG1 Z-1. F100.\nX20. F300.\n"
    b"G65 P9100 A1.\nG90 G0 X0. Y0. Z2.\nG1 Y9. F50.\nG80\nM30\n%\n"
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "part.nc"
    path.write_bytes(CODE)
    return path


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


def test_a_program_that_cannot_be_used_is_bad_input(tmp_path: Path) -> None:
    path = tmp_path / "empty.stpnc"
    text = (PARTS / "paper002.stpnc").read_text(encoding="utf-8")
    path.write_text(text.replace("=WORKPLAN(", "=GROUP("), encoding="utf-8")
    with pytest.raises(SystemExit) as ended:
        main(["check", str(path)])
    assert ended.value.code == BAD_INPUT


def test_the_control_can_be_named(file: Path) -> None:
    contents = stepnc.check(file, dialect="haas")
    assert isinstance(contents, CodeContents)
    assert (contents.control, contents.hints) == ("haas", ())
    with pytest.raises(StepNcError, match="unknown control 'fagor'"):
        stepnc.check(file, dialect="fagor")  # type: ignore[arg-type]


def test_content_tells_nc_code_whatever_its_name(file: Path) -> None:
    renamed = file.rename(file.with_suffix(".stpnc"))
    assert isinstance(stepnc.check(renamed), CodeContents)
    part = file.with_suffix(".ngc")
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    assert check(part).is_usable


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        ({"stock": "0,0,-1,1,1,0"}, "--stock cannot be used with NC code"),
        ({"teeth": "T1=2"}, "--teeth cannot be used with NC code"),
        ({"units": "auto"}, "--units cannot be used with NC code"),
    ],
)
def test_options_of_programs_are_refused_with_code(
    words: dict[str, object], refused: str, file: Path
) -> None:
    with pytest.raises(StepNcError, match=refused):
        stepnc.check(file, **words)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "words", [{"dialect": "haas"}, {"most_repeats": 9}, {"keeps_state": ("P9",)}]
)
def test_options_of_code_are_refused_with_a_program(words: dict[str, object]) -> None:
    with pytest.raises(StepNcError, match="cannot be used with a STEP-NC program"):
        stepnc.check(PARTS / "paper002.stpnc", **words)  # type: ignore[arg-type]


def test_an_external_program_that_keeps_the_state_leaves_feeds_to_advise(
    tmp_path: Path,
) -> None:
    code = tmp_path / "a.nc"
    code.write_text(
        "%\nO1\nG21 G90 G17 G54\nT1 M6\nS5000 M3\nM98 P9000\nG0 X0 Y0\nZ5.\nG1 Z-2. F500.\n"
        "X60.\nM30\n%\n"
    )
    lost, kept = stepnc.check(code), stepnc.check(code, keeps_state=["P9000"])
    assert isinstance(lost, CodeContents)
    assert isinstance(kept, CodeContents)
    assert sum(each.advisable for each in lost.counts) == 0
    assert sum(each.advisable for each in kept.counts) == 2
