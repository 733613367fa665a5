"""Faults that are drawn for mutation testing, and the tests that look for them first."""

import ast
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from random import Random

import pytest

from benchmarks.faults import Mutant, faults, mutants
from benchmarks.house import ROOT
from benchmarks.mutants import Clone, Verdict
from benchmarks.rings import Stage, imports, stages

SAMPLES = (
    "controller/monitoring/overload.py",
    "kbe/statistics.py",
    "simulator/physics/cutting.py",
)


@pytest.fixture(scope="module")
def sources() -> dict[str, bytes]:
    return {path: (ROOT / path).read_bytes() for path in SAMPLES}


def test_one_place_of_a_mutant_is_changed_in_its_line(sources: dict[str, bytes]) -> None:
    possible = {path: faults(text) for path, text in sources.items()}
    for each in mutants(sources, Random(3)):
        assert each.before == sources[each.path]
        found = possible[each.path][each.line]
        for one in found:
            assert each.before.count(b"\n", 0, one.begin) + 1 == each.line
        assert each.after in {
            each.before[: one.begin] + one.text.encode() + each.before[one.end :]
            for one in found
        }


def test_a_mutant_is_another_program(sources: dict[str, bytes]) -> None:
    for each in islice(mutants(sources, Random(4)), 40):
        assert ast.dump(ast.parse(each.after)) != ast.dump(ast.parse(each.before))
        was, now = each.lines()
        assert was != now


def test_a_seed_draws_the_same_mutants_again(sources: dict[str, bytes]) -> None:
    def drawn(seed: int) -> list[Mutant]:
        # A folder may list its files in any order.
        backwards = dict(reversed(sources.items()))
        return list(islice(mutants(backwards, Random(seed)), 20))

    assert drawn(1) == list(islice(mutants(sources, Random(1)), 20))
    assert drawn(1) != drawn(2)


def after(statement: str, *, head: str = "def f(a, b):") -> set[str]:
    """What faults make of a statement."""
    text = f"{head}\n    {statement}\n".encode()
    return {
        (text[: each.begin] + each.text.encode() + text[each.end :])
        .decode()
        .removeprefix(head)
        .strip()
        for found in faults(text).values()
        for each in found
    }


@pytest.mark.parametrize(
    ("statement", "expected"),
    [
        ("return a < b", {"return a <= b", "return a > b", "return None"}),
        ("a.x = 'ä' if a else b", {"a.x = 'ä' if not (a) else b", "pass"}),
        ("c = a('ä') * (b)", {"c = a('ä') / (b)"}),
        ("c = a - 2.0", {"c = a + 2.0", "c = a - 2.2"}),
        ("c = a[0]", {"c = a[1]"}),
        ("a += 3", {"a -= 3", "a += 4", "a += 2", "pass"}),
        ("a = b", {"pass"}),
        ("c = a and b", {"c = a or b"}),
        ("c = a(b=True)", {"c = a(b=False)"}),
        ("c = [i for i in a if i]", {"c = [i for i in a if not (i)]"}),
        ("a.append(b)", {"pass"}),
        ("raise ValueError(f'{a + b}', 1)", {"pass"}),
    ],
)
def test_faults_of_a_statement(statement: str, expected: set[str]) -> None:
    assert after(statement) == expected


@pytest.mark.parametrize(
    "statement",
    [
        '"""Docstring of 3 words."""',
        "tell(f'{a + 1} rows', a + 1)",
        "LOG.warning('%d rows', a + 1)",
        "c = f'{a + 1}'",
        "c = a + 'text'",
        "c = isinstance(a, int | float)",
        "c: Literal[1] = b",
        "c = max(a, 1e-9)",
        "c = b",
    ],
)
def test_what_only_tells_or_would_always_be_noticed_has_no_fault(statement: str) -> None:
    assert after(statement) == set()


def test_what_a_function_returns_stays_of_its_type() -> None:
    assert after("return a", head="def f(a) -> bool:") == {"return not (a)"}
    assert after("return a", head="def f(a) -> float:") == {"return 1.1 * (a)"}
    assert after("return 0.0", head="def f(a) -> float:") == {"return 1.0"}


def test_code_outside_functions_and_signatures_are_left_alone() -> None:
    text = b"A = 1 + 2\nclass C:\n    b = 3\n    def f(self, c=4) -> L[5]:\n        return\n"
    assert faults(text) == {}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A project in which kbe/c.py is read by kbe/b.py, and this by kbe/a.py."""
    files = {
        "kbe/a.py": "def f():\n    from kbe import b",
        "kbe/b.py": "import kbe.c",
        "kbe/c.py": "",
        "tests/kbe/conftest.py": "from kbe.b import X",
        "tests/kbe/test_c.py": "",
        "tests/test_a.py": "from kbe.a import X",
        "tests/test_c_too.py": "from kbe.c import X",
        "tests/kbe/test_b.py": "from kbe.b import X",
        "tests/kbe/test_d.py": "from tests.test_a import X",
        "tests/test_none.py": "",
        "tests/tree/test_all.py": "import kbe.c",
    }
    for name, text in files.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path


def test_tests_are_in_rings_about_a_module(folder: Path) -> None:
    found = list(stages(imports(folder), "kbe/c.py"))
    assert [(each.ring, each.files[:2]) for each in found] == [
        (1, ("kbe/c.py", "tests/kbe/test_c.py")),
        (1, ("tests/kbe/test_c.py",)),
        (1, ("tests/test_c_too.py",)),
        (2, ("tests/kbe/test_b.py", "tests/kbe/test_d.py")),
        (2, ("tests/test_a.py",)),
        (3, ("tests/test_none.py", "stepnc_model")),
        (4, ("tests/kbe/test_b.py", "tests/kbe/test_d.py")),
    ]


def test_a_module_without_a_mirror_has_its_folder(folder: Path) -> None:
    first = next(stages(imports(folder), "kbe/a.py"))
    assert first.files == (
        "kbe/a.py", "tests/kbe/test_b.py", "tests/kbe/test_c.py", "tests/kbe/test_d.py",
    )  # fmt: skip


STAGE = Stage(ring=1, files=("tests/test_x.py",), marker="not slow")


class Rehearsed(Clone):
    """Clone whose tests fail as written down, with the fault and without."""

    with_fault: Iterator[str]
    without: Iterator[str]

    def failure(self, stage: Stage, without: object = ()) -> str:
        path = self.folder / "m.py"
        return next(self.with_fault if path.read_bytes() == b"after" else self.without)


@pytest.mark.parametrize(
    ("with_fault", "without", "expected"),
    [
        ([""], [], Verdict()),
        (["timeout"], [""], Verdict(ring=1, found_by="timeout")),
        (["timeout", "timeout"], ["timeout"], Verdict()),
        (["t::a", "t::a"], [""], Verdict(ring=1, found_by="t::a")),
        (["t::a", "t::a", "t::b", "t::b"], ["t::a", ""], Verdict(ring=1, found_by="t::b")),
        (["t::a", "", ""], [], Verdict()),
        (["exit code 3", "exit code 3", "exit code 3"], ["exit code 3"], Verdict()),
    ],
)
def test_a_fault_is_found_by_what_fails_twice_with_it_and_not_without(
    tmp_path: Path, with_fault: list[str], without: list[str], expected: Verdict
) -> None:
    (tmp_path / "m.py").write_bytes(b"before")
    clone = Rehearsed(folder=tmp_path)
    object.__setattr__(clone, "with_fault", iter(with_fault))
    object.__setattr__(clone, "without", iter(without))
    mutant = Mutant(path="m.py", line=1, before=b"before", after=b"after")
    assert clone.verdict(mutant, 1, [STAGE]) == expected
    assert (tmp_path / "m.py").read_bytes() == b"before"
