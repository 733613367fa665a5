"""NC code of any origin, as ``stepnc check`` shows it."""

import json
from pathlib import Path

import pytest

from service.code_contents import check_code, is_code
from service.code_contents_output import code_json, print_code
from stepnc_model.errors import StepNcError

CODE = (
    b"%\nO0100 (PART)\nG21 G90\nT3 M6\nS900 M3\nG0 X0. Y0. Z5.\nG1 Z-1. F100.\nX20. F300.\n"
    b"G65 P9100 A1.\nG90 G0 X0. Y0. Z2.\nG1 Y9. F50.\nG80\nM30\n%\n"
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "part.nc"
    path.write_bytes(CODE)
    return path


def test_control_tools_feeds_and_what_is_not_understood_are_told(
    file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    print_code(check_code(file))
    shown = capsys.readouterr().out
    assert "fanuc mill (guessed from O0100, G65 P), mm, 14 blocks" in shown
    assert "line 9: not understood: a macro call: G65 P9100 A1." in shown
    assert "rewriting without advice gives the file byte for byte" in shown


def test_json_counts_moves_by_tool_and_kind(file: Path) -> None:
    found = json.loads(code_json(check_code(file)))
    lines = next(each for each in found["moves"] if each["kind"] == "line")
    assert (lines["tool"], lines["least_feed_mm_min"], lines["greatest_feed_mm_min"]) == (
        3,
        50.0,
        300.0,
    )
    assert lines["advisable"] >= 2
    assert found["is_lossless"] is True
    assert next(each["line"] for each in found["findings"]) == 9


def test_the_control_can_be_named(file: Path) -> None:
    contents = check_code(file, control="haas")
    assert (contents.control, contents.hints) == ("haas", ())
    with pytest.raises(StepNcError, match="unknown control 'fagor'"):
        check_code(file, control="fagor")


def test_a_file_name_tells_nc_code(tmp_path: Path) -> None:
    assert is_code(tmp_path / "a.NGC")
    assert not is_code(tmp_path / "a.stpnc")
