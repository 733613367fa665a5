"""Design files: read in canonical units, refused with key, value and bound."""

from math import pi
from pathlib import Path

import pytest

from extras.factory.model.design import DesignKind
from extras.factory.model.design_file import read_design
from simulator.errors import LibraryError
from tests.every_case import every_case

WHOLE = """program = ["one.stpnc", "two.stpnc"]
machine = "paper003"
material = "aisi1018"
feed_mm_s = [30, 90]
spindle_rad_s = [75.4, 226.2]
design = "latin-hypercube"
seed = 7
deviation = true
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "design.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_design_file_is_read(tmp_path: Path) -> None:
    file = read_design(written(tmp_path, WHOLE))
    design = file.design
    assert file.programs == (tmp_path / "one.stpnc", tmp_path / "two.stpnc")
    assert [each.name for each in file.machines] == ["paper003"]
    assert file.materials == ("aisi1018",)
    assert file.has_deviation
    assert (design.kind, design.seed, design.programs) == (DesignKind.LATIN_HYPERCUBE, 7, 2)
    assert design.feed is not None
    assert (design.feed.low, design.feed.high) == (30.0, 90.0)
    assert design.spindle_speed is not None
    assert design.spindle_speed.high == pytest.approx(226.2 / (2 * pi))
    assert design.depth is None


@every_case(
    ("old", "new", "key", "word"),
    [
        ("[30, 90]", "[90, 30]", "feed_mm_s", "greater upper bound"),
        ("[30, 90]", "[30, 30]", "feed_mm_s", "greater upper bound"),
        ("[30, 90]", "[30]", "feed_mm_s", "greater upper bound"),
        ("[30, 90]", "[-1, 90]", "feed_mm_s[1]", "below 0.001"),
        ('"latin-hypercube"', '"random"', "design", "not one of"),
        ('"latin-hypercube"', '"full-factorial"', "levels", "missing"),
        ("seed = 7", "levels = 3", "levels", "belongs to"),
        ("seed = 7", "seed = 1.5", "seed", "whole number"),
        ("feed_mm_s", "feed_mm_min", "feed_mm_min", "unknown key"),
        ('machine = "paper003"\n', "", "machine", "missing"),
        ('["one.stpnc", "two.stpnc"]', '["a", "a"]', "program", "one name"),
    ],
)
def test_a_bad_file_is_refused(tmp_path: Path, old: str, new: str, key: str, word: str) -> None:
    text = WHOLE.replace(old, new)
    assert text != WHOLE
    with pytest.raises(LibraryError) as caught:
        read_design(written(tmp_path, text))
    assert caught.value.key == key
    assert word in caught.value.message


def test_a_refusal_names_the_key_the_value_and_what_is_expected(tmp_path: Path) -> None:
    path = written(tmp_path, WHOLE.replace("[30, 90]", "[90, 30]"))
    with pytest.raises(LibraryError) as caught:
        read_design(path)
    assert str(caught.value) == (
        f"{path}: feed_mm_s: [90, 30]: expected a lower and a greater upper bound"
    )


def test_a_range_that_is_left_out_does_not_vary(tmp_path: Path) -> None:
    text = WHOLE.replace("spindle_rad_s = [75.4, 226.2]\n", "")
    assert read_design(written(tmp_path, text)).design.spindle_speed is None


def test_a_design_without_ranges_is_refused(tmp_path: Path) -> None:
    path = written(tmp_path, 'program = "one.stpnc"\nmachine = "paper003"\n')
    with pytest.raises(LibraryError, match="nothing varies: give one of feed_mm_s"):
        read_design(path)
