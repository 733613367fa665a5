"""The usual block of a long program takes a short way to what all others become."""

from pathlib import Path

import pytest

from stepnc_model.nc import neutral_blocks
from stepnc_model.nc.program import read_program
from stepnc_model.post.blocks import Linear

POSTS = sorted((Path(__file__).parents[2] / "data" / "posts").iterdir())


@pytest.mark.parametrize("file", POSTS, ids=[file.name for file in POSTS])
def test_the_short_way_gives_the_blocks_of_the_long_one(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = read_program(file.read_bytes())
    short = list(neutral_blocks.neutral_blocks(program))
    assert any(isinstance(block, Linear) for _, block in short)
    monkeypatch.setattr(neutral_blocks, "_goes_on", lambda _state, _move: False)
    assert list(neutral_blocks.neutral_blocks(program)) == short
