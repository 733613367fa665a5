"""NC code that ``optimise --nc`` writes beside a program."""

from pathlib import Path

import pytest

from service.cli.main import optimise_main
from service.errors import BAD_INPUT, OK

PARTS = Path(__file__).parents[3] / "examples" / "parts"
SHAFT = PARTS / "shaft.stpnc"


def test_optimise_writes_nc_code_with_the_advised_feeds(tmp_path: Path) -> None:
    part = tmp_path / "paper002.stpnc"
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "paper002", "--nc", "linuxcnc"])
    assert stopped.value.code == OK
    text = (tmp_path / "paper002.optimised.ngc").read_text()
    # 290.0 mm/min is the advice for the paper's own part: its Table 2 and the README.
    assert "F290\n" in text


def test_nc_code_never_replaces_the_program(tmp_path: Path) -> None:
    part, output = tmp_path / "part.ngc", tmp_path / "part.x"
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    words = [part, "--machine", "paper002", "--nc", "linuxcnc", "-o", output]
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(word) for word in words])
    assert stopped.value.code == BAD_INPUT
    assert [each.name for each in tmp_path.iterdir()] == ["part.ngc"]


def test_optimise_writes_nothing_where_the_control_cannot_do_it(tmp_path: Path) -> None:
    part = tmp_path / "shaft.stpnc"
    part.write_bytes(SHAFT.read_bytes())
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--nc", "heidenhain"])
    assert stopped.value.code == BAD_INPUT
    assert [each.name for each in tmp_path.iterdir()] == ["shaft.stpnc"]


def test_a_dry_run_writes_no_nc_code_either(tmp_path: Path) -> None:
    part = tmp_path / "paper002.stpnc"
    part.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    with pytest.raises(SystemExit) as stopped:
        optimise_main([str(part), "--machine", "paper002", "--nc", "fanuc", "--dry-run"])
    assert stopped.value.code == OK
    assert [each.name for each in tmp_path.iterdir()] == ["paper002.stpnc"]
