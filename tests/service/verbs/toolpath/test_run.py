"""The verb ``toolpath``: paths of programs, moves of NC code, and what is refused."""

import logging
from pathlib import Path

import pytest

import stepnc
from service.cli.main import main
from service.errors import BAD_INPUT, OK
from service.programs.toolpaths import Paths
from service.verbs.toolpath.result import CodePathResult, ToolPathResult
from stepnc_model.errors import SchemaError, StepNcError, WriteError
from stepnc_model.toolpath.path import MoveType, ToolPath

PARTS = Path(__file__).parents[4] / "examples" / "parts"
BRACKET = PARTS / "bracket.stpnc"
SHAFT = PARTS / "shaft.stpnc"
PNG = b"\x89PNG\r\n\x1a\n"

CODE = """G21 G90 G17
T1 M6
G0 X0 Y0 Z5
G1 Z-1 F100
G2 X20 Y0 I10 J0
T2 M6
G0 Z4
G0 Z-3
G4 P0.5
M2
"""


def paths_of(file: Path, **words: object) -> Paths:
    """Tool paths of a program."""
    result = stepnc.toolpath(file, **words)  # type: ignore[arg-type]
    assert isinstance(result, ToolPathResult)
    return result.paths


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """A bracket with a pocket that has no room for its corners."""
    text = BRACKET.read_text()
    narrow = text.replace(
        "#149=TOLERANCED_LENGTH_MEASURE(50.", "#149=TOLERANCED_LENGTH_MEASURE(15."
    )
    assert narrow != text
    path = tmp_path / "part.stpnc"
    path.write_text(narrow)
    return path


@pytest.fixture
def code(tmp_path: Path) -> Path:
    """NC code in a file whose name does not tell it."""
    path = tmp_path / "code.txt"
    path.write_text(CODE)
    return path


def test_every_workingstep_of_the_bracket_gets_a_path() -> None:
    paths = paths_of(BRACKET)
    assert [path.id for path in paths.paths] == [step.id for step in paths.program.workingsteps]
    assert all(
        any(move.type is MoveType.CONTACT for move in path.moves) for path in paths.paths
    )


def test_stops_stay_between_the_paths() -> None:
    kinds = [isinstance(item, ToolPath) for item in paths_of(BRACKET).items]
    assert kinds.count(False) == 1
    assert not kinds[4]


def test_a_workingstep_without_a_path_ends_the_run(part: Path) -> None:
    with pytest.raises(SchemaError, match="#140 CLOSED_POCKET"):
        stepnc.toolpath(part)


def test_keep_going_makes_the_others_and_says_what_is_left_out(
    part: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, logger="stepnc"):
        result = stepnc.toolpath(part, keep_going=True)
    assert isinstance(result, ToolPathResult)
    paths = result.paths
    left = {step.id for step in paths.program.workingsteps} - {path.id for path in paths.paths}
    assert left == {"ROUGH POCKET", "FINISH POCKET"}
    assert len(paths.faults) == len(result.record()["left_out"]) == 2
    assert [line for line in caplog.messages if line.startswith("left out: ")]
    assert result.exit_code == BAD_INPUT


def test_a_program_of_which_nothing_is_left_is_an_error(part: Path) -> None:
    text = part.read_text().replace("#1=PROJECT('BRACKET',#2", "#1=PROJECT('BRACKET',#5")
    part.write_text(
        text.replace(
            "#5=WORKPLAN('POCKETS',(#16,#17,#18,#19)", "#5=WORKPLAN('POCKETS',(#16,#17)"
        )
    )
    with pytest.raises(SchemaError):
        stepnc.toolpath(part, keep_going=True)


def test_code_is_told_by_its_content(code: Path) -> None:
    result = stepnc.toolpath(code, dialect="fanuc")
    assert isinstance(result, CodePathResult)
    assert result.program.dialect.value == "fanuc"
    assert len(result.program.moves) == 6
    assert result.exit_code == OK


@pytest.mark.parametrize("file", [SHAFT, None])
def test_a_picture_is_a_png(file: Path | None, code: Path, tmp_path: Path) -> None:
    picture = tmp_path / "path.png"
    stepnc.toolpath(file or code, plot=picture)
    assert picture.read_bytes().startswith(PNG)


def test_a_raw_part_of_code_is_drawn_alone(code: Path, tmp_path: Path) -> None:
    stock = "0,0,-5,20,20,0"
    with pytest.raises(StepNcError, match="--stock of NC code is only drawn"):
        stepnc.toolpath(code, stock=stock)
    found = stepnc.toolpath(code, stock=stock, plot=tmp_path / "path.png")
    assert isinstance(found, CodePathResult)
    assert found.stock is not None
    assert found.stock.high == (20.0, 20.0, 0.0)


def test_another_kind_of_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WriteError, match=r"\.png"):
        stepnc.toolpath(SHAFT, plot=tmp_path / "path.svg")


def test_the_picture_does_not_replace_the_program(tmp_path: Path) -> None:
    file = tmp_path / "part.png"
    file.write_bytes(SHAFT.read_bytes())
    with pytest.raises(SystemExit) as ended:
        main(["toolpath", str(file), "--plot", str(file)])
    assert ended.value.code == BAD_INPUT
    assert file.read_bytes() == SHAFT.read_bytes()


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        ({"keep_going": True}, "--keep-going cannot be used with NC code"),
        ({"feed": "240"}, "--feed cannot be used with NC code"),
        ({"dialect": "canonical"}, "canonical commands are no NC code"),
    ],
)
def test_options_of_programs_are_refused_with_code(
    words: dict[str, object], refused: str, code: Path
) -> None:
    with pytest.raises(StepNcError, match=refused):
        stepnc.toolpath(code, **words)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "words", [{"dialect": "haas"}, {"most_repeats": 9}, {"keeps_state": ("P9",)}]
)
def test_options_of_code_are_refused_with_programs(words: dict[str, object]) -> None:
    with pytest.raises(StepNcError, match="cannot be used with a STEP-NC program"):
        stepnc.toolpath(BRACKET, **words)  # type: ignore[arg-type]
