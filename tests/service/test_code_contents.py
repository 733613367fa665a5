"""Names of files tell NC code where its content is not read."""

from pathlib import Path

from service.code_contents import is_code


def test_a_file_name_tells_nc_code(tmp_path: Path) -> None:
    assert is_code(tmp_path / "a.NGC")
    assert not is_code(tmp_path / "a.stpnc")
