"""The way of AP238 programs of tool paths alone, as their writers write them."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random

import pytest

from benchmarks.corpus import FOLDERS, programs
from benchmarks.end_to_end import Said, run, table, way
from service.errors import BAD_INPUT
from tests.stepnc_model.ap238.mutations import mutated
from tests.stepnc_model.ap238.writer_samples import SAMPLES, TOOLS, editor_drilling

MUTATED = 300
ANSWERS = {0, 3, 4, 5, 6}


def test_a_way_goes_from_the_check_to_a_second_run(tmp_path: Path) -> None:
    part = tmp_path / "part.stpnc"
    part.write_text(editor_drilling(), encoding="utf-8")
    found = way(part, tmp_path)
    assert found.is_whole
    assert found.options == ("--material", "c45", "--machine", "vmc15")
    assert found.unchanged is not None
    assert 0.97 < found.unchanged < 1.0
    assert "| part.stpnc | 1 freeform_operation |" in table([found])


def test_a_refusal_is_printed_below_the_table(tmp_path: Path) -> None:
    part = tmp_path / "part.stpnc"
    part.write_text(editor_drilling().replace("POLYLINE", "POLYGON"), encoding="utf-8")
    found = way(part, tmp_path)
    assert not found.is_whole
    assert "\n1. part.stpnc, optimise: line " in table([found])


@pytest.mark.slow
@pytest.mark.parametrize("make", SAMPLES, ids=lambda make: make.__name__)
def test_each_sample_goes_the_whole_way(make: Callable[[], str], tmp_path: Path) -> None:
    part = tmp_path / "part.stpnc"
    part.write_bytes(make().encode())
    (tmp_path / "tools.csv").write_text(TOOLS, encoding="utf-8")
    (tmp_path / "out").mkdir()
    found = way(part, tmp_path / "out")
    assert found.is_whole, table([found])


def sources() -> Iterator[tuple[str, bytes]]:
    """Samples and public AP238 programs; the slow turning example is left out."""
    for make in SAMPLES:
        yield make.__name__, make().encode()
    for file in programs(FOLDERS[1]):
        if "turning" not in file.name:
            yield file.stem, file.read_bytes()


@pytest.mark.slow
def test_mutated_programs_are_answered_or_refused_by_line(tmp_path: Path) -> None:
    """300 seeded copies through check, advice and simulation: no traceback."""
    tools, part = tmp_path / "tools.csv", tmp_path / "part.stpnc"
    tools.write_text(TOOLS, encoding="utf-8")
    data = list(sources())
    given = ("--material", "c45", "--tools", tools, "--feed", "240")
    for seed in range(MUTATED):
        name, text = data[seed % len(data)]
        part.write_bytes(mutated(text, Random(seed)))
        out = tmp_path / "out.stpnc"
        out.unlink(missing_ok=True)
        for words in (
            ("check", part),
            ("optimise", part, *given, "-o", out),
            ("simulate", part, *given),
        ):
            said = run(*words)
            assert said.code in ANSWERS, (seed, name, words[0], said)
            if said.code == BAD_INPUT:
                assert not out.exists(), (seed, name, words[0])
                assert _is_said(said), (seed, name, words[0], said)


def _is_said(said: Said) -> bool:
    """True if a refusal has words."""
    return bool(re.search(r"^error: \S|^  .*: no: \S", said.told + said.out, re.MULTILINE))
