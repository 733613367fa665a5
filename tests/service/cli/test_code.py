"""``optimise`` and ``simulate`` on NC code, as typed: exit codes and first lines."""

from pathlib import Path

import pytest

from service.cli.main import main
from tests.every_case import every_case

TOOLS = "number,kind,diameter_mm,teeth,centre_cutting\n1,endmill,10,3,true\n2,drill,8,2,true\n"
HEAD = "%\nO0001\nG21 G90 G17\nT1 M6\nS5000 M3\nG0 G54 X-10. Y5.\nG43 H1 Z5.\n"
SLOT = "G1 Z-2. F500.\nX60. F500.\nG0 Z50.\n"
END = "M30\n%\n"
CRASH = HEAD + "G0 Z-8.\nG0 X60.\nG1 Y20. F500.\nG0 Z50.\n" + END
FORCED = HEAD + "G1 Z-8. F100.\nX60. F[#500]\nG0 Z50.\n" + END
"""With a feed of a variable that is not known."""


def run(*words: object) -> int:
    with pytest.raises(SystemExit) as ended:
        main([str(word) for word in words])
    return int(ended.value.code or 0)


class Shop:
    """A folder with a program and its tools."""

    def __init__(self, folder: Path, text: str) -> None:
        self.program, self.tools = folder / "part.nc", folder / "tools.csv"
        self.output = folder / "out.nc"
        self.program.write_text(text)
        self.tools.write_text(TOOLS)
        self.given = (
            "--tools", self.tools, "--stock=-20,-20,-20,70,40,0", "--material", "c45",
            "--machine", "vmc15",
        )  # fmt: skip

    def optimise(self, *more: object) -> int:
        return run("optimise", self.program, "-o", self.output, *self.given, *more)


def test_a_rapid_through_material_ends_with_5_and_is_told_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shop = Shop(tmp_path, CRASH)
    for words in (
        ("optimise", shop.program, "-o", shop.output),
        ("simulate", "--nc", shop.program),
    ):
        assert run(*words, *shop.given) == 5
        first, *others = capsys.readouterr().out.splitlines()
        assert "a rapid move cuts" in first
        assert first not in others


@every_case(("text", "words"), [(FORCED, "permitted force")])
def test_a_bound_that_stays_broken_ends_with_5(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert Shop(tmp_path, text).optimise() == 5
    out = capsys.readouterr().out
    assert out.startswith("error: ")
    assert words in out


def test_nothing_advised_ends_with_6_and_writes_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shop = Shop(tmp_path, HEAD + "G0 Z50.\n" + END)
    assert shop.optimise() == 6
    assert "nothing was written" in capsys.readouterr().err
    assert not shop.output.exists()


def test_a_second_run_writes_the_same_bytes(tmp_path: Path) -> None:
    shop = Shop(tmp_path, HEAD + SLOT + END)
    assert shop.optimise() == 0
    again = tmp_path / "again.nc"
    assert run("optimise", shop.output, "-o", again, *shop.given) == 0
    assert again.read_bytes() == shop.output.read_bytes()
