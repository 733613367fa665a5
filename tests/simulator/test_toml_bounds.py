"""Bounds of library files: what is sane passes, what would cost the parser dear does not."""

import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Annotated, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.errors import LibraryError
from simulator.files.toml_file import (
    LONGEST_WORD,
    MOST_BYTES,
    MOST_NESTED,
    MOST_PARTS,
    FileTable,
    converted,
    parsed,
    quantity,
    read_text,
    require_bounded,
)
from simulator.library import DATA
from tests.every_case import every_case

SIZE = 1 << 16

HOSTILE = {
    "dotted key": "a" + ".a" * (SIZE // 2) + "=1",
    "quoted key": '"a"' + '. "a"' * (SIZE // 5) + "=1",
    "literal key": "'a'" + ".'a'" * (SIZE // 4) + "=1",
    "header": "[a" + ".a" * (SIZE // 2) + "]",
    "key in an inline table": "x={a" + ".a" * (SIZE // 2) + "=1}",
    "key behind a string": 'x="""a"""""\na' + ".a" * (SIZE // 2) + "=1",
    "arrays": "x=" + "[" * SIZE,
    "inline tables": "x=" + "{a=" * SIZE,
    "digits": "x=" + "9" * SIZE,
    "hexadecimal digits": "x=0x" + "f" * SIZE,
    "key": "a" * SIZE + "=1",
}


def write(folder: Path, text: str) -> Path:
    path = folder / "my.toml"
    path.write_text(text, encoding="utf-8", newline="")
    return path


def content_of(path: Path) -> dict[str, Any]:
    return parsed(read_text(path), path)


@every_case("text", HOSTILE.values())
def test_a_text_that_would_cost_the_parser_dear_is_refused_with_its_line(
    tmp_path: Path, text: str
) -> None:
    path = write(tmp_path, f"title = 'ours'\n{text}")
    with pytest.raises(LibraryError, match=r"more than 20|at most 400") as caught:
        content_of(path)
    assert caught.value.line >= 2
    assert caught.value.path == str(path)
    assert len(str(caught.value)) < 300


def test_a_hostile_file_costs_no_memory(tmp_path: Path) -> None:
    path = write(tmp_path, HOSTILE["dotted key"])
    words = (
        "import resource, sys; from pathlib import Path\n"
        "from simulator.files.toml_file import parsed, read_text\n"
        "resource.setrlimit(resource.RLIMIT_AS, (1 << 29, 1 << 29))\n"
        "resource.setrlimit(resource.RLIMIT_CPU, (10, 10))\n"
        "path = Path(sys.argv[1]); parsed(read_text(path), path)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", words, str(path)], capture_output=True, text=True, check=False
    )
    assert "LibraryError" in done.stderr, done.stderr[-300:]


def test_a_file_of_more_bytes_than_the_most_is_not_read(tmp_path: Path) -> None:
    path = write(tmp_path, "#" * (MOST_BYTES + 1))
    with pytest.raises(LibraryError, match=f"larger than {MOST_BYTES} bytes"):
        content_of(path)
    assert len(read_text(write(tmp_path, "#" * MOST_BYTES))) == MOST_BYTES


def test_a_text_at_the_bounds_is_read(tmp_path: Path) -> None:
    deep = ".".join("a" * MOST_PARTS)
    text = (
        f"{deep} = 1\n[b.{'.'.join('c' * (MOST_PARTS - 1))}]\n"
        f"{'d' * LONGEST_WORD} = {'[' * MOST_NESTED}{']' * MOST_NESTED}\n"
    )
    assert "a" in content_of(write(tmp_path, text))


@every_case(
    "text",
    [
        "x = '''{0}'{0}'''",
        'x = """{0}"\\"""{0}"""""',
        'x = "{0}\\"{0}"',
        "x = '{0}'",
        "# {0}\nx = 'a' # {0}",
        'x = """\\\\""" # {0}',
        '"{0}" = 1\nx = 1',
        "x = [\n'{0}', # {0}\n'{0}']",
    ],
)
def test_what_stands_in_strings_and_comments_does_not_count(tmp_path: Path, text: str) -> None:
    stuff = "a.b[{" * 100 + "9" * 1000
    path = write(tmp_path, text.replace("{0}", stuff))
    assert "x" in content_of(path)


def test_many_small_tables_and_numbers_are_no_nesting(tmp_path: Path) -> None:
    rows = "".join(f"[[tool]]\nspan = [[1.5, 2.5], [3.5, 4.5]] # {n}\n" for n in range(5000))
    assert len(content_of(write(tmp_path, rows))["tool"]) == 5000


def test_every_file_of_the_library_is_ten_times_below_the_bounds() -> None:
    files = list(DATA.rglob("*.toml"))
    assert files
    for path in files:
        assert path.stat().st_size * 10 < MOST_BYTES
        content_of(path)


@given(st.text(alphabet="a.=[]{}\"'\\\n#,1 ", max_size=200))
def test_what_the_parser_takes_is_refused_for_a_bound_only_when_it_passes_one(
    text: str,
) -> None:
    try:
        tomllib.loads(text)
    except ValueError:
        return
    if text.count(".") < MOST_PARTS and text.count("[") + text.count("{") <= MOST_NESTED:
        require_bounded(text, Path("my.toml"))


class Power(FileTable, frozen=True, kw_only=True):
    power_kw: Annotated[float, quantity(0, 100, "kW")]


class Titled(FileTable, frozen=True, kw_only=True):
    spindle: Power | None = None
    title: str = ""
    x: Annotated[float, quantity(0, 1)] = 0.0


@pytest.mark.parametrize("number", [10**308 * 9, -(10**309), 10**399])
def test_an_integer_beyond_a_float_is_an_error_with_its_key(number: int) -> None:
    content = parsed(f"[spindle]\npower_kw = {number}", Path("my.toml"))
    with pytest.raises(LibraryError, match=r"spindle\.power_kw: .*expected|exceeds") as caught:
        converted(content, Titled, Path("my.toml"))
    assert len(str(caught.value)) < 300


@pytest.mark.parametrize("text", [f"title = [{'1,' * 10_000}]", f"x = '{'a' * 10_000}'"])
def test_a_long_value_of_another_kind_is_shown_cut(text: str) -> None:
    with pytest.raises(LibraryError) as caught:
        converted(parsed(text, Path("my.toml")), Titled, Path("my.toml"))
    assert len(str(caught.value)) < 300
