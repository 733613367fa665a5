"""What ``optimise`` makes of foreign NC code, as the benchmark prints it."""

from pathlib import Path

from benchmarks.wild_code import POSTS, programs, table, tried

LATHE = (
    "(BAR 40)\nG18 G21 G90 G95\nT0101\nG97 S800 M3\nG0 X42. Z1.\nX38.\n"
    "G1 Z-20. F0.2\nG0 X42.\nM30\n"
)


def test_a_program_of_a_post_needs_a_material_alone() -> None:
    found = tried(POSTS / "heidenhain.h")
    assert (found.taken_for, found.needed, found.error) == ("heidenhain mill", "", "")
    assert found.share > 0.9
    assert 0.0 < found.after < found.before


def test_stand_ins_are_told_as_needed(tmp_path: Path) -> None:
    part = tmp_path / "turned.nc"
    part.write_text(LATHE)
    found = tried(part)
    assert found.taken_for.endswith("lathe")
    assert "tools" in found.needed
    assert "stock" in found.needed
    assert not found.error


def test_what_is_no_nc_code_is_a_row_too(tmp_path: Path) -> None:
    (tmp_path / "a.nc").write_bytes(b"\x00\x01binary")
    rows = [tried(each) for each in programs([tmp_path])]
    lines = list(table(rows))
    assert "| a.nc | no NC code |" in lines[2]
    assert "1 refused" in lines[4]
