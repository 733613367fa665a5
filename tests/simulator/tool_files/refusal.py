"""What a reader says about a file that it refuses."""

from pathlib import Path

import pytest

from simulator.errors import LibraryError
from simulator.tool_files.file_unit import FileUnit
from simulator.tool_files.read import read_tools


def refusal(path: Path, unit: FileUnit | None = None) -> str:
    """Message about a file, without its path; that about a file beside it is whole."""
    with pytest.raises(LibraryError) as refused:
        read_tools(path, unit=unit)
    return str(refused.value).removeprefix(f"{path}: ")
